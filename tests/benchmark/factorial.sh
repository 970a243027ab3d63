#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs configs/benchmark/factorial.yaml and prints the table of framework/docs/comparing.md: rmse_m after 30 taps by
# acquisition and belief, the mean over the seeds (of a seed: over the objects), with the half width of its 95 % interval
# (Student's t over the seeds), and below it what of the gain over grid and random taps with the belief of
# `weighted_two_part` comes of the taps and what of the belief: each is changed first once, and second once.
#   sh tests/benchmark/factorial.sh [KEY=VALUE...]       for example "seed=range(1000,1005)"
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$root/palpate" sweep "$root/configs/benchmark/factorial.yaml" "$@" --runs "$scratch" --quiet >/dev/null
awk -F, '
  # The 97.5 % quantile of Student t, by its expansion about the normal one: within 0.3 % from 4 degrees on.
  function quantile(degrees) { return 1.95996 + 2.37227 / degrees + 2.82250 / degrees ^ 2 + 2.55585 / degrees ^ 3 }
  # Mean over the seeds with its interval, of a sum of cells: "+CELL-CELL", each with a weight.
  function shown(cells, weights, count,    i, seed, value, n, sum, square, half) {
    n = sum = square = 0
    for (seed in seeds) {
      value = 0
      for (i = 1; i <= count; ++i) value += weights[i] * 1000 * error[cells[i], seed] / jobs[cells[i], seed]
      ++n; sum += value; square += value * value
    }
    if (n < 5) return sprintf("%.1f", sum / n)
    half = quantile(n - 1) * sqrt((square / n - (sum / n) ^ 2) / (n - 1))
    return sprintf("%.1f +- %.1f", sum / n, half)
  }
  function cell(acquisition, belief) { one[1] = acquisition SUBSEP belief; weight[1] = 1; return shown(one, weight, 1) }
  # What changing the acquisition, or the belief, takes off the error, the mean of before and after the other change.
  function share(what, acquisition, belief) {
    one[1] = acquisition SUBSEP belief
    one[2] = "footprint_then_height" SUBSEP belief
    one[3] = acquisition SUBSEP "default"
    one[4] = "footprint_then_height" SUBSEP "default"
    weight[1] = 0.5; weight[4] = -0.5
    weight[2] = what == "taps" ? -0.5 : 0.5
    weight[3] = -weight[2]
    return shown(one, weight, 4)
  }
  NR == 1 { for (i = NF; i >= 1; --i) at[$i] = i; next }
  $at["status"] == "done" {
    key = $at["acquisition"] SUBSEP $at["strategy"] SUBSEP $at["seed"]
    error[key] += $at["rmse_m"]
    ++jobs[key]
    seeds[$at["seed"]] = 1
  }
  END {
    print "| rmse_m [mm] of acquisition, with the belief of | `weighted` | `weighted_two_part` | `default` |"
    print "|---|---:|---:|---:|"
    n = split("random grid uncertainty weighted footprint_then_height", acquisitions, " ")
    for (a = 1; a <= n; ++a) {
      printf "| `%s` | %s | %s | %s |\n", acquisitions[a], cell(acquisitions[a], "weighted"),
        cell(acquisitions[a], "weighted_two_part"), cell(acquisitions[a], "default")
    }
    print ""
    print "| gain [mm] over the belief of `weighted_two_part` with | by the taps | by the belief |"
    print "|---|---:|---:|"
    for (a = 1; a < n; ++a) {
      printf "| `%s` | %s | %s |\n", acquisitions[a], share("taps", acquisitions[a], "weighted_two_part"),
        share("belief", acquisitions[a], "weighted_two_part")
    }
  }' "$scratch"/*/*/results.csv
