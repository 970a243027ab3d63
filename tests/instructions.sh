#!/bin/sh
# SPDX-License-Identifier: MIT
# A ratchet: counts the instructions of fixed pieces of work by callgrind and holds them to
# tests/benchmark/instructions.csv. Neither load nor processor counts: our loops are those of the baseline instruction
# set, and so are the C library's, whose choice alone makes 2.7 %. What takes more than 2 % more has failed, and the
# functions that grew are named, against tests/benchmark/instructions/PIECE. A number that was raised needs a line in
# CHANGELOG.md, in the same commit, that names the piece.
#   sh tests/instructions.sh BUILD [--short] [PIECE...]     all pieces, those that are short, or some
#   sh tests/instructions.sh BUILD --write [PIECE...]       keeps what is counted as what they may take
# Counts are those of one compiler: status 77 where BUILD is of another, or valgrind is missing.
# shellcheck disable=SC2086 # the words of a piece are to be split
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
usage() {
  echo "instructions: takes the folder of a release build, then --short or --write, then pieces of $table" >&2
  exit 2
}
table=$root/tests/benchmark/instructions.csv
kept=$root/tests/benchmark/instructions
compiler='GNU 12.2.0'
[ -x "${1:-}/palpate" ] || usage
build=$(cd "$1" && pwd)
shift
mode=check
wanted=
short=no
for word in "$@"; do
  case $word in
    --short) short=yes ;;
    --write) mode='write' ;;
    -*) usage ;;
    *) grep -q "^$word," "$table" || usage; wanted="$wanted $word" ;;
  esac
done
command -v valgrind >/dev/null || { echo "instructions: skipped: valgrind is missing (packages.txt)" >&2; exit 77; }
"$build/palpate" --version | grep -qx "compiler: $compiler" ||
  { echo "instructions: skipped: the counts are those of $compiler" >&2; exit 77; }

work=$(mktemp -d)
mkdir "$work/counted"
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
program=$build/palpate
bench=$build/tests/palpate_bench
paper="$root/configs/paper/object_i.yaml log.sync=none"
default="$root/configs/default.yaml log.sync=none"
export PALPATE_PLUGIN_PATH='' PALPATE_INSTRUCTIONS=baseline HOME="$work"
# Nothing else of the environment is there, which every program reads through when it starts.
export GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512VL,-AVX512BW,-AVX2,-AVX,-FMA,-FMA4,-BMI1,-BMI2,-MOVBE,-LZCNT,-ERMS,-FSRM,-RTM,-SSE4_1,-SSE4_2,-SSSE3

# A run of the paper that ended after ten taps, as a kill leaves it.
killed() {
  "$program" run $paper --runs "$work/killed" --quiet
  run=$(echo "$work"/killed/*/*)
  rm "$run/summary.json"
  sed '/^{"tap": 11,/,$d' "$run/record.jsonl" >"$work/lines"
  cp "$work/lines" "$run/record.jsonl"
  echo "$run"
}

# command_of PIECE: what is counted.
command_of() {
  case $1 in
    w1_dense | w1_grid | w1_lowrank)
      echo "$bench --taps $root/tests/data/taps_w1.csv --grid 47 --baseline --engine ${1#w1_}" ;;
    w2_lowrank) echo "$bench --taps $root/tests/data/taps_w2.csv --grid 231 --baseline --engine lowrank" ;;
    fit_50 | fit_200) echo "$build/tests/fit_benchmark ${1#fit_} 1" ;;
    compose) echo "$program run $default --print-config" ;;
    paper_run) echo "$program run $paper --runs $work/runs --quiet" ;;
    resume) echo "$program resume $(killed) --quiet" ;;
    page)
      "$program" run $paper --runs "$work/shown" --quiet
      echo "$build/palpate-whole report $(echo "$work"/shown/*/*) --to $work/page" ;;
    sweep_of_ten) echo "$build/palpate-whole sweep $paper seed=range(0,10) --runs $work/runs -j 1 --quiet" ;;
    default_60) echo "$program run $default taps=${1#default_} --runs $work/runs --quiet" ;;
  esac
}

# count PIECE: its instructions, of all processes; what each function took is left in $work/counted/PIECE. A process that
# is forked begins with the counts of its parent, which grow with the time that one waited: those of a job are its own.
count() {
  words=$(command_of "$1")
  rm -f "$work"/out.*
  (cd "$work" && env -i PATH="$PATH" HOME="$HOME" PALPATE_PLUGIN_PATH= PALPATE_INSTRUCTIONS=baseline GLIBC_TUNABLES="$GLIBC_TUNABLES" \
    valgrind --tool=callgrind --zero-before='palpate::run_job*' \
    --callgrind-out-file="$work/out.%p" $words) >"$work/said" 2>&1 ||
    { cat "$work/said" >&2; echo "instructions: $1 failed: $words" >&2; exit 1; }
  awk '/^totals:/ {sum += $2} END {printf "%.0f\n", sum}' "$work"/out.*
  for file in "$work"/out.*; do callgrind_annotate --threshold=99 "$file"; done |
    sed -nE 's/^ *([0-9,]+) \([ 0-9.]+%\) +[^:]*:(.*) \[.*\]$/\1\t\2/p' | tr -d ',' |
    awk -F '\t' '{sum[$2] += $1} END {for (name in sum) printf "%.0f\t%s\n", sum[name], name}' |
    sort -k1,1nr -k2 | head -n 60 >"$work/counted/$1"
}

cp "$table" "$work/pieces"
failed=no
while IFS=, read -r piece is_short most; do
  [ "$piece" != piece ] || continue
  [ "$short" = no ] || [ "$is_short" = yes ] || continue
  case " $wanted " in "  " | *" $piece "*) ;; *) continue ;; esac
  counted=$(count "$piece")
  if [ "$mode" = write ]; then
    sed "s/^$piece,.*/$piece,$is_short,$counted/" "$table" >"$work/table"
    cp "$work/table" "$table"
    mkdir -p "$kept"
    cp "$work/counted/$piece" "$kept/$piece"
  fi
  echo "$piece $counted $most" | awk '{printf "%-14s %14.0f instructions, %+.2f %%\n", $1, $2, ($3 > 0 ? 100 * ($2 / $3 - 1) : 0)}'
  if [ "$mode" = write ] || [ "$counted" -le $((most + most / 50)) ]; then continue; fi
  failed=yes
  echo "instructions: $piece takes more than 2 % more than the $most of $table; what grew:" >&2
  awk -F '\t' 'NR == FNR {old[$2] = $1; next} {if ($1 > old[$2]) printf "%+15.0f  %s\n", $1 - old[$2], $2}' \
    "$kept/$piece" "$work/counted/$piece" | sort -k1,1gr | head -n 10 >&2
done <"$work/pieces"

# The last commit that changed the numbers says in CHANGELOG.md which it raised.
cd "$root"
last=$(git log -1 --format=%H -- tests/benchmark/instructions.csv 2>/dev/null || true)
if [ "$mode" = check ] && [ -n "$last" ] && git show "$last~1:tests/benchmark/instructions.csv" >"$work/before" 2>/dev/null; then
  git show "$last:tests/benchmark/instructions.csv" | awk -F , 'NR == FNR {old[$1] = $3; next}
    old[$1] + 0 > 0 && $3 > 1.02 * old[$1] {print $1}' "$work/before" - >"$work/raised"
  git show "$last" -- CHANGELOG.md | grep '^+' >"$work/told" || true
  while read -r piece; do
    grep -qw "$piece" "$work/told" && continue
    failed=yes
    echo "instructions: $last raised $piece, which no line that it added to CHANGELOG.md names" >&2
  done <"$work/raised"
fi
[ "$failed" = no ]
