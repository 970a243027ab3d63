#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compares `palpate tune` with irace and Optuna (TPE on the means of five seeds): which setting do they find with the same
number of runs? Prints the mean over fresh seeds of each chosen setting, and the mean regret per method: the difference to
the best setting that any method has found. Needs r-cran-irace and python3-optuna.

    tuners.py BUILD A|B JOBS REPETITIONS [METHOD...]     METHOD: palpate irace optuna; default: all

Objective A is the paper's strategy on object I at random places (1 ms a run), B the default strategy on a ring with the
standard effects, 17 taps (0.1 s a run).
"""
import json
import math
import os
import shutil
import socket
import statistics
import subprocess
import sys
import tempfile
import threading

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
FRESH = range(900000, 900200)
# Config, options of all runs, ranges (key, first end, last end, unit; all logarithmic), and lists of values.
OBJECTIVES = {
    "A": ("paper/object_i.yaml", ["scene.placement=random"],
          [("kernel.length_scale", 5, 100, "mm"), ("belief.label.kernel.length_scale", 5, 100, "mm"),
           ("belief.label.noise", 1e-4, 1, ""), ("belief.height.noise", 0.1, 30, "mm")],
          [("acquisition", ["weighted", "uncertainty"]), ("kernel", ["rbf", "matern52"])]),
    "B": ("default.yaml", ["scene=ring", "scene.effects=standard", "taps=17"],
          [("kernel.length_scale", 10, 100, "mm"), ("belief.height.noise", 1, 20, "mm"),
           ("acquisition.acquisitions.0.new_object_weight", 0.2, 4, ""), ("acquisition.acquisitions.2.factor", 0.2, 10, "")],
          [])}
CONFIG, FIXED, RANGES, CHOICES = OBJECTIVES[sys.argv[2]]
CONFIG = os.path.join(ROOT, "configs", CONFIG)


class Objective:
    """Runs one setting on one seed, in memory."""

    def __init__(self, build):
        sys.path.insert(0, os.path.join(build, "python"))
        import palpate
        self.palpate = palpate
        self.folder = tempfile.mkdtemp(dir=os.environ.get("TMPDIR"))

    def run(self, setting, seed):
        """Returns the RMSE in metres. `setting`: a list of KEY=VALUE."""
        record = self.palpate.run(CONFIG, *FIXED, *setting, f"seed={seed}", "log.surface=false", runs=self.folder)
        rmse = record.summary["rmse_m"]
        shutil.rmtree(record.directory)
        return rmse


def setting_of(numbers, choices):
    """Returns a list of KEY=VALUE from the numbers of RANGES and the values of CHOICES."""
    out = [f"{key}={number:.6g}{unit}" for (key, _, _, unit), number in zip(RANGES, numbers)]
    return out + [f"{key}={value}" for (key, _), value in zip(CHOICES, choices)]


def by_palpate(build, _, jobs, first_seed):
    """Returns the setting that `palpate tune` chooses."""
    words = [f"{key}=log_uniform({first}{unit},{last}{unit})" for key, first, last, unit in RANGES]
    words += [f"{key}={','.join(values)}" for key, values in CHOICES]
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as folder:
        subprocess.run([os.path.join(build, "palpate-whole"), "tune", CONFIG, *FIXED, *words, f"seed={first_seed}", "--metric",
                        "rmse_m", "--jobs", str(jobs), "--fresh", "0", "--runs", folder, "--quiet"],
                       check=True, stdout=subprocess.DEVNULL)
        race = next(os.path.join(path, "race.csv") for path, _, files in os.walk(folder) if "race.csv" in files)
        with open(os.path.join(os.path.dirname(race), "manifest.jsonl"), encoding="utf-8") as lines:
            winner = json.loads(lines.readlines()[-1])["front"][0]
        with open(race, encoding="utf-8") as lines:
            head, *rows = [line.rstrip("\n").split(",") for line in lines]
    row = dict(zip(head, rows[winner]))
    if winner == 0:
        return []
    return [f"{key}={row[key]}" for key in head if key in {one[0] for one in RANGES + CHOICES}]


def by_optuna(_, objective, jobs, first_seed):
    """Returns the setting that Optuna's TPE chooses, from means of five seeds."""
    import optuna
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=first_seed))

    def mean(trial):
        numbers = [trial.suggest_float(key, first, last, log=True) for key, first, last, _ in RANGES]
        choices = [trial.suggest_categorical(key, values) for key, values in CHOICES]
        setting = setting_of(numbers, choices)
        trial.set_user_attr("setting", setting)
        return statistics.fmean(objective.run(setting, first_seed + seed) for seed in range(5))

    study.optimize(mean, n_trials=jobs // 5)
    return study.best_trial.user_attrs["setting"]


def by_irace(_, objective, jobs, first_seed):
    """Returns the setting that irace chooses. irace runs in R and asks for results through a socket."""
    server = socket.create_server(("127.0.0.1", 0))
    chosen = []

    def serve():
        connection, _ = server.accept()
        with connection, connection.makefile("rw") as stream:
            for line in stream:
                kind, seed, *values = line.split()
                count = len(RANGES)
                setting = setting_of([float(value) for value in values[:count]], values[count:])
                if kind == "best":
                    chosen.append(setting)
                    return
                stream.write(f"{objective.run(setting, first_seed + int(seed))!r}\n")
                stream.flush()

    thread = threading.Thread(target=serve)
    thread.start()
    lines = [f'{key.replace(".", "_")} "" r,log ({first}, {last})' for key, first, last, _ in RANGES]
    lines += [f'{key} "" c ({", ".join(values)})' for key, values in CHOICES]
    names = ", ".join(f'"{key.replace(".", "_")}"' for key, *_ in RANGES + CHOICES)
    script = f"""
suppressMessages(library(irace))
connection <- socketConnection(port = {server.getsockname()[1]}, open = "r+", blocking = TRUE)
words <- function(configuration) paste(sapply(c({names}), function(name) as.character(configuration[[name]])), collapse = " ")
runner <- function(experiment, scenario) {{
  writeLines(paste("run", experiment$id.instance, words(experiment$configuration)), connection)
  list(cost = as.numeric(readLines(connection, 1)))
}}
parameters <- readParameters(text = '{chr(10).join(lines)}')
scenario <- list(targetRunner = runner, instances = 1:2000, maxExperiments = {jobs}, seed = {first_seed % 2**30 + 1},
                 logFile = "", sampleInstances = FALSE, digits = 6)
invisible(capture.output(best <- irace(scenario = scenario, parameters = parameters)))
writeLines(paste("best 0", words(best[1, ])), connection)
close(connection)
"""
    subprocess.run(["Rscript", "-e", script], check=True, stdout=subprocess.DEVNULL)
    thread.join()
    return chosen[0]


METHODS = {"palpate": by_palpate, "irace": by_irace, "optuna": by_optuna}


def main():
    build, jobs, repetitions = sys.argv[1], int(sys.argv[3]), int(sys.argv[4])
    objective = Objective(build)
    truth = {}
    means = {}
    for name in sys.argv[5:] or METHODS:
        means[name] = []
        for repetition in range(repetitions):
            setting = METHODS[name](build, objective, jobs, 1 + 5000 * repetition)
            key = tuple(setting)
            if key not in truth:
                truth[key] = 1e3 * statistics.fmean(objective.run(setting, seed) for seed in FRESH)
            means[name].append(truth[key])
            print(f"{name} {repetition} {truth[key]:.3f} mm  {' '.join(setting)}", flush=True)
    best = min(min(one) for one in means.values())
    for name, found in means.items():
        error = statistics.stdev(found) / math.sqrt(len(found)) if len(found) > 1 else math.nan
        print(f"{name}: mean {statistics.fmean(found):.3f} mm, regret {statistics.fmean(found) - best:.3f} ({error:.3f}) mm")
    shutil.rmtree(objective.folder)


main()
