#!/bin/sh
# SPDX-License-Identifier: MIT
# Counts lines of code, per folder, and the sums that are to shrink: of the files as they lie here, but those that git
# ignores, or of those of a commit.
# A line of code has something on it that is neither blank nor comment. A comment is what follows //, or stands between
# /* and */ (in scripts: what follows #), with nothing but blanks before it; within a string of several lines, too.
# Code is C++ (.cpp .hpp .inc) and JavaScript (.js): of framework and plugins together, and of tests. Scripts (shell,
# Python, CMake, CSS, HTML; `.` is the top level) are counted apart, so that code does not hide in them. A folder named
# vendor is not counted.
#   sh tests/size.sh [COMMIT]
set -eu
cd "$(dirname "$(readlink -f "$0")")/.."
if [ $# -gt 0 ]; then
  commit=$(git rev-parse --verify --quiet "$1^{commit}") || {
    echo "size.sh: there is no commit '$1'" >&2
    exit 2
  }
  there=$(mktemp -d)
  trap 'rm -rf "$there"' EXIT
  git archive "$commit" | tar -x -C "$there"
  cd "$there"
  list() { find . -type f | sed 's|^\./||'; }
else
  list() { git ls-files --cached --others --exclude-standard; }
fi
list | LC_ALL=C sort | awk '
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
    printf "%-28s %8s %8s\n", "", "code", "scripts"
    for (i = 1; i <= folders; ++i)
      printf "%-28s %8d %8d\n", order[i], count["code", order[i]], count["scripts", order[i]]
    for (i = 1; i <= split("framework and plugins;tests;the rest", sum, ";"); ++i)
      printf "%-28s %8d %8d\n", "all of " sum[i], count["code", sum[i], "all"], count["scripts", sum[i], "all"]
  }'
