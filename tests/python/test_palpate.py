# SPDX-License-Identifier: MIT
"""Comparison of the Python module with the program and its files. PALPATE_BUILD is the build folder."""

import csv
import json
import math
import os
import pathlib
import re
import resource
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np
import palpate

from support import BUILD, CONFIGS, DEFAULT, FolderTest, lines_of, read_csv, run_palpate


class Module(FolderTest):
    def test_a_run_from_python_leaves_the_bytes_that_the_program_leaves(self):
        by_python = palpate.run(DEFAULT, "taps=12", seed=3, runs=self.folder / "a")
        run_palpate("run", DEFAULT, "taps=12", "seed=3", "--quiet", "--runs", self.folder / "b")
        for name in ("taps.csv", "surface.csv", "config.yaml"):
            one = pathlib.Path(by_python.directory) / name
            other = next((self.folder / "b").glob("*/*/" + name))
            self.assertEqual(one.read_bytes(), other.read_bytes(), name)
        record = next((self.folder / "b").glob("*/*"))
        self.assertEqual(lines_of(by_python.directory), lines_of(record))
        self.assertIn("12 taps", run_palpate("replay", by_python.directory))
        self.assertIn("already done", run_palpate("resume", by_python.directory), "it is a run of the same build")

    def test_a_finished_run_is_loaded_and_not_run_again(self):
        taps = []
        first = palpate.run(DEFAULT, "taps=3", runs=self.folder, progress=taps.append)
        again = palpate.run(DEFAULT, "taps=3", runs=self.folder, progress=taps.append)
        self.assertEqual(taps, [1, 2, 3])
        self.assertEqual(first.id, again.id)

    def test_taps_are_those_of_the_table_and_every_field_is_described(self):
        run = palpate.run(DEFAULT, "taps=8", "scene.effects=standard", runs=self.folder)
        rows = read_csv(pathlib.Path(run.directory) / "taps.csv")
        self.assertEqual(len(run), 8)
        self.assertEqual(list(run.taps.dtype.names), list(rows[0]))
        described = palpate.describe()
        for name in run.taps.dtype.names:
            known = name in described or any("*" in one or "<" in one for one in described)
            self.assertTrue(known, name)
            for value, row in zip(run.taps[name], rows):
                if isinstance(value, (np.bool_, bool)):
                    self.assertEqual(str(bool(value)).lower(), row[name])
                elif isinstance(value, str):
                    self.assertEqual(value, row[name])
                elif isinstance(value, list):
                    self.assertEqual(value, json.loads(row[name]), name)
                elif value is None or math.isnan(value):
                    self.assertEqual("", row[name], name)
                else:
                    self.assertEqual(float(value), float(row[name]), name)
        self.assertEqual(described["height"][0], "m")

    def test_config_summary_and_manifest_are_those_of_the_files(self):
        run = palpate.run(DEFAULT, "taps=3", runs=self.folder)
        self.assertEqual((run.config["taps"], run.config["name"], run.config["stop"]), (3, "default", {}))
        self.assertEqual(run.config["kernel"], {"type": "rbf", "length_scale": "0.03 m"})
        self.assertEqual(run.summary["taps"], 3)
        self.assertEqual(run.manifest["command_line"], ["python"])

    def test_models_after_a_tap_are_the_maps_that_the_run_had_then(self):
        run = palpate.run(DEFAULT, "taps=9", "log.maps=true", runs=self.folder)
        folder = pathlib.Path(run.directory)
        for taps in (5, 8, 2):
            maps = read_csv(folder / "maps" / f"tap_{taps + 1:03}.csv")
            after = run.after(taps)
            for column, values in (("u", after.uncertainty), ("p", after.probability)):
                np.testing.assert_array_equal(values.ravel(), [float(row[column]) for row in maps], column)
        surface = read_csv(folder / "surface.csv")
        for column, values in (("reconstructed_height", run.surface), ("true_height", run.truth),
                               ("height_mean", run.after(9).height_mean)):
            np.testing.assert_array_equal(values.ravel(), [float(row[column]) for row in surface], column)
        x, y = np.meshgrid(run.x, run.y)
        np.testing.assert_array_equal(x.ravel(), [float(row["x"]) for row in surface])
        np.testing.assert_array_equal(y.ravel(), [float(row["y"]) for row in surface])
        self.assert_error("after", "there are 9 taps", "take fewer", lambda: run.after(10))

    def test_who_tells_what_the_simulator_felt_is_sent_where_the_simulator_was(self):
        felt = palpate.run(DEFAULT, "taps=14", "motion=gentle", seed=5, runs=self.folder)
        with self.begin("taps=14", seed=5) as experiment:
            for row in felt.taps:
                tap = experiment.ask()
                self.assertEqual((tap.number, tap.x, tap.y, tap.source), (row["tap"], row["x"], row["y"], row["source"]))
                self.assertIs(type(tap.candidate), int)
                experiment.tell(row["height"], row["force"], row["robot_seconds"])
            self.assertIsNone(experiment.ask())
            self.assertTrue(experiment.finished)
        told = palpate.load(experiment.directory)
        self.assertEqual((told.summary["status"], told.summary["stop_reason"]), ("done", "tap budget"))
        np.testing.assert_array_equal(told.surface, felt.surface)
        self.assertIsNone(told.truth, "nobody knows what a caller taps")
        self.assertIn("all equal", run_palpate("replay", experiment.directory))

    def test_a_caller_who_taps_the_scene_has_the_errors_of_the_simulator(self):
        felt = palpate.run(DEFAULT, "taps=14", "motion=gentle", seed=5, runs=self.folder)
        with self.begin("taps=14", "backend.scene_is_truth=true", seed=5) as experiment:
            for row in felt.taps:
                experiment.ask()
                experiment.tell(row["height"], row["force"], row["robot_seconds"])
        told = palpate.load(experiment.directory)
        for error in ("rmse_m", "rmse_object_m", "footprint_iou", "coverage_95", "object_iou"):
            self.assertIsNotNone(felt.summary[error], error)
            self.assertEqual(told.summary[error], felt.summary[error], error)
        np.testing.assert_array_equal(told.truth, felt.truth)

    def test_what_is_believed_is_read_only_and_to_look_leaves_the_record_as_it_is(self):
        for config in (DEFAULT, CONFIGS / "paper" / "object_i.yaml"):
            records = []
            for looks in (False, True):
                with self.begin("taps=8", config=config, name=f"looks_{looks}") as experiment:
                    while tap := experiment.ask():
                        if looks:
                            belief = experiment.belief
                            for name in ("uncertainty", "weight", "probability", "height_mean", "height_variance"):
                                values = getattr(belief, name)
                                self.assertEqual(values.shape, (len(belief.y), len(belief.x)))
                                self.assertTrue(np.isfinite(values).all(), name)
                                with self.assertRaises(ValueError):
                                    values[0, 0] = 1.0
                        experiment.tell(0.04 if math.hypot(tap.x - 0.115, tap.y - 0.115) < 0.05 else 0.0, 8.0, 2.0)
                records.append(lines_of(experiment.directory))
            self.assertEqual(records[0], records[1], config)

    def test_scores_of_the_caller_choose_and_the_record_can_be_played_again(self):
        with self.begin("taps=9") as experiment:
            wish = np.zeros((len(experiment.belief.y), len(experiment.belief.x)))
            wish[3, 4] = 2.0
            wish[10, 7] = 1.0
            tap = experiment.ask(wish)
            self.assertEqual((tap.source, tap.score, tap.candidate), ("caller", 2.0, 3 * wish.shape[1] + 4))
            self.assertEqual((tap.x, tap.y), (experiment.belief.x[4], experiment.belief.y[3]))
            self.assertEqual(experiment.ask().number, 1, "the same until it is told")
            self.assert_error("tap 1", "is pending", "call tell()", lambda: experiment.ask(wish))
            experiment.tell(0.05)
            self.assertEqual(experiment.ask(wish).candidate, 10 * wish.shape[1] + 7, "none is tapped again")
            experiment.tell(0.0)
            tap = experiment.ask(wish)
            self.assertEqual(tap.source, "fallback")
            self.assertIn("of the caller's scores: no score is positive", tap.why)
            experiment.tell(0.0)
            equal = experiment.ask(wish.ravel() + 5.0 - wish.ravel())
            self.assertEqual(equal.source, "fallback")
            experiment.tell(outcome="no_contact", reason="nothing there")
            while tap := experiment.ask():
                self.assertIn(tap.source, ("initial", "acquisition"), "without scores the strategy chooses")
                experiment.tell(0.0)
        self.assertIn("all equal", run_palpate("replay", experiment.directory))
        self.assertIn("by scores of its own", run_palpate("explain", experiment.directory, 1))
        self.assertIn("The scores of the caller", run_palpate("explain", experiment.directory, 3))

    def test_bad_scores_and_answers_are_refused_and_lose_nothing(self):
        experiment = self.begin("taps=3")
        self.assert_error("scores", "has 3 values", "2209", lambda: experiment.ask([1, 2, 3]))
        self.assert_error("scores", "not a finite number", "use 0", lambda: experiment.ask(np.full(2209, np.nan)))
        self.assert_error("tell", "no tap is pending", "call ask()", lambda: experiment.tell(0.0))
        experiment.ask()
        self.assert_error("tell", "neither a height nor an outcome", "no_contact", experiment.tell)
        for name in ("missed", "unknown"):
            self.assert_error("tell", f"unknown outcome '{name}'", "no_contact", lambda: experiment.tell(outcome=name))
        self.assert_error("tell", "is valid only with", "leave one", lambda: experiment.tell(0.1, outcome="timeout"))
        self.assert_error("tap 1", "is pending", "call tell()", experiment.finish)
        experiment.tell(0.0)
        self.assertEqual(experiment.finish()["stop_reason"], "ended by the caller")
        self.assertEqual(len(palpate.load(experiment.directory)), 1)
        self.assert_error("command line", "unknown option 'length'", "length_scale",
                     lambda: palpate.run(DEFAULT, "kernel.length=3", runs=self.folder))
        empty = self.folder / "empty"
        empty.mkdir()
        self.assert_error(str(empty), "not a run directory", "config.yaml", lambda: palpate.load(empty))

    def test_what_no_arm_can_have_measured_is_a_value_error_and_the_tap_is_still_to_be_told(self):
        experiment = self.begin("taps=3")
        tap = experiment.ask()
        record = pathlib.Path(experiment.directory) / "record.jsonl"
        asked = record.read_bytes()
        wrong = [({"height": height}, "is outside -0.04 to 0.135 m", "millimetres")
                 for height in (40.0, 1e300, -1e300, -3.0, -0.0401, 0.1351, math.inf, math.nan)]
        wrong += [({"height": 0.0, "force": force}, "is outside 0 to 1000 N", "millinewtons")
                  for force in (-1.0, 1000.1, 1e200, math.nan)]
        wrong += [({"height": 0.0, "seconds": seconds}, "is outside 0 to 86400", "milliseconds")
                  for seconds in (-5.0, 86401.0, math.nan)]
        wrong += [({"outcome": "timeout", "seconds": -1.0}, "seconds -1 is", "milliseconds")]
        for fields, reason, remedy in wrong:
            self.assert_error("tell", reason, remedy, lambda: experiment.tell(**fields))
            with self.assertRaises(ValueError):
                experiment.tell(**fields)
            self.assertEqual(record.read_bytes(), asked)
            self.assertEqual((experiment.ask().number, experiment.ask().x, len(experiment)), (1, tap.x, 0))
        experiment.tell(-0.0399, force=1000.0, seconds=86400.0)
        experiment.ask()
        experiment.tell(outcome="aborted", reason="a\u202eb\nc\x9bd")
        experiment.ask()
        experiment.tell(0.135)
        experiment.finish()
        taps = palpate.load(experiment.directory).taps
        self.assertEqual([*taps["outcome"]], ["contact", "aborted", "contact"])
        self.assertEqual(taps["height"][0], -0.0399)
        self.assertEqual(taps["reason"][1], "a b c d")

    def test_where_the_callers_arm_travels_is_an_option_of_the_config(self):
        experiment = self.begin("taps=1", "backend.hover=25cm", "backend.overrun=0cm")
        experiment.ask()
        self.assert_error("tell", "height -0.02 m is outside -0.01 to 0.25 m", "scene's frame",
                     lambda: experiment.tell(-0.02))
        experiment.tell(0.24)

    def test_a_run_of_another_build_is_refused_with_the_argument_of_python_that_repeats_it(self):
        directory = palpate.run(DEFAULT, "taps=3", runs=self.folder).directory
        record = pathlib.Path(directory) / "record.jsonl"
        text = record.read_text(encoding="utf-8")
        record.write_text(re.sub(r'"build": "[0-9a-f]+"', '"build": "0123456789abcdef"', text), encoding="utf-8")
        self.assertNotEqual(record.read_text(encoding="utf-8"), text)
        self.assert_error(directory, "another build", "add force=True to move it aside and run again",
                     lambda: palpate.run(DEFAULT, "taps=3", runs=self.folder))
        self.assertEqual(len(palpate.run(DEFAULT, "taps=3", runs=self.folder, force=True).taps), 3)

    def test_a_run_that_was_killed_goes_on_and_the_tap_that_nobody_told_is_unknown(self):
        script = ("import os, sys, palpate\n"
                  "e = palpate.Experiment(sys.argv[1], 'taps=6', runs=sys.argv[2])\n"
                  "for _ in range(3): e.ask(); e.tell(0.0)\n"
                  "e.ask(); print(e.directory, flush=True); os.kill(os.getpid(), 9)\n")
        killed = subprocess.run([sys.executable, "-c", script, DEFAULT, self.folder], capture_output=True, text=True)
        directory = killed.stdout.strip()
        self.assertIn("palpate.Experiment.resume(DIR)", run_palpate("resume", directory, code=2))
        with palpate.Experiment.resume(directory) as experiment:
            self.assertEqual(len(experiment), 4)
            self.assert_error(directory, "is", "", lambda: palpate.Experiment.resume(directory))
            while experiment.ask():
                experiment.tell(0.0)
        run = palpate.load(directory)
        self.assertEqual([*run.taps["outcome"]], ["contact"] * 3 + ["unknown"] + ["contact"] * 2)
        self.assertIn("all equal", run_palpate("replay", directory))
        self.assertIn("already done", run_palpate("resume", directory))
        self.assert_error(directory, "is finished", "force", lambda: palpate.Experiment.resume(directory))

    def test_a_resumed_run_of_a_callers_scores_reads_what_the_unbroken_one_reads(self):
        def taps(runs, broken_off):
            settings = ("taps=6", "name=mine")
            experiment = palpate.Experiment(CONFIGS / "paper/object_i.yaml", *settings, runs=self.folder / runs)
            for number in range(1, 7):
                scores = np.zeros(len(experiment.belief.x) * len(experiment.belief.y))
                if number != 2:  # the second tap has only scores of 0
                    scores[10 * number] = 1.0
                self.assertEqual(experiment.ask(scores).source, "fallback" if number == 2 else "caller")
                experiment.tell(0.01 * number)
                if number == broken_off:
                    experiment.close()
                    experiment = palpate.Experiment.resume(experiment.directory)
            experiment.finish()
            experiment.close()
            return lines_of(experiment.directory)
        self.assertEqual(taps("broken", broken_off=3), taps("whole", broken_off=None))

    def test_who_ends_a_run_carries_it_on_only_when_told_to(self):
        experiment = self.begin("taps=4")
        experiment.ask()
        with self.assertRaises(palpate.Error) as caught:
            experiment.tell(outcome="aborted", reason="the arm is stuck", ends_run=True)
        self.assertIn("the arm is stuck", str(caught.exception))
        self.assertNotIsInstance(caught.exception, ValueError, "what was told was right")
        self.assertTrue(experiment.finished)
        self.assertIsNone(experiment.ask())
        experiment.close()
        self.assertEqual(palpate.load(experiment.directory).summary["status"], "failed")
        self.assert_error("", "the arm is stuck", "", lambda: palpate.Experiment.resume(experiment.directory))
        with palpate.Experiment.resume(experiment.directory, retry_failed=True) as again:
            while again.ask():
                again.tell(0.0)
        self.assertEqual(palpate.load(experiment.directory).summary["status"], "done")

    def test_an_exception_leaves_a_run_that_can_be_carried_on(self):
        with self.assertRaises(ZeroDivisionError):
            with self.begin("taps=4") as experiment:
                experiment.ask()
                experiment.tell(0.0)
                1 / 0
        self.assertIsNone(palpate.load(experiment.directory).summary)
        with palpate.Experiment.resume(experiment.directory) as again:
            self.assertEqual(again.ask().number, 2)
            again.tell(0.0)

    def test_the_stubs_say_of_every_name_what_the_module_has(self):
        try:
            import mypy  # noqa: F401
        except ImportError:
            self.skipTest("needs mypy")
        ours = self.folder / "allowed"
        # Tap is a type of pybind11 without a constructor. The slots of Maps are in the stub of the public module.
        ours.write_text("palpate.Tap\npalpate.Tap.__init__\npalpate._records.Maps\\..*\n", encoding="utf-8")
        done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "palpate", "--allowlist", ours], cwd=self.folder,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_the_examples_of_the_page_about_python_run(self):
        page = (CONFIGS.parent / "framework" / "docs" / "python.md").read_text(encoding="utf-8")
        examples = re.findall(r"^```python\n(.*?)^```", page, re.MULTILINE | re.DOTALL)
        self.assertEqual(len(examples), 4)
        (self.folder / "configs").symlink_to(CONFIGS)
        sanitized = "ASAN_OPTIONS" in os.environ  # under it, the last example would take minutes
        for example in examples:
            example = example.replace("range(20)", "range(2)" if sanitized else "range(20)")
            done = subprocess.run([sys.executable, "-c", example], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
        printed = ""
        for line in re.search(r"^```sh\n(\./palpate .*?)^```", page, re.MULTILINE | re.DOTALL)[1].splitlines():
            words = line.replace("./palpate", str(BUILD / "palpate")).split()
            done = subprocess.run(words, cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            printed += done.stdout
        self.assertTrue((self.folder / "told.png").exists())
        says = re.search(r"\ncurious - default +\d+ +0 +\d+ +(\S+ \[\S+(?: \S+)?\]) ", printed)
        self.assertIsNotNone(says, printed)
        if not sanitized:
            self.assertTrue(f"`curious - default` is {says[1]} mm: " in page, f"the page does not say {says[1]}")
        told = palpate.load_sweep("told", runs=self.folder / "runs")
        self.assertEqual(list(told[-1].taps["source"][5:]), ["caller"] * 10)

    def test_ctrl_c_ends_a_run_which_the_program_carries_on(self):
        def interrupt(number):
            if number == 4:
                os.kill(os.getpid(), signal.SIGINT)
        with self.assertRaises(KeyboardInterrupt):
            palpate.run(DEFAULT, "taps=12", runs=self.folder, progress=interrupt)
        directory = next(self.folder.glob("*/*"))
        self.assertLess(len(palpate.load(directory)), 12)
        self.assertIn("done: tap budget after 12 taps", run_palpate("resume", directory))

    def test_a_run_is_loaded_by_its_name_and_of_several_the_latest(self):
        first = palpate.run(DEFAULT, "taps=3", seed=1, name="mine", runs=self.folder)
        self.assertEqual(palpate.load("mine", runs=self.folder).id, first.id)
        second = palpate.run(DEFAULT, "taps=3", seed=2, name="mine", runs=self.folder)
        self.assertEqual(palpate.load("mine@latest", runs=self.folder).id, second.id)
        self.assert_error("mine", "2", "", lambda: palpate.load("mine", runs=self.folder))

    def test_other_threads_go_on_while_taps_are_computed(self):
        turns = 0
        over = threading.Event()

        def count():
            nonlocal turns
            while not over.is_set():
                turns += 1
                time.sleep(0)
        thread = threading.Thread(target=count)
        thread.start()
        try:
            before = turns
            palpate.run(DEFAULT, "taps=20", "belief.footprint.particles=3000", runs=self.folder)
            self.assertGreater(turns - before, 100)
        finally:
            over.set()
            thread.join()

    def test_many_runs_in_one_process_take_no_more_memory(self):
        def peak():
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss  # KiB
        runs = int(os.environ.get("PALPATE_RUNS", "120"))
        for seed in range(runs):
            run = palpate.run(DEFAULT, "taps=3", seed=seed, runs=self.folder)
            run.after(2)
            with self.begin("taps=2", "name=asked", seed=seed) as experiment:
                while experiment.ask():
                    experiment.tell(0.0)
            if seed == runs // 3:
                third = peak()
        self.assertLess(peak() - third, 4096)


if __name__ == "__main__":
    unittest.main()
