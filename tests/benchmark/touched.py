#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Prints a table of what runs over scenes with several objects come to: the share of runs that touched all objects,
the mean footprint_iou, and the share of runs in which the footprint merges or splits objects. One row per group and
number of taps. FILE is the results.csv of a sweep, or the results_at_TAPS.csv that `palpate compare --at TAPS` leaves
beside it.

    tests/benchmark/touched.py COLUMN FILE...      groups are the values of COLUMN
"""
import csv
import sys

column, *files = sys.argv[1:]
groups = {}
for file in files:
    with open(file, newline="") as lines:
        for row in csv.DictReader(lines):
            groups.setdefault((int(row["taps"]), row[column]), []).append(row)


def share(rows, holds):
    return f"{100 * sum(map(holds, rows)) / len(rows):.0f} %"


print(f"| {column} | taps | runs | all touched | footprint_iou | merged or split |\n|---|---:|---:|---:|---:|---:|")
for (taps, group), rows in sorted(groups.items(), key=lambda item: item[0][0]):
    print(f"| {group} | {taps} | {len(rows)}", share(rows, lambda row: row["objects_found"] == row["objects"]),
          f"{sum(float(row['footprint_iou']) for row in rows) / len(rows):.2f}",
          share(rows, lambda row: row["objects_merged"] != "0" or row["objects_split"] != "0") + " |", sep=" | ")
