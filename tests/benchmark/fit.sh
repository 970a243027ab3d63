#!/bin/sh
# SPDX-License-Identifier: MIT
# Time of one hyperparameter fit (length scale, signal, noise; no priors; one start at 1 cm, 1, 1e-2) of
# tests/data/fit_N.csv, ours and scikit-learn's L-BFGS with one thread of OpenBLAS, in alternating rounds. Prints the
# medians and their ratio, and what log marginal likelihood each reached.
#   fit.sh [ROUNDS]      3 unless given; run it on an idle machine
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
ours=$root/build/release/tests/fit_benchmark
rounds=${1:-3}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

median() { sort -g "$1" | awk '{t[NR] = $1} END {print t[int((NR + 1) / 2)]}'; }

printf '%6s  %10s  %14s  %6s  %12s  %12s\n' points 'palpate ms' 'scikit-learn ms' ratio 'palpate LML' 'scikit LML'
for points in 50 200 1000; do
  repeat=9
  [ "$points" -lt 1000 ] || repeat=1
  for round in $(seq "$rounds"); do
    "$ours" "$points" "$repeat" >"$scratch/a"
    /usr/bin/python3 "$root/tests/benchmark/fit_sklearn.py" "$root/tests/data/fit_$points.csv" "$repeat" >"$scratch/b"
    cut -d' ' -f2 "$scratch/a" >>"$scratch/a_$points"
    cut -d' ' -f1 "$scratch/b" >>"$scratch/b_$points"
  done
  a=$(median "$scratch/a_$points")
  b=$(median "$scratch/b_$points")
  awk -v n="$points" -v a="$a" -v b="$b" -v la="$(cut -d' ' -f3 "$scratch/a")" -v lb="$(cut -d' ' -f2 "$scratch/b")" \
    'BEGIN {printf "%6d  %10.3f  %14.2f  1/%-5.1f  %12.4f  %12.4f\n", n, a, b, b / a, la, lb}'
done
