# SPDX-License-Identifier: MIT
"""Sweeps from Python, run by the program."""

import os
import pathlib
import resource
import signal
import subprocess
import sys
import time
import unittest
import unittest.mock

import numpy as np
import palpate

from support import BUILD, DEFAULT, FolderTest, read_csv, run_palpate


class Importance(FolderTest):
    def test_the_shares_of_the_keys_are_those_of_the_program(self):
        config = pathlib.Path(DEFAULT).parent / "paper" / "object_i.yaml"
        sweep = palpate.sweep(config, "acquisition=weighted,random", "taps=6,12", "seed=range(0,8)", runs=self.folder)
        shares = sweep.importance("rmse_m")
        self.assertEqual(set(shares["keys"]), {"acquisition", "taps", "acquisition,taps"})
        self.assertAlmostEqual(shares["share"].sum(), 1.0, delta=1e-9)
        self.assertTrue(shares["exact"].all())
        self.assertTrue(((shares["low_95"] <= shares["share"]) & (shares["share"] <= shares["high_95"])).all())
        with self.assertRaisesRegex(palpate.InputError, "no_such"):
            sweep.importance("no_such")


class Races(FolderTest):
    def test_a_race_from_python_has_the_table_and_the_best_setting_of_the_program(self):
        config = pathlib.Path(DEFAULT).parent / "paper" / "object_i.yaml"
        heard = []
        race = palpate.tune(config, {"kernel.length_scale": "log_uniform(5mm,10cm)", "acquisition": ["weighted", "uncertainty"]},
                            metric="rmse_m", jobs=80, fresh=5, runs=self.folder,
                            progress=lambda runs, jobs: heard.append((runs, jobs)))
        table = race.table
        self.assertEqual(table["setting"].tolist(), list(range(len(table))))
        self.assertEqual(table["acquisition"][0], "weighted")
        self.assertEqual(table["is_best"].sum(), 1)
        self.assertEqual(set(race.best), {"kernel.length_scale", "acquisition"})
        self.assertTrue(os.path.exists(race.best_config))
        self.assertTrue(heard)
        self.assertEqual(heard, sorted(set(heard)))
        # The mean of a setting is the mean of its runs, without those on fresh seeds.
        jobs = race.sweep.table
        own = jobs["rmse_m"][jobs["kernel.length_scale"] == table["kernel.length_scale"][0]][:table["seeds"][0]]
        self.assertAlmostEqual(table["rmse_m"][0], own.mean(), delta=1e-12)
        again = palpate.tune(config, {"kernel.length_scale": "log_uniform(5mm,10cm)", "acquisition": ["weighted", "uncertainty"]},
                             metric="rmse_m", jobs=80, fresh=5, runs=self.folder)
        self.assertEqual(again.directory, race.directory)
        # A message on stderr after the line with the directory is not the directory.
        script = self.folder / "program"
        script.write_text(f'#!/bin/sh\nPALPATE_PARENT=$$ "{palpate._palpate.program}" "$@"\necho "a message" >&2\n')
        script.chmod(0o755)
        with unittest.mock.patch.object(palpate._palpate, "program", str(script)):
            again = palpate.tune(config, {"kernel.length_scale": "log_uniform(5mm,10cm)", "acquisition": ["weighted", "uncertainty"]},
                                 metric="rmse_m", jobs=80, fresh=5, runs=self.folder)
        self.assertEqual(again.directory, race.directory)

    def test_what_cannot_be_tuned_is_an_input_error_in_one_line(self):
        with self.assertRaisesRegex(palpate.InputError, "changes the scene"):
            palpate.tune(DEFAULT, {"scene": ["block", "ring"]}, metric="rmse_m", jobs=100, runs=self.folder)


class Sweeps(FolderTest):
    def test_a_sweep_from_python_leaves_the_table_that_the_program_leaves(self):
        heard = []
        by_python = palpate.sweep(DEFAULT, "taps=4,6", seed=range(3), runs=self.folder / "a",
                                  progress=lambda done, jobs: heard.append((done, jobs)))
        run_palpate("sweep", DEFAULT, "taps=4,6", "seed=0,1,2", "--quiet", "--runs", self.folder / "b")
        other = next((self.folder / "b").glob("*/*"))
        self.assertEqual(pathlib.Path(by_python.directory).name, other.name)
        rows, expected = (read_csv(folder / "results.csv") for folder in (pathlib.Path(by_python.directory), other))
        self.assertEqual(len(rows), 6)
        self.assertEqual([row["rmse_m"] for row in rows], [row["rmse_m"] for row in expected])
        self.assertEqual(heard, sorted(set(heard)))
        self.assertEqual(heard[-1], (6, 6))
        table = by_python.table
        self.assertEqual(list(table["rmse_m"]), [float(row["rmse_m"]) for row in expected])
        self.assertEqual(list(zip(table["taps"], table["seed"])), [(taps, seed) for taps in (4, 6) for seed in range(3)])
        self.assertEqual([len(run) for run in by_python], [4, 4, 4, 6, 6, 6])
        self.assertEqual(by_python[-1].id, table["id"][5])
        self.assertIn("resume", by_python[0].manifest["command_line"])
        with self.assertRaises(IndexError):
            by_python[6]

    def test_a_sweep_is_a_table_of_pandas_in_one_call(self):
        try:
            import pandas
        except ImportError:
            self.skipTest("needs python3-pandas")
        done = palpate.sweep(DEFAULT, taps=3, seed=[0, 1], kernel=["rbf", "matern52"], runs=self.folder)
        table = pandas.DataFrame(done.table)
        self.assertEqual(table.groupby("kernel")["rmse_m"].count().to_dict(), {"rbf": 2, "matern52": 2})
        self.assertEqual(table["seed"].dtype.kind, "i")

    def test_curves_of_groups_are_arrays_of_what_the_program_writes(self):
        done = palpate.sweep(DEFAULT, "candidates.count=16", acquisition=["weighted", "random"], taps=5, seed=range(5),
                             runs=self.folder)
        heard = []
        curves = done.curves("rmse_m", by="acquisition", progress=lambda now, jobs: heard.append((now, jobs)))
        self.assertEqual(heard[-1], (10, 10))
        run_palpate("curves", done.directory, "--by", "acquisition", "-o", self.folder / "curves.csv")
        rows = read_csv(self.folder / "curves.csv")
        self.assertEqual(len(rows), 10)
        self.assertEqual([(group, str(at)) for group, at in zip(curves["acquisition"], curves["at"])],
                         [(row["acquisition"], row["at"]) for row in rows])
        for name in ("mean", "low_95", "high_95"):
            self.assertEqual([repr(one) for one in curves[name].tolist()],
                             [repr(float(row[name] or "nan")) for row in rows])
        last = curves[(curves["acquisition"] == "weighted") & (curves["at"] == 5)]
        table = done.table[done.table["acquisition"] == "weighted"]
        self.assertAlmostEqual(float(last["mean"][0]), float(np.mean(table["rmse_m"])), delta=1e-15)
        self.assertEqual(int(last["n"][0]), 5)
        self.assert_error("curves", "does not vary 'acqisition'", "", lambda: done.curves(by="acqisition"))

    def told(self, seeds, **more):
        return palpate.begin_sweep(DEFAULT, "candidates.count=12", "backend.scene_is_truth=true", taps=4, name="told",
                                   labels=["default", "left"], seed=seeds, runs=self.folder, **more)

    def tap(self, experiment, taps=4):
        strategies = {"default": lambda belief: None, "left": lambda belief: 1.0 + 0 * belief.uncertainty - belief.x}
        truth = self.truth.flat
        for _ in range(taps):
            tap = experiment.ask(strategies[experiment.label](experiment.belief))
            experiment.tell(truth[tap.candidate])

    def test_two_strategies_of_the_caller_on_three_seeds_are_one_sweep_for_all_commands(self):
        self.truth = palpate.run(DEFAULT, "candidates.count=12", taps=1, runs=self.folder / "other").truth
        sweep = self.told(range(3))
        self.assertEqual(len(sweep), 6)
        for number, experiment in enumerate(sweep.experiments()):
            if number == 1:
                self.tap(experiment, 2)
                experiment.close()  # interrupted in the middle
                break
            with experiment:
                self.tap(experiment)
        self.assertEqual(list(sweep.table["status"]), ["done"] + [None] * 5)
        self.assertIn("made by the caller's own program", run_palpate("resume", sweep.directory, code=2))
        again = self.told(range(3))
        self.assertEqual(again.directory, sweep.directory)
        carried_on = []
        for experiment in again.experiments():
            carried_on.append(len(experiment))
            with experiment:
                self.tap(experiment, 4 - len(experiment))
                self.assertIsNone(experiment.ask())
        self.assertEqual(carried_on, [2, 0, 0, 0, 0])
        self.assertEqual(list(again.experiments()), [])

        loaded = palpate.load_sweep("told", runs=self.folder)
        table = loaded.table
        self.assertEqual(list(table["status"]), ["done"] * 6)
        errors = {label: table["rmse_m"][table["backend.label"] == label] for label in ("default", "left")}
        by_run = [run.summary["rmse_m"] for run in loaded]
        self.assertEqual(sorted(map(float, table["rmse_m"])), sorted(by_run))
        compared = run_palpate("compare", sweep.directory, "--by", "backend.label", "--metric", "rmse_m", "--format", "csv")
        pair = [line.split(",") for line in compared.splitlines()]
        mean = float(pair[-1][pair[0].index("mean")])
        self.assertAlmostEqual(mean, float(np.mean(errors["left"] - errors["default"])), delta=1e-12)
        run_palpate("curves", sweep.directory, "-o", self.folder / "told.png")
        self.assertTrue((self.folder / "told.png").exists())
        self.assertEqual(sorted(set(loaded.curves()["backend.label"])), ["default", "left"])
        self.assertEqual(len(read_csv(pathlib.Path(sweep.directory) / "results.csv")), 6)
        listed = run_palpate("list", self.folder / "told")
        self.assertIn("default, left", listed)
        self.assertIn("6 of 6 jobs done", listed)
        run_palpate("report", sweep.directory)
        self.assertTrue((pathlib.Path(sweep.directory) / "report.html").exists())

    def test_labels_are_texts_whatever_stands_in_them(self):
        names = ["it's", 'q"u', "seed", "range(0,3)", "[z]", "a,b"]
        sweep = palpate.begin_sweep(DEFAULT, labels=names, runs=self.folder)
        labels = []
        for experiment in sweep.experiments():
            with experiment:
                labels.append(experiment.label)
        self.assertEqual(labels, names)
        for wrong in ("", [], ["", "b"], [3]):
            with self.assertRaisesRegex(palpate.InputError, "labels"):
                palpate.begin_sweep(DEFAULT, labels=wrong, runs=self.folder)

    def test_runs_of_a_loop_and_several_sweeps_are_loaded_as_one_sweep(self):
        for label in ("a", "b"):
            for seed in (1, 2):
                with self.begin("candidates.count=12", f"backend.label={label}", "backend.scene_is_truth=true", taps=2,
                                name="loop", seed=seed) as experiment:
                    self.assertEqual(experiment.label, label)
                    while experiment.ask():
                        experiment.tell(0.0)
        loop = palpate.load_sweep("loop", runs=self.folder)
        self.assertEqual(loop.keys, ["backend.label", "seed"])
        self.assertEqual(sorted(zip(loop.table["backend.label"], loop.table["seed"])), [("a", 1), ("a", 2), ("b", 1), ("b", 2)])
        self.assertEqual(len(loop.curves("rmse_m", by="backend.label")), 4)
        other = palpate.sweep(DEFAULT, "candidates.count=12", taps=2, name="other", seed=[1, 2], runs=self.folder)
        both = palpate.load_sweep(["loop", other.directory], runs=self.folder)
        self.assertEqual(len(both), 6)
        self.assertEqual([run.id for run in both][-2:], list(other.table["id"]))

    def test_jobs_that_have_not_ended_are_in_the_table_without_numbers_and_carried_on(self):
        def interrupt(done, jobs):
            if done >= 1:
                os.kill(os.getpid(), signal.SIGINT)
        sweep = lambda progress: palpate.sweep(  # noqa: E731
            DEFAULT, taps=60, seed=range(4), workers=1, runs=self.folder, progress=progress)
        with self.assertRaises(KeyboardInterrupt):
            sweep(interrupt)
        half = palpate.load_sweep("default", runs=self.folder)
        open_jobs = half.table["status"] != "done"
        self.assertGreaterEqual(sum(open_jobs), 1)
        self.assertTrue(np.isnan(half.table["rmse_m"][open_jobs]).all())
        self.assertEqual(len(list(half)), 4 - sum(open_jobs))
        whole = sweep(None)
        self.assertEqual(whole.directory, half.directory)
        self.assertEqual(list(whole.table["status"]), ["done"] * 4)

    def test_what_a_progress_of_the_caller_throws_ends_a_sweep_and_is_thrown(self):
        def fail(done, jobs):
            raise RuntimeError("enough")
        with self.assertRaisesRegex(RuntimeError, "enough"):
            palpate.sweep(DEFAULT, taps=40, seed=range(3), workers=1, runs=self.folder, progress=fail)
        self.assertLess(sum(palpate.load_sweep("default@latest", runs=self.folder).table["status"] == "done"), 3)

    def test_what_is_wrong_with_a_sweep_is_said_with_place_reason_and_remedy(self):
        self.assert_error("command line", "has no closing ')'", "quotes", lambda: palpate.sweep(DEFAULT, "seed=range(0,"))
        self.assert_error("sweep", "workers", "at least 1", lambda: palpate.sweep(DEFAULT, seed=[1, 2], workers=0))
        self.assert_error("nothing", "of that name", "palpate list", lambda: palpate.load_sweep("nothing", self.folder))

    def test_a_text_with_commas_is_one_value_of_a_sweep(self):
        done = palpate.sweep(DEFAULT, taps=2, name="cup, left: blue", seed=[1, 2], runs=self.folder)
        self.assertEqual([run.config["name"] for run in done], ["cup, left: blue"] * 2)
        self.assertEqual(palpate.sweep(DEFAULT, taps=2, seed="range(4,6)", runs=self.folder).table["seed"].tolist(), [4, 5])
        self.assertEqual(palpate.run(DEFAULT, "taps=2", name="a, b", runs=self.folder).config["name"], "a, b")

    def test_a_range_of_very_many_values_is_refused_before_they_are_made(self):
        self.assert_error("command line", "has more than a million values", "wider step",
                     lambda: palpate.sweep(DEFAULT, taps=2, seed=range(10**9), runs=self.folder))

    def test_a_sweep_takes_more_values_than_a_command_line(self):
        done = palpate.sweep(DEFAULT, "sweep.where=seed < 1002", taps=2, seed=range(1000, 31000), runs=self.folder)
        self.assertEqual(done.table["seed"].tolist(), [1000, 1001])

    def test_a_signal_ends_a_sweep_while_its_jobs_are_checked_and_leaves_nothing(self):
        def interrupt(*_):
            raise InterruptedError("enough")
        self.addCleanup(signal.signal, signal.SIGALRM, signal.signal(signal.SIGALRM, interrupt))
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        with self.assertRaisesRegex(InterruptedError, "enough"):
            palpate.sweep(DEFAULT, "seed=range(0,50000)", taps=2, runs=self.folder / "runs")
        self.assertFalse((self.folder / "runs").exists())

    def test_a_sweep_whose_jobs_have_not_ended_is_an_error_with_the_reason(self):
        failing = self.folder / "failing"
        failing.write_text("#!/bin/sh\necho 'job 0: no process can be made' >&2\n"
                           "echo '0 of 2 jobs done, 0 running, 0 failed' >&2\nexit 1\n", encoding="utf-8")
        failing.chmod(0o755)
        with unittest.mock.patch.object(palpate._palpate, "program", str(failing)):
            self.assert_error("/default/", "ended with status 1: job 0: no process can be made", "repeat the call to resume it",
                         lambda: palpate.sweep(DEFAULT, taps=2, seed=range(2), runs=self.folder))
        self.assertEqual(list(palpate.sweep(DEFAULT, taps=2, seed=range(2), runs=self.folder).table["status"]), ["done"] * 2)

    def test_progress_of_a_sweep_is_heard_as_jobs_end(self):
        heard = []
        palpate.sweep(DEFAULT, "backend.pace=0.005", taps=6, seed=range(30), workers=1, runs=self.folder, progress=lambda *now: heard.append(now))
        self.assertEqual(heard[-1], (30, 30))
        self.assertGreater(len([done for done, _ in heard if done % 3]), 0, "more than a line per tenth")

    def test_a_sweep_needs_no_terminal_and_no_low_file_numbers(self):
        script = ("import os, pty, resource, sys, palpate\n"
                  "def none(*_): raise OSError('out of pty devices')\n"
                  "os.openpty = pty.openpty = none\n"
                  "resource.setrlimit(resource.RLIMIT_NOFILE, (1500, 1500))\n"
                  "keep = [open(os.devnull) for _ in range(1100)]\n"
                  "heard = []\n"
                  "palpate.sweep(sys.argv[1], taps=2, seed=range(3), runs=sys.argv[2], progress=lambda *n: heard.append(n))\n"
                  "print(heard[-1])\n")
        if resource.getrlimit(resource.RLIMIT_NOFILE)[1] < 1500:
            self.skipTest("needs 1500 open files")
        done = self.run_script(script, DEFAULT, self.folder)
        self.assertEqual((done.stdout, done.stderr), ("(3, 3)\n", ""))

    def test_a_sweep_ends_with_an_interpreter_that_is_killed(self):
        script = ("import sys, palpate\n"
                  "palpate.sweep(sys.argv[1], taps=200, seed=range(100), workers=1, runs=sys.argv[2],\n"
                  "              progress=lambda *n: print('on', flush=True))\n")
        killed = subprocess.Popen([sys.executable, "-c", script, DEFAULT, self.folder], stdout=subprocess.PIPE)
        killed.stdout.readline()
        killed.kill()
        killed.communicate()
        sweep = palpate.load_sweep("default", runs=self.folder)
        until = time.monotonic() + 60.0  # the present tap ends first
        while self.at_work() and time.monotonic() < until:
            time.sleep(0.05)
        self.assertEqual(self.at_work(), [])
        self.assertLess(sum(sweep.table["status"] == "done"), 100)

    def at_work(self):
        """Returns the command lines of processes that contain this test's folder."""
        out = []
        for process in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
            try:
                words = process.read_bytes()
            except OSError:
                continue
            if str(self.folder).encode() in words and b"resume" in words.split(b"\0"):
                out.append(words)
        return out


if __name__ == "__main__":
    unittest.main()
