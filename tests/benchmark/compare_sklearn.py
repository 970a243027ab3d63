#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Replays the taps of tests/data on palpate's posterior engines and on scikit-learn's GaussianProcessRegressor, in
alternating rounds on one thread each, and prints times, their ratios and how far the results are apart.

scikit-learn gets its best use: one shared model with two outputs, height and label, hence one factorisation a tap, and
no optimiser. After each tap from the third to the last of the file both bring mean and variance to all candidates and
take the argmax of variance x weight. Variances exclude the noise on both sides: scikit-learn's alpha never enters its
prediction. Neither time has the start of a process in it.

    tests/benchmark/compare_sklearn.py w1 w2 --engines auto grid
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import warnings

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"):  # read when numpy is imported
    os.environ[variable] = "1"
# Its kernels for AVX2 solve triangular systems up to twice as fast as those for AVX-512, which it may choose itself.
os.environ.setdefault("OPENBLAS_CORETYPE", "Haswell")

import numpy
import sklearn
import threadpoolctl  # which scikit-learn needs itself
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Candidates a side, repeats of ours and theirs within a round, candidates in a call of scikit-learn: all of W1, while
# W2 is faster in pieces and W3 would need 7 GB.
WORKLOADS = {"w1": (47, 200, 9, 47 * 47), "w2": (231, 5, 1, 1000), "w3": (461, 3, 1, 1000)}
ENGINES = {name: ["--engine", name] for name in ("auto", "dense", "grid", "lowrank")}


def taps_file(workload):
    return ROOT / "tests" / "data" / f"taps_{workload}.csv"


def ours(bench, workload, engine, maps=None):
    """What palpate_bench prints; with `maps`, also its candidates and final maps: x, y, mean, variance, weight."""
    grid, repeat, _, _ = WORKLOADS[workload]
    words = [bench, "--taps", taps_file(workload), "--grid", str(grid), "--repeat", str(repeat), *ENGINES[engine]]
    if maps:
        words += ["--maps", maps]
    out = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
    return out, numpy.loadtxt(maps, delimiter=",", skiprows=1) if maps else None


def predict(model, candidates, step):
    parts = [model.predict(candidates[i : i + step], return_std=True) for i in range(0, len(candidates), step)]
    mean, deviation = (numpy.concatenate(part) if len(part) > 1 else part[0] for part in zip(*parts))
    return mean, deviation[:, 0] ** 2  # the same for both outputs


def theirs(workload, candidates):
    """Seconds of each replay, the choices, and the final mean, variance and weight, a column each."""
    _, _, repeat, step = WORKLOADS[workload]
    taps = numpy.loadtxt(taps_file(workload), delimiter=",", skiprows=1)
    seconds = []
    for _ in range(repeat):
        choices = []
        start = time.perf_counter()
        for n in range(3, len(taps) + 1):
            model = GaussianProcessRegressor(RBF(3.0), alpha=1e-4, optimizer=None)
            model.fit(taps[:n, :2], taps[:n, 2:])
            mean, variance = predict(model, candidates, step)
            choices.append(int(numpy.argmax(variance * mean[:, 1])))
        seconds.append(time.perf_counter() - start)
    return seconds, choices, numpy.column_stack([mean[:, 0], variance, mean[:, 1]])


def compare(bench, workload, engines, rounds):
    first, maps = {}, {}
    with tempfile.TemporaryDirectory() as folder:  # not timed: writing maps takes memory
        for engine in engines:
            first[engine], maps[engine] = ours(bench, workload, engine, os.path.join(folder, "maps.csv"))
    candidates = numpy.ascontiguousarray(maps[engines[0]][:, :2])
    own, other = {engine: [] for engine in engines}, []
    least, least_other = {engine: float("inf") for engine in engines}, float("inf")
    for _ in range(rounds):
        for engine in engines:
            seconds = ours(bench, workload, engine)[0]["total_seconds"]
            own[engine].append(seconds["median"])
            least[engine] = min(least[engine], seconds["least"])
        seconds, choices, last = theirs(workload, candidates)
        other.append(statistics.median(seconds))
        least_other = min(least_other, *seconds)
    for engine in engines:
        ratios = sorted(b / a for a, b in zip(own[engine], other))
        apart = numpy.abs(maps[engine][:, 2:] - last).max(axis=0)
        agree = sum(a == b for a, b in zip(first[engine]["choices"], choices))
        ran = first[engine]["engine"] if engine == "auto" else ""
        print(f"{workload:3} {engine + (f' ({ran})' if ran else ''):15} {first[engine]['taps']:5} {len(candidates):10} "
              f"{1e3 * statistics.median(own[engine]):11.4f} {1e3 * statistics.median(other):15.2f} "
              f"{statistics.median(ratios):7.0f} {ratios[0]:7.0f} {ratios[-1]:7.0f} {least_other / least[engine]:7.0f} "
              f"{apart[0]:9.1e} {apart[1]:9.1e} {apart[2]:9.1e} {f'{agree} of {len(choices)}':>13}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("workloads", nargs="*", metavar="w1|w2|w3", default=["w1", "w2"],
                        help="default: w1 w2; scikit-learn takes about an hour for a round of w3")
    parser.add_argument("--engines", nargs="+", choices=ENGINES, default=["auto"], help="of palpate; default: auto")
    parser.add_argument("--rounds", type=int, default=3, help="default: 3")
    parser.add_argument("--bench", default=str(ROOT / "build" / "release" / "tests" / "palpate_bench"),
                        help="palpate_bench to run; default: that of the preset release")
    arguments = parser.parse_args()
    for workload in arguments.workloads:
        if workload not in WORKLOADS:
            parser.error(f"{workload} is no workload: w1, w2, w3")
    warnings.filterwarnings("ignore")  # of variances below 0, which scikit-learn sets to 0

    path = ours(arguments.bench, "w1", "auto")[0]["instruction_path"]
    blas = next(one for one in threadpoolctl.threadpool_info() if one["user_api"] == "blas")
    print(f"palpate: {path} loops, 1 thread")
    print(f"scikit-learn {sklearn.__version__}, numpy {numpy.__version__}, {blas['internal_api']} {blas['version']} "
          f"({blas.get('architecture', '')}), {blas['num_threads']} thread")
    print(f"{arguments.rounds} alternating rounds; medians of whole replays in ms; ratio: theirs / ours by round,")
    print("its median, least and largest; at best: the least of theirs / the least of ours, on shared machines")
    print("differences: largest over all candidates after the last tap, heights in dm; choices: own argmax of each tap")
    print(f"{'':3} {'engine':15} {'taps':>5} {'candidates':>10} {'palpate ms':>11} {'scikit-learn ms':>15} "
          f"{'ratio':>7} {'least':>7} {'largest':>7} {'at best':>7} "
          f"{'mean':>9} {'variance':>9} {'weight':>9} {'choices agree':>13}")
    for workload in arguments.workloads:
        compare(arguments.bench, workload, arguments.engines, arguments.rounds)


if __name__ == "__main__":
    sys.exit(main())
