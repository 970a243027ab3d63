# SPDX-License-Identifier: MIT
"""Helpers for the tests of the Python module. PALPATE_BUILD is the build folder."""

import csv
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import palpate

BUILD = pathlib.Path(os.environ["PALPATE_BUILD"])
CONFIGS = pathlib.Path(__file__).resolve().parents[2] / "configs"
DEFAULT = CONFIGS / "default.yaml"


def run_palpate(*words, code=0):
    done = subprocess.run([BUILD / "palpate", *map(str, words)], capture_output=True, text=True)
    assert done.returncode == code, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def read_csv(file):
    with open(file, encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))


def lines_of(directory):
    """Returns the lines of a record about taps and objects, which do not depend on clocks."""
    lines = (pathlib.Path(directory) / "record.jsonl").read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line.startswith(('{"tap"', '{"objects"'))]


class FolderTest(unittest.TestCase):
    """Test with a temporary folder for its runs."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def begin(self, *overrides, config=DEFAULT, **settings):
        experiment = palpate.Experiment(config, *overrides, runs=self.folder, **settings)
        self.addCleanup(experiment.close)
        return experiment

    def run_script(self, script, *words, seconds=100, **variables):
        return subprocess.run([sys.executable, "-c", script, *map(str, words)], capture_output=True, text=True,
                              timeout=seconds, env={**os.environ, **variables})

    def assert_error(self, place, reason, remedy, action):
        with self.assertRaises(palpate.Error) as caught:
            action()
        for part, of in ((place, caught.exception.place), (reason, caught.exception.reason),
                         (remedy, caught.exception.remedy)):
            self.assertIn(part, of)
            self.assertIn(part, str(caught.exception))
