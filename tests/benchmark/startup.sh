#!/bin/sh
# SPDX-License-Identifier: MIT
# Wall time of one whole paper run, from process start to exit, a fresh id each time: minimum and median of 50, beside
# a process that does nothing but start. Run it on an idle machine.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
program=$root/build/release/palpate
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# measure NAME COMMAND...: runs it 50 times with `seed=1` ... `seed=50` behind it where NAME is "paper run".
measure() {
  name=$1
  shift
  : >"$scratch/times"
  for i in $(seq 50); do
    start=$(date +%s%N)
    if [ "$name" = "paper run" ]; then "$@" "seed=$i" >/dev/null; else "$@" >/dev/null; fi
    echo $(($(date +%s%N) - start)) >>"$scratch/times"
  done
  sort -n "$scratch/times" | awk -v name="$name" '{t[NR] = $1 / 1e6}
    END {printf "%-14s minimum %5.1f ms, median %5.1f ms\n", name, t[1], t[int((NR + 1) / 2)]}'
}

measure "empty process" true
measure "version only" "$program" --version
measure "paper run" "$program" run "$root/configs/paper/object_i.yaml" --runs "$scratch/runs" --quiet
