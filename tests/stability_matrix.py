#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The stability matrix of the default: its errors beside those of `belief.height.outlier_probability: none`, over noise, length and taps.

    python3 tests/stability_matrix.py PROGRAM [--taps 3,30] [--seeds 12] [--jobs 1] [--noise 0,1e-12] [--length 0.03]

A cell holds if no run of it ends with exit code 0 and without a finite RMSE, and if the mean of each error over the
seeds is at most twice that of the same runs without outliers plus 1 mm; of an overlap, what it lacks of 1, plus 0.05.
An error that only one of the two runs of a seed has makes the cell miss. A run that ends with exit code 1 is counted.
`--config configs/any_side.yaml` has no outliers: its runs have to end with finite errors alone. Prints a line per cell
that misses, then a summary; all cells go to --csv. Exit status 1 if any cell misses.
"""
import argparse
import concurrent.futures
import csv
import json
import math
import subprocess
import sys
import tempfile
import time

NOISES = [0.0, 1e-12, 1e-10, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 6e-3, 5e-2]
LENGTHS = [0.001, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 20.0]
MORE_THAN_THE_OTHER = 2.0
AND_METRES = 0.001
AND_OVERLAP = 0.05
METRES = ["rmse_m", "rmse_object_m", "rmse_height_m", "object_rmse_height_m", "surface_distance_m",
          "rms_surface_distance_m"]
OVERLAPS = ["footprint_iou", "object_iou", "volume_iou", "f_score"]


def run(program, config, overrides):
    """Returns the exit code, the errors by name, those of overlaps as what they lack of 1, and what was said."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", config, "--quiet", "--json", "--runs", folder, "log.sync=none"]
        ended = subprocess.run(command + overrides, capture_output=True, text=True, check=False)
    if ended.returncode != 0:
        return ended.returncode, {}, ended.stderr.strip()
    summary = json.loads(ended.stdout)
    errors = {name: summary[name] for name in METRES if summary.get(name) is not None}
    errors.update({name: 1.0 - summary[name] for name in OVERLAPS if summary.get(name) is not None})
    return 0, errors, ""


def is_silent(one, main):
    """Whether a run ended with exit code 0 and without a finite RMSE, or with another error that is not finite."""
    return one[0] == 0 and (main not in one[1] or not all(math.isfinite(error) for error in one[1].values()))


def mean(values):
    return sum(values) / len(values) if values else math.nan


def compare(judged, believed, main):
    """Returns the means of each error with and without outliers, and those names whose mean is too large."""
    means, inexact = {}, []
    for name in METRES + OVERLAPS:
        pairs = [(a[1][name], b[1][name]) for a, b in zip(judged, believed) if name in a[1] and name in b[1]]
        means[name] = [mean(one) for one in zip(*pairs)] or [math.nan] * 2
        alone = any((name in a[1]) != (name in b[1]) for a, b in zip(judged, believed) if a[0] == b[0] == 0)
        margin = AND_METRES if name in METRES else AND_OVERLAP
        within = means[name][0] <= MORE_THAN_THE_OTHER * means[name][1] + margin
        if alone or (not within and (pairs or name == main)):
            inexact.append(name)
    return means, inexact


def numbers(text):
    return [float(one) for one in text.split(",")]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--config", default="configs/default.yaml")
    parser.add_argument("--taps", default="3,30")
    parser.add_argument("--noise", type=numbers, default=NOISES)
    parser.add_argument("--length", type=numbers, default=LENGTHS)
    parser.add_argument("--seeds", type=int, default=12)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--csv", default="")
    parser.add_argument("overrides", nargs="*", help="further KEY=VALUE of all runs")
    options = parser.parse_args()
    cells = [(taps, noise, length) for taps in (int(float(one)) for one in options.taps.split(","))
             for noise in options.noise for length in options.length]
    from_any_side = "any_side" in options.config
    main = "rms_surface_distance_m" if from_any_side else "rmse_m"
    rows, missed = [], 0
    told = time.monotonic()
    print(f"{len(cells)} cells of {options.seeds * (1 if from_any_side else 2)} runs each", file=sys.stderr, flush=True)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        def outcomes(cell, lies):
            taps, noise, length = cell
            common = [f"taps={taps}", f"belief.height.noise={noise:g}m", f"kernel.length_scale={length:g}m"]
            common += lies + options.overrides
            return [pool.submit(run, options.program, options.config, common + [f"seed={seed}"])
                    for seed in range(1, options.seeds + 1)]
        waiting = []
        for cell in cells:
            judged = outcomes(cell, [])
            waiting.append((cell, judged, judged if from_any_side else outcomes(cell, ["belief.height.outlier_probability=none"])))
        for cell, judged, believed in waiting:
            judged, believed = [[one.result() for one in runs] for runs in (judged, believed)]
            failed = [said for code, _, said in judged if code != 0]
            silent = sum(is_silent(one, main) for one in judged + believed)
            means, inexact = compare(judged, believed, main)
            # A run may fail with exit code 1, but not where it holds without outliers, nor by a signal or a wrong
            # config.
            broken = any(code not in (0, 1) for code, _, _ in judged + believed)
            worse = any(a[0] != 0 and b[0] == 0 for a, b in zip(judged, believed))
            misses = silent > 0 or broken or worse or bool(inexact)
            missed += misses
            pairs = sum(a[0] == 0 and b[0] == 0 for a, b in zip(judged, believed))
            rows.append([*cell, pairs, *(f"{one:.6g}" for name in METRES + OVERLAPS for one in means[name]), silent,
                         len(failed), "misses: " + " ".join(inexact) if misses else "holds"])
            if time.monotonic() - told > 15:
                told = time.monotonic()
                print(f"{len(rows)} of {len(cells)} cells", file=sys.stderr, flush=True)
            if misses or failed:
                said = ", ".join(f"{name} {means[name][0]:.4g}, without outliers {means[name][1]:.4g}"
                                 for name in inexact or [main])
                print(f"{cell[0]} taps, noise {cell[1]:g} m, length scale {cell[2]:g} m: {said}; {silent} silent, "
                      f"{len(failed)} failed {failed[:1]}", flush=True)
    if options.csv:
        with open(options.csv, "w", newline="", encoding="utf-8") as file:
            columns = [column for name in METRES + OVERLAPS for column in (name, name + "_without_outliers")]
            csv.writer(file).writerows([["taps", "noise_m", "length_scale_m", "pairs", *columns, "silent", "failed",
                                         "verdict"], *rows])
    print(f"{len(rows)} cells, {missed} miss")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
