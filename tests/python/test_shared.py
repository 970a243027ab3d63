# SPDX-License-Identifier: MIT
"""Use of the Python module by several threads and processes, and at their end."""

import json
import os
import pathlib
import pickle
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
import unittest
import unittest.mock

import numpy as np
import palpate

from support import BUILD, CONFIGS, DEFAULT, FolderTest, run_palpate

MAPS = ("uncertainty", "weight", "probability", "height_mean", "height_variance")


def taps_of(directory):
    lines = (pathlib.Path(directory) / "record.jsonl").read_text().splitlines()
    return [(tap["tap"], tap["outcome"]) for tap in map(json.loads, lines) if "tap" in tap]


def in_threads(count, work):
    """Returns the result or the exception of `work(number)` in each of `count` threads."""
    out = [None] * count

    def keep(number):
        try:
            out[number] = work(number)
        except Exception as trouble:  # returned to the caller
            out[number] = trouble

    threads = [threading.Thread(target=keep, args=(number,)) for number in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return out


class Shared(FolderTest):
    def in_fork(self, work):
        """Returns the text that `work` returns, or its exception as a text, from a forked child."""
        hear, say = os.pipe()
        child = os.fork()
        if child == 0:
            try:
                try:
                    text = str(work())
                except Exception as trouble:  # returned to the parent
                    text = f"{type(trouble).__name__}: {trouble}"
                os.write(say, text.encode())
            finally:
                os._exit(0)
        os.close(say)
        with open(hear, encoding="utf-8") as heard:
            text = heard.read()
        os.waitpid(child, 0)
        return text

    def test_a_forked_child_may_not_go_on_with_the_experiment_of_its_parent(self):
        experiment = self.begin("taps=4")
        experiment.ask()
        experiment.tell(0.0)
        for use in (lambda: experiment.ask(), lambda: experiment.tell(0.0), lambda: experiment.finish(),
                    lambda: experiment.belief.weight):
            self.assertIn("palpate.Error: experiment: was opened by the parent of this forked process",
                          "palpate." + self.in_fork(use))
        self.assertEqual(self.in_fork(lambda: experiment.close() or "closed"), "closed")
        while experiment.ask():
            experiment.tell(0.0)
        self.assertEqual([tap for tap, outcome in taps_of(experiment.directory) if outcome == "contact"], [1, 2, 3, 4])

    def test_an_experiment_is_free_once_it_is_closed_though_a_forked_child_lives(self):
        experiment = self.begin("taps=2")
        wait, go = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(go)
            os.read(wait, 1)
            os._exit(0)
        try:
            experiment.close()
            palpate.Experiment.resume(experiment.directory).close()
        finally:
            os.close(go)
            os.waitpid(child, 0)
            os.close(wait)

    def test_another_process_opens_a_run_for_itself(self):
        run = palpate.run(DEFAULT, "taps=5", "belief.engine.threads=2", runs=self.folder)
        surface = run.surface
        self.assertEqual(self.in_fork(lambda: np.array_equal(run.after(5).surface, surface)), "True")
        again = pickle.loads(pickle.dumps(run))
        np.testing.assert_array_equal(again.surface, surface)

    def test_a_record_that_was_replaced_ends_the_run_that_had_it_before_its_next_tap(self):
        experiment = self.begin("taps=4")
        experiment.ask()
        experiment.tell(0.0)
        record = pathlib.Path(experiment.directory) / "record.jsonl"
        text = record.read_bytes()
        record.unlink()
        record.write_bytes(text)  # restores a copy
        with palpate.Experiment.resume(experiment.directory) as other:
            self.assert_error(experiment.directory, "was moved or removed while a run was writing to it", "palpate resume",
                         experiment.ask)
            while other.ask():
                other.tell(0.0)
        self.assertEqual([tap for tap, outcome in taps_of(experiment.directory) if outcome == "contact"], [1, 2, 3, 4])

    def test_a_map_of_the_belief_stays_as_it_was_after_later_taps_and_the_end(self):
        with self.begin("taps=6") as experiment:
            kept = []
            while experiment.ask():
                maps = [getattr(experiment.belief, name) for name in MAPS]
                kept += [(one, one.copy()) for one in maps]
                experiment.tell(0.03)
        del experiment
        others = [np.full(kept[0][0].shape, 7.0) for _ in range(300)]
        for one, copy in kept:
            np.testing.assert_array_equal(one, copy)
        self.assertEqual(len(others), 300)

    def test_threads_that_share_a_run_get_the_maps_that_they_ask_for(self):
        run = palpate.run(DEFAULT, "taps=8", runs=self.folder)
        maps = {taps: run.after(taps).height_mean for taps in range(9)}

        def look(number):
            order = np.random.default_rng(number).integers(0, 9, 12)
            return all(np.array_equal(run.after(int(taps)).height_mean, maps[taps]) for taps in order)
        self.assertEqual(in_threads(8, look), [True] * 8)

    def test_the_belief_can_be_looked_at_while_another_thread_asks_and_tells(self):
        experiment = self.begin("taps=12")
        over = threading.Event()

        def work(number):
            if number > 0:
                while not over.is_set():
                    if not all(np.isfinite(getattr(experiment.belief, name)).all() for name in MAPS):
                        return "a number that is none"
                return None
            try:
                while experiment.ask():
                    experiment.tell(0.02)
            finally:
                over.set()
            return len(experiment)
        self.assertEqual(in_threads(4, work), [12, None, None, None])
        self.assertIn("all equal", run_palpate("replay", experiment.directory))

    def test_an_experiment_resumed_after_every_tap_goes_on_as_the_unbroken_one(self):
        def taps(seed, name, resumes):
            experiment, out = self.begin("taps=14", name=name), []
            heights = np.random.default_rng(seed).uniform(0.0, 0.1, 14)  # many heights contradict each other
            while tap := experiment.ask():
                out.append(tap.candidate)
                experiment.tell(heights[tap.number - 1])
                if resumes:
                    experiment.close()
                    experiment = palpate.Experiment.resume(experiment.directory)
            experiment.close()
            return out
        for seed in (31, 43):
            self.assertEqual(taps(seed, f"resumed_{seed}", True), taps(seed, f"unbroken_{seed}", False), seed)

    def test_several_threads_compose_configs_run_and_sweep_at_once(self):
        configs = [DEFAULT, CONFIGS / "paper" / "object_i.yaml"]

        def begin(number):
            return palpate._palpate.begin_sweep(str(configs[number % 2]), ["seed=1,2"], str(self.folder))
        begun = [begin(0), begin(1)]
        work = lambda number: all(begin(one) == begun[one % 2] for one in range(number, number + 20))  # noqa: E731
        self.assertEqual(in_threads(8, work), [True] * 8)

        def work(number):
            if number % 2:
                return len(palpate.run(DEFAULT, "taps=3", name=f"run_{number}", runs=self.folder))
            done = palpate.sweep(DEFAULT, taps=2, seed=range(3), name=f"sweep_{number}", workers=1, runs=self.folder)
            return list(done.table["status"])
        self.assertEqual(in_threads(8, work), [["done"] * 3, 3] * 4)

    def test_eight_threads_over_a_run_an_experiment_and_a_sweep_get_answers_or_errors(self):
        """Each thread makes a few calls, or repeats them for PALPATE_SECONDS, as under sanitizers (CONTRIBUTING.md)."""
        seconds = float(os.environ.get("PALPATE_SECONDS", "0"))
        until = time.monotonic() + seconds
        sweep = palpate.sweep(DEFAULT, taps=4, seed=range(2), runs=self.folder)
        run = sweep[0]
        maps = [{name: getattr(run.after(taps), name) for name in MAPS[:4]} for taps in range(5)]
        told = {}  # reported heights by tap

        def go_on(made):
            return time.monotonic() < until if seconds else made < 12

        def work(number):
            nonlocal experiment
            random, made = np.random.default_rng(number), 0
            while go_on(made):
                made += 1
                kind = int(random.integers(0, 6 if number > 1 else 7))
                if kind == 6:
                    again = palpate.sweep(DEFAULT, taps=4, seed=range(2), runs=self.folder)
                    np.testing.assert_array_equal(again[0].after(4).height_mean, maps[4]["height_mean"])
                    continue
                try:
                    if kind == 0:
                        taps = int(random.integers(0, 5))
                        after = run.after(taps)
                        for name, values in maps[taps].items():
                            np.testing.assert_array_equal(getattr(after, name), values)
                    elif kind == 1:
                        self.assertEqual(sweep[1].id, sweep.table["id"][1])
                        self.assertEqual(len(run.taps), 4)
                    elif kind == 2:
                        name = MAPS[int(random.integers(0, len(MAPS)))]
                        self.assertTrue(np.isfinite(getattr(experiment.belief, name)).all())
                    elif kind == 5 and len(experiment) > 8:
                        experiment.close()  # while other threads use it
                        experiment = palpate.Experiment.resume(experiment.directory)
                    elif tap := experiment.ask():
                        height = float(np.round(random.uniform(0.0, 0.1), 6))
                        told.setdefault(tap.number, set()).add(height)
                        experiment.tell(height)
                except palpate.Error:
                    pass  # it is closed, another thread reported the tap, or another process holds the run
            return made

        experiment = self.begin("taps=40")
        for made in in_threads(8, work):
            self.assertIsInstance(made, int)
        experiment.close()
        contacts = [tap for tap in palpate.load(experiment.directory).taps if tap["outcome"] == "contact"]
        for tap in contacts:
            self.assertTrue(any(tap["height"] in heights for heights in told.values()))
        self.assertIn("all equal", run_palpate("replay", experiment.directory))

    def test_a_config_that_was_changed_is_read_again(self):
        own = self.folder / "own.yaml"
        for taps in (2, 3):
            text = DEFAULT.read_text(encoding="utf-8")
            own.write_text(re.sub("^taps: .*", f"taps: {taps}", text, flags=re.MULTILINE), encoding="utf-8")
            self.assertEqual(len(palpate.run(own, runs=self.folder / "runs")), taps)

    def test_the_interpreter_ends_while_daemon_threads_ask_and_run(self):
        script = ("import sys, threading, time, palpate\n"
                  "e = palpate.Experiment(sys.argv[1], 'taps=200', 'belief.footprint.particles=3000', runs=sys.argv[2])\n"
                  "begun = threading.Event()\n"
                  "def ask():\n"
                  "    while e.ask(): e.tell(0.05); begun.set()\n"
                  "def run(): palpate.run(sys.argv[1], 'taps=200', name='daemon', runs=sys.argv[2], progress=lambda n: None)\n"
                  "for work in (ask, run): threading.Thread(target=work, daemon=True).start()\n"
                  "begun.wait(); time.sleep(float(sys.argv[3]))\n")
        for seconds in (0.0, 0.02, 0.05):
            done = self.run_script(script, DEFAULT, self.folder / str(seconds), seconds)
            self.assertEqual((done.returncode, done.stderr), (0, ""), seconds)

    def test_the_interpreter_ends_while_a_daemon_thread_is_called_back(self):
        script = ("import sys, threading, time, palpate\n"
                  "class Late:\n"
                  "    def __del__(self, sleep=time.sleep): sleep(0.5)  # after the GIL is no longer available to other threads\n"
                  "sys.late, called = Late(), threading.Event()\n"
                  "def progress(n):\n"
                  "    called.set()\n"
                  "    threading.Event().wait(eval(sys.argv[3]))\n"
                  "def run(): palpate.run(sys.argv[1], runs=sys.argv[2], progress=progress)\n"
                  "threading.Thread(target=run, daemon=True).start()\n"
                  "called.wait()\n")
        for seconds in (None, 0.2):
            done = self.run_script(script, DEFAULT, self.folder / str(seconds), seconds, seconds=30)
            self.assertEqual((done.returncode, done.stderr), (0, ""), seconds)

    def test_ctrl_c_ends_an_interpreter_that_waits_for_the_call_of_a_daemon_thread(self):
        script = ("import atexit, glob, sys, threading, time, palpate\n"
                  "def run(): palpate.run(sys.argv[1], 'taps=2', 'backend.pace=1000', runs=sys.argv[2])\n"
                  "threading.Thread(target=run, daemon=True).start()\n"
                  "while not glob.glob(sys.argv[2] + '/*/*/record.jsonl'): time.sleep(0.01)\n"
                  "atexit.register(print, 'ends', flush=True)\n")
        process = subprocess.Popen([sys.executable, "-c", script, DEFAULT, self.folder], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.kill)
        self.assertEqual(process.stdout.readline(), "ends\n")
        until = time.monotonic() + 20.0
        while process.poll() is None and time.monotonic() < until:
            process.send_signal(signal.SIGINT)
            time.sleep(0.1)
        self.assertIn(process.poll(), (0, -signal.SIGINT), "a second one may come when Python no longer takes it")
        self.assertIn("KeyboardInterrupt", process.communicate()[1])

    def test_models_that_failed_at_a_tap_are_made_again_for_an_earlier_one(self):
        script = ("import sys, numpy, palpate\n"
                  "try: palpate.run(sys.argv[1], 'belief.footprint=throws_when_told', runs=sys.argv[2])\n"
                  "except palpate.Error: pass\n"
                  "run = palpate.load('default', runs=sys.argv[2])\n"
                  "expected = palpate.load(run.directory).after(len(run) - 1).height_mean\n"
                  "for k in range(2):\n"
                  "    try: run.surface\n"
                  "    except palpate.Error as trouble: print(trouble)\n"
                  "    print(numpy.array_equal(run.after(len(run) - 1).height_mean, expected))\n")
        done = self.run_script(script, DEFAULT, self.folder, PALPATE_PLUGIN_PATH=str(BUILD / "tests/bad_plugins/throws_when_told"))
        self.assertEqual((done.stdout, done.stderr), ("footprint/throws_when_told: no touch today\nTrue\n" * 2, ""))

    def test_with_closes_an_experiment_however_it_is_left(self):
        with self.begin("taps=4", name="broken") as experiment:
            while tap := experiment.ask():
                if tap.number == 3:
                    break
                experiment.tell(0.0)
        self.assertIsNone(palpate.load(experiment.directory).summary)
        with palpate.Experiment.resume(experiment.directory) as again:
            self.assertEqual(len(again), 3, "the tap that nobody told is one of outcome unknown")
            again.close()
        with self.begin("taps=4", name="between") as experiment:
            experiment.ask()
            experiment.tell(0.0)
        self.assertEqual(palpate.load(experiment.directory).summary["stop_reason"], "ended by the caller")

    def test_a_command_ends_quietly_with_its_reader_where_python_became_it(self):
        read, write = os.pipe()
        os.close(read)
        done = subprocess.run([BUILD / "palpate", "schema"], stdout=write, stderr=subprocess.PIPE, restore_signals=False)
        os.close(write)
        self.assertEqual((done.returncode, done.stderr), (-signal.SIGPIPE, b""))

    def test_integers_of_numpy_are_integers(self):
        run = palpate.run(DEFAULT, taps=np.int64(3), seed=np.uint8(4), runs=self.folder)
        self.assertEqual((run.config["taps"], run.config["seed"]), (3, 4))
        self.assertEqual(run.after(np.int32(2)).taps, 2)
        done = palpate.sweep(DEFAULT, taps=np.int64(2), seed=np.arange(2), workers=np.int64(1), runs=self.folder)
        self.assertEqual(len(done[np.int64(1)]), 2)
        with self.begin(taps=np.int16(1), seed=np.int64(9)) as experiment:
            experiment.ask()
            experiment.tell(np.float32(0.0), force=np.int64(8))

    def test_a_locale_with_decimal_commas_changes_no_number(self):
        folder = self.folder / "locales"
        folder.mkdir()
        if shutil.which("localedef") is None or not os.path.exists("/usr/share/i18n/locales/de_DE"):
            self.skipTest("needs the package locales")
        subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", folder / "decimal_comma"], capture_output=True)
        run = palpate.run(CONFIGS / "paper" / "object_i.yaml", "taps=4", runs=self.folder)
        script = ("import json, locale, sys, palpate\n"
                  "directory, config, name = sys.argv[1:]\n"
                  "locale.setlocale(locale.LC_ALL, name)\n"
                  "run = palpate.load(directory)\n"
                  "sobol = 'sweep.sobol={samples: 4, keys: {kernel.length_scale: \"uniform(1.5cm, 4.5cm)\"}}'\n"
                  "again = palpate.run(config, 'taps=4', 'backend={type: replay, record: ' + directory + '}',\n"
                  "                    runs=directory + '.' + name)\n"
                  "print(json.dumps([locale.localeconv()['decimal_point'], run.config, run.summary['rmse_m'],\n"
                  "                  run.surface.tolist(), again.taps['height'].tolist(),\n"
                  "                  palpate._palpate.begin_sweep(config, [sobol], directory + '.sweeps')]))\n")
        heard = []
        for name in ("C", "decimal_comma"):
            done = subprocess.run([sys.executable, "-c", script, run.directory, CONFIGS / "paper" / "object_i.yaml", name],
                                  capture_output=True, text=True, env={**os.environ, "LOCPATH": str(folder)})
            self.assertEqual(done.returncode, 0, done.stderr)
            heard.append(json.loads(done.stdout))
        self.assertEqual([one[0] for one in heard], [".", ","])
        for one, other in zip(heard[0][1:], heard[1][1:]):
            self.assertEqual(one, other)


if __name__ == "__main__":
    unittest.main()
