#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Wall time of whole paper runs, from the start of the process to its exit, in milliseconds: least and median.

Beside it a program that does nothing, and `palpate --version`, which shows what the run itself takes. With --vs the
runs of another checkout's release build alternate with ours, each seed in both, and the median of the ratios ours /
theirs is told: on a machine that others use, times say little and ratios more. Runs go to memory where there is any.

    tests/benchmark/startup.py --runs 200 --vs ../before
"""
import argparse
import os
import pathlib
import shutil
import statistics
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]


def program_of(checkout):
    return checkout / "build/release/palpate"


def milliseconds(command):
    """One process, from just before it is made until it is gone; what it prints goes nowhere."""
    silent = [(os.POSIX_SPAWN_OPEN, 1, "/dev/null", os.O_WRONLY, 0)]
    start = time.perf_counter()
    process = os.posix_spawn(command[0], command, os.environ, file_actions=silent)
    status = os.waitpid(process, 0)[1]
    taken = 1e3 * (time.perf_counter() - start)
    if status != 0:
        raise SystemExit(f"startup: {' '.join(command)} ended with status {os.waitstatus_to_exitcode(status)}")
    return taken


def paper_run(checkout, runs, seed):
    config = checkout / "configs/paper/object_i.yaml"
    return [str(program_of(checkout)), "run", str(config), "--runs", str(runs), "--quiet", f"seed={seed}"]


def tell(name, times):
    print(f"{name:<14} least {min(times):5.2f} ms, median {statistics.median(times):5.2f} ms")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--runs", type=int, default=50, metavar="N", help="runs of each kind (default 50)")
    parser.add_argument("--vs", type=pathlib.Path, metavar="CHECKOUT", help="another checkout, with its release build")
    arguments = parser.parse_args()
    checkouts = [ROOT] + ([arguments.vs.resolve()] if arguments.vs else [])
    if arguments.runs < 1:
        parser.error(f"--runs {arguments.runs}: takes 1 or more")
    for missing in (one for one in map(program_of, checkouts) if not os.access(one, os.X_OK)):
        parser.error(f"{missing} is not there: build that checkout, ./palpate --version does")
    seeds = range(1, arguments.runs + 1)
    memory = "/dev/shm" if os.access("/dev/shm", os.W_OK) else None
    tell("empty process", [milliseconds([shutil.which("true")]) for _ in seeds])
    tell("version only", [milliseconds([str(program_of(ROOT)), "--version"]) for _ in seeds])
    with tempfile.TemporaryDirectory(dir=memory) as scratch:
        # Each in a folder of its own, so that none finds files of the other.
        folders = [pathlib.Path(scratch) / name for name in ("ours", "theirs")]
        rounds = [[milliseconds(paper_run(*pair, seed)) for pair in zip(checkouts, folders)] for seed in seeds]
    ours, *others = zip(*rounds)
    tell("paper run", ours)
    for theirs in others:
        tell("theirs", theirs)
        print(f"ours / theirs  median {statistics.median(map(lambda pair: pair[0] / pair[1], rounds)):.3f}")


if __name__ == "__main__":
    main()
