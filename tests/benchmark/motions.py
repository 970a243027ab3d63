#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Height error, time and force of the motions on an arm like Baxter's: the taps of the paper's experiment on object I,
40 starts each. The truth is object I by its definition, not what the program says of it.

    tests/benchmark/motions.py [PROGRAM]     PROGRAM: ./palpate
"""
import csv
import glob
import math
import subprocess
import sys
import tempfile

PROGRAM = sys.argv[1] if len(sys.argv) > 1 else "./palpate"
ROWS = [
    ("paper", "2.4 cm/s", "10 N"),
    ("two_stage", "6 cm/s", "10 N"),
    ("continuous", "6 cm/s", "10 N"),
    ("continuous", "18 cm/s", "10 N"),
    ("continuous", "6 cm/s", "5 N"),
    ("continuous", "3 cm/s", "5 N"),
]


def truth(x, y):
    """9 + 2 cos(2 pi s / 8) cm on 6 x 16 cm around the middle of the area."""
    s = y - 0.115
    inside = abs(x - 0.115) <= 0.03 and abs(s) <= 0.08
    return 0.09 + 0.02 * math.cos(2 * math.pi * s / 0.08) if inside else 0.0


def main():
    print("| motion | speed of descent | threshold | height error (rms) | seconds a tap | peak force: mean, largest |")
    print("|---|---|---|---|---|---|")
    for motion, speed, threshold in ROWS:
        with tempfile.TemporaryDirectory() as runs:
            command = [PROGRAM, "sweep", "configs/paper/object_i.yaml", "scene=object_i_arm", "belief.surface=two_part",
                       "belief.height.signal=5cm", "motion=" + motion, "motion.speed=" + speed,
                       "motion.threshold=" + threshold, "seed=range(0,40)", "--runs", runs, "--quiet"]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            taps = []
            for file in sorted(glob.glob(runs + "/*/*/jobs/*/taps.csv")):
                with open(file, newline="", encoding="utf-8") as text:
                    taps += list(csv.DictReader(text))
        assert all(tap["outcome"] == "contact" for tap in taps)
        squares = [(float(tap["height"]) - truth(float(tap["x"]), float(tap["y"]))) ** 2 for tap in taps]
        seconds = [float(tap["robot_seconds"]) for tap in taps]
        forces = [float(tap["force"]) for tap in taps]
        print(f"| `{motion}` | {speed} | {threshold} | {1e3 * math.sqrt(sum(squares) / len(taps)):.1f} mm | "
              f"{sum(seconds) / len(taps):.1f} s | {sum(forces) / len(taps):.0f} N, {max(forces):.0f} N |")


main()
