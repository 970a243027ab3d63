#!/bin/sh
# SPDX-License-Identifier: MIT
# Counts the instructions of fixed computations with callgrind and compares them with tests/benchmark/instructions.csv. A
# computation fails that takes over 10 % more; its largest functions are printed. Load and processor do not count: loops
# use AVX2, and the C library the baseline instruction set. Compilers from g++ 12 to 14 differ by less than 10 %. With other
# compilers, on processors without AVX2, or without valgrind, the status is 77.
#   sh tests/instructions.sh BUILD [--short] [PIECE...]     all pieces, those that are short, or some
#   sh tests/instructions.sh BUILD --write [--reason TEXT] [PIECE...]
#                       records counts that differ by more than 1 %; higher counts only with a reason, which is written beside them
# shellcheck disable=SC2086 # the words of a piece are to be split
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
table=$root/tests/benchmark/instructions.csv
usage() {
  echo "instructions: takes the folder of a release build, then --short, --write or --reason TEXT, then pieces of $table" >&2
  exit 2
}
[ -x "${1:-}/palpate" ] || usage
build=$(cd "$1" && pwd)
shift
mode=check
wanted=
short=no
reason=
while [ $# -gt 0 ]; do
  case $1 in
    --short) short=yes ;;
    --write) mode='write' ;;
    --reason) [ $# -ge 2 ] || usage; reason=$2; shift ;;
    -*) usage ;;
    *) grep -q "^$1," "$table" || usage; wanted="$wanted $1" ;;
  esac
  shift
done
case $reason in *'"'* | *'
'*) echo "instructions: a reason is one line without double quotes" >&2; exit 2 ;; esac
{ [ "$(uname -m)" = x86_64 ] && grep -qw avx2 /proc/cpuinfo; } ||
  { echo "instructions: skipped: the counts are those of an x86-64 processor with AVX2" >&2; exit 77; }
command -v valgrind >/dev/null || { echo "instructions: skipped: valgrind is missing (packages.txt)" >&2; exit 77; }
"$build/palpate" --version | grep -qx 'compiler: GNU 1[234]\..*' ||
  { echo "instructions: skipped: the counts are those of g++ 12 to 14" >&2; exit 77; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
program=$build/palpate
bench=$build/tests/palpate_bench
paper="$root/configs/paper/object_i.yaml log.sync=none"
default="$root/configs/default.yaml log.sync=none"
# Only these variables are set: every program reads through its environment when it starts.
variables="PATH=$PATH HOME=$work PALPATE_PLUGIN_PATH= PALPATE_INSTRUCTIONS=AVX2
  GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512VL,-AVX512BW,-AVX2,-AVX,-FMA,-FMA4,-BMI1,-BMI2,-MOVBE,-LZCNT,-ERMS,-FSRM,-RTM,-SSE4_1,-SSE4_2,-SSSE3"

# made NAME: makes a run of the paper, and prints its directory.
made() {
  env -i $variables "$program" run $paper --runs "$work/$1" --quiet
  echo "$work/$1"/*/*
}

# A run of the paper that ended after ten taps, as a kill leaves it.
killed() {
  run=$(made killed)
  rm "$run/summary.json"
  sed '/^{"tap": 11,/,$d' "$run/record.jsonl" >"$work/lines"
  cp "$work/lines" "$run/record.jsonl"
  echo "$run"
}

# command_of PIECE: the counted command.
command_of() {
  case $1 in
    w1_dense | w1_grid | w1_lowrank)
      echo "$bench --taps $root/tests/data/taps_w1.csv --grid 47 --engine ${1#w1_}" ;;
    w2_lowrank) echo "$bench --taps $root/tests/data/taps_w2.csv --grid 231 --engine lowrank" ;;
    fit_50 | fit_200) echo "$build/tests/fit_benchmark ${1#fit_} 1" ;;
    perfect_taps) echo "$build/tests/tap_cost --perfect 200000" ;;
    compose) echo "$program run $default --print-config" ;;
    paper_run) echo "$program run $paper --runs $work/runs --quiet" ;;
    resume) echo "$program resume $(killed) --quiet" ;;
    page) echo "$build/palpate-whole report $(made shown) --to $work/page" ;;
    sweep_of_ten) echo "$build/palpate-whole sweep $paper seed=range(0,10) --runs $work/runs -j 1 --quiet" ;;
    default_60) echo "$program run $default taps=${1#default_} --runs $work/runs --quiet" ;;
  esac
}

# count PIECE: the instructions of all its processes. A forked process begins with the counts of its parent, which depend on
# how long that waited: those of a job are counted from its beginning.
count() {
  words=$(command_of "$1")
  rm -f "$work"/out.*
  (cd "$work" && env -i $variables valgrind --tool=callgrind --zero-before='palpate::run_job*' \
    --callgrind-out-file="$work/out.%p" $words) >"$work/said" 2>&1 ||
    { cat "$work/said" >&2; echo "instructions: $1 failed: $words" >&2; exit 1; }
  awk '/^totals:/ {sum += $2} END {printf "%.0f\n", sum}' "$work"/out.*
}

# record PIECE SHORT COUNT STATED: replaces the line of the piece.
record() {
  stated=$4 awk -F, -v piece="$1" -v line="$1,$2,$3," '$1 == piece { print line ENVIRON["stated"]; next } { print }' "$table" >"$work/table"
  cp "$work/table" "$table"
}

cp "$table" "$work/pieces"
failed=no
while IFS=, read -r piece is_short most _; do
  [ "$piece" != piece ] || continue
  [ "$short" = no ] || [ "$is_short" = yes ] || continue
  case " $wanted " in "  " | *" $piece "*) ;; *) continue ;; esac
  counted=$(count "$piece")
  echo "$piece $counted $most" | awk '{printf "%-14s %14.0f instructions, %+.1f %%\n", $1, $2, 100 * ($2 / $3 - 1)}'
  if [ "$mode" = write ]; then
    if [ "$counted" -lt $((most - most / 100)) ]; then
      record "$piece" "$is_short" "$counted" ''
    elif [ "$counted" -gt $((most + most / 100)) ]; then
      [ -z "$reason" ] || { record "$piece" "$is_short" "$counted" "\"$reason\""; continue; }
      echo "instructions: $piece takes more than the $most of $table: give the reason by --reason TEXT" >&2
      failed=yes
    fi
    continue
  fi
  [ "$counted" -gt $((most + most / 10)) ] || continue
  failed=yes
  echo "instructions: $piece takes over 10 % more than the $most of $table; its largest functions:" >&2
  for file in "$work"/out.*; do callgrind_annotate --threshold=80 "$file"; done | sed -n 's/^ *[0-9,]* ([ 0-9.]*%) /&/p' | head -n 10 >&2
done <"$work/pieces"
[ "$failed" = no ]
