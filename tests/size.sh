#!/bin/sh
# SPDX-License-Identifier: MIT
# Counts lines of code per folder: of the working tree without files that git ignores, or of a commit. Without a commit it
# fails if a folder exceeds its ceiling in the table below.
# A line of code has something on it that is neither blank nor comment. A comment is the text after //, or between /* and */
# (in scripts: after #), with nothing but blanks before it; within a string of several lines, too.
# Code is C++ (.cpp .hpp .inc) and JavaScript (.js). Scripts (shell, Python, CMake, CSS, HTML; `.` is the top level) are
# counted separately. A folder named vendor is not counted.
#   sh tests/size.sh [COMMIT]
#   sh tests/size.sh --ceilings      prints the table for the present size: 2 % more, and five lines
set -eu
cd "$(dirname "$(readlink -f "$0")")/.."
# Folder, most lines of code, most lines of scripts. Write the reason for a raised number after # at the end of its line.
ceilings='
.ci 0 131
. 0 199
framework 0 163 # tune; one file of CMake per library
framework/analysis 3390 0 # planned comparisons; power and importance; tables by one model
framework/belief 2115 0 # beliefs by an interface
framework/bundle 965 0 # archives, contents and checks of bundles
framework/calibrate 548 0
framework/cli 4560 63 # bundle, verify and rerun; planned comparisons; tune and power; one file per command, with its arguments
framework/cmake 0 220 # packages of a cross build
framework/config 3155 0
framework/experiment 1560 0 # initial design and best score in files of their own
framework/gp 2580 0 # the offset model; checks of maps for finite numbers
framework/host 812 0
framework/include 1135 0 # beliefs as plugins: grids of taps, settings of the run, phases; normal numbers and closed ranges for all
framework/launch 990 0 # a cluster continues a race; a table of launchers
framework/python 750 715 # tune; one file per class of the module; lines of any direction
framework/record 4603 0
framework/report 5919 97 # the page of a race; facts of pages are computed in C++
framework/scene 739 0
framework/shared 1392 0 # counts of factorisations for beliefs
plugins/beliefs 3060 9 # the belief solids
framework/sweep 1945 0 # rounds; pooled records in files of their own
framework/tune 1466 0 # the race of palpate tune
framework/watch 709 0
plugins 33 78
plugins/acquisitions 751 96 # each folder builds itself
plugins/backends 5905 528 # lines of any direction for programs and records; longer names
plugins/fitting 953 18 # each folder builds itself
plugins/footprints 2422 15 # each folder builds itself
plugins/kernels 547 9 # each folder builds itself
plugins/programs 520 14 # each folder builds itself
plugins/shapes 1990 28 # each folder builds itself
plugins/starters 286 28 # a belief without a GP, with a field of its own
tests 0 2025 # palpate tune; reasons for counts of instructions, campaigns by name, checks of packages for ARM, sizes of classes
tests/bad_plugins 447 49
tests/baxter 5676 0
tests/benchmark 1155 1000 # race_grid; irace and Optuna
tests/consumer 165 0
tests/contract 1520 0 # laws of beliefs
tests/crash 414 434
tests/fake_baxter 2425 47
tests/fuzz 395 0 # archives of bundles
tests/python 0 1235 # tune; taps from any side by ask and tell
tests/report 1325 85 # planned comparisons
tests/slurm 540 0 # races, their end and how to stop them
tests/stability 2435 0
tests/support 2355 0 # the simulator as a program of the backend process; grids of candidates, which only tests make; races
tests/sweep 5520 0 # archives; planned comparisons, races, power, importance
tests/system 10060 0 # bundles; planned comparisons; tune; lines of any direction for programs and records; beliefs
tests/unit 17395 0 # oracles of the footprint: pushes, calibration, enumeration, joint distribution; strategies over other beliefs
tests/ur_rtde 0 230
tests/versions 50 17
'
list() { git ls-files --cached --others --exclude-standard; }
mode=count
if [ "${1:-}" = --ceilings ]; then
  mode='ceilings'
elif [ $# -gt 0 ]; then
  commit=$(git rev-parse --verify --quiet "$1^{commit}") || {
    echo "size.sh: there is no commit '$1'" >&2
    exit 2
  }
  there=$(mktemp -d)
  trap 'rm -rf "$there"' EXIT
  git archive "$commit" | tar -x -C "$there"
  cd "$there"
  ceilings=
  list() { find . -type f | sed 's|^\./||'; }
fi
list | LC_ALL=C sort | mode=$mode ceilings=$ceilings awk '
  function with_room(lines) { return int(1.02 * lines) + (lines > 0 ? 5 : 0) }
  function language(path) {
    if (path ~ /(^|\/)vendor\//) return ""
    if (path ~ /\.(cpp|hpp|inc|js)$/) return "code"
    if (path ~ /\.(css|html)$/) return "styles"
    if (path ~ /\.(sh|py|cmake)$|(^|\/)CMakeLists\.txt$|^(check|palpate|\.ci\/run)$/) return "scripts"
    return ""
  }
  function is_code(line, marks) {  # `inside`: of a comment that the lines before began
    sub(/^[ \t\r]+/, "", line)
    if (marks == "#") return line != "" && line !~ /^#/
    for (;;) {
      if (inside) {
        if (!(end = index(line, "*/"))) return 0
        line = substr(line, end + 2)
        inside = 0
        sub(/^[ \t\r]+/, "", line)
      }
      if (line !~ /^\/\*/) return line != "" && line !~ /^\/\//
      inside = 1
      line = substr(line, 3)
    }
  }
  {
    path = $0
    if (!(kind = language(path))) next
    depth = split(path, part, "/")
    folder = depth > 2 ? part[1] "/" part[2] : depth > 1 ? part[1] : "."
    marks = kind == "scripts" ? "#" : "/"
    if (kind == "styles") kind = "scripts"
    inside = lines = 0
    while ((got = (getline line < path)) > 0) lines += is_code(line, marks)
    if (got < 0) next  # git has it, this folder does not
    close(path)
    if (!(folder in seen)) { seen[folder] = 1; order[++folders] = folder }
    count[kind, folder] += lines
    part_of = part[1] == "tests" ? "tests" : part[1] ~ /^(framework|plugins)$/ ? "framework and plugins" : "the rest"
    count[kind, part_of, "all"] += lines
  }
  END {
    if (ENVIRON["mode"] == "ceilings") {
      for (i = 1; i <= folders; ++i)
        print order[i], with_room(count["code", order[i]]), with_room(count["scripts", order[i]])
      exit
    }
    printf "%-28s %8s %8s\n", "", "code", "scripts"
    for (i = 1; i <= folders; ++i)
      printf "%-28s %8d %8d\n", order[i], count["code", order[i]], count["scripts", order[i]]
    for (i = 1; i <= split("framework and plugins;tests;the rest", sum, ";"); ++i)
      printf "%-28s %8d %8d\n", "all of " sum[i], count["code", sum[i], "all"], count["scripts", sum[i], "all"]
    for (i = split(ENVIRON["ceilings"], entry, "\n"); i > 0; --i) {
      split(entry[i], word, " ")
      most["code", word[1]] = word[2]
      most["scripts", word[1]] = word[3]
    }
    for (i = 1; i <= folders && ENVIRON["ceilings"] != ""; ++i)
      for (k = split("code scripts", kinds, " "); k > 0; --k)
        if (count[kinds[k], order[i]] + 0 > most[kinds[k], order[i]] + 0) {
          print "size.sh: " order[i] " has " count[kinds[k], order[i]] " lines of " kinds[k] ", its ceiling is " most[kinds[k], order[i]] + 0 ": delete some, or raise it in tests/size.sh with a reason" >"/dev/stderr"
          exceeded = 1
        }
    exit exceeded
  }'
