# SPDX-License-Identifier: MIT
"""What the tests of the Python module share. Where it is built: PALPATE_BUILD."""

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


def program(*words, code=0):
    done = subprocess.run([BUILD / "palpate", *map(str, words)], capture_output=True, text=True)
    assert done.returncode == code, f"{words}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def cells(file):
    with open(file, encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))


def lines_of(directory):
    """The taps of a run, and what is known of its objects: the lines of its record that do not depend on clocks."""
    lines = (pathlib.Path(directory) / "record.jsonl").read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line.startswith(('{"tap"', '{"objects"'))]


class InFolder(unittest.TestCase):
    """A test with a folder of its own for its runs."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def begun(self, *overrides, config=DEFAULT, **settings):
        experiment = palpate.Experiment(config, *overrides, runs=self.folder, **settings)
        self.addCleanup(experiment.close)
        return experiment

    def ended(self, script, *words, seconds=100, **variables):
        return subprocess.run([sys.executable, "-c", script, *map(str, words)], capture_output=True, text=True,
                              timeout=seconds, env={**os.environ, **variables})

    def refuses(self, place, reason, remedy, action):
        with self.assertRaises(palpate.Error) as caught:
            action()
        for part, of in ((place, caught.exception.place), (reason, caught.exception.reason),
                         (remedy, caught.exception.remedy)):
            self.assertIn(part, of)
            self.assertIn(part, str(caught.exception))
