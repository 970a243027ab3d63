#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs configs/sweep/fitting.yaml and prints the table of framework/docs/runs.md: fixed against fitted hyperparameters, means over the
# seeds, and the mean of the paired differences with its 95 % interval (normal approximation). By the instructions that every
# processor has: an optimum is found to so many digits, and which tap comes next may hang on the last of them.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

echo "fitting: the runs take about half a minute on two cores" >&2
PALPATE_INSTRUCTIONS=baseline "$root/palpate" sweep "$root/configs/sweep/fitting.yaml" --runs "$scratch" --quiet >/dev/null
echo "| scene | surface | taps | nlpd fixed | nlpd fitted | difference | rmse fixed cm | rmse fitted cm | difference | coverage fixed | coverage fitted |"
echo "|---|---|---|---|---|---|---|---|---|---|---|"
awk -F, '
  NR == 1 { for (i = 1; i <= NF; ++i) at[$i] = i; next }
  {
    group = $at["scene"] " | " $at["belief.surface"] " | " $at["taps"]
    if (!(group in seen)) { seen[group] = 1; order[++groups] = group }
    key = group SUBSEP $at["seed"] SUBSEP $at["fitting"]
    nlpd[key] = $at["nlpd"]; rmse[key] = 100 * $at["rmse_m"]; coverage[key] = 100 * $at["coverage_95"]
    seeds[$at["seed"]] = 1
  }
  # Mean of fixed, of fitted, and of their difference with its interval.
  function compare(values, group, format,    seed, a, b, n, sa, sb, d, sd, sdd, half) {
    n = sa = sb = sd = sdd = 0
    for (seed in seeds) {
      a = values[group, seed, "fixed"]; b = values[group, seed, "ceres"]
      if (a == "" || b == "") continue
      ++n; sa += a; sb += b; d = b - a; sd += d; sdd += d * d
    }
    half = 1.96 * sqrt((sdd / n - (sd / n) ^ 2) / (n - 1))
    return sprintf(format " | " format " | %+.2f (%+.2f to %+.2f)", sa / n, sb / n, sd / n, sd / n - half, sd / n + half)
  }
  END {
    for (g = 1; g <= groups; ++g) {
      group = order[g]
      n = fixed = fitted = 0
      for (seed in seeds) {
        if (coverage[group, seed, "fixed"] == "" || coverage[group, seed, "ceres"] == "") continue
        ++n; fixed += coverage[group, seed, "fixed"]; fitted += coverage[group, seed, "ceres"]
      }
      printf "| %s | %s | %s | %.0f %% | %.0f %% |\n", group, compare(nlpd, group, "%.2f"), compare(rmse, group, "%.1f"), fixed / n, fitted / n
    }
  }' "$scratch"/*/*/results.csv
