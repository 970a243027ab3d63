#!/bin/sh
# SPDX-License-Identifier: MIT
# What reviewers would otherwise have to look for: arrows between folders, headers that stand alone, clang-format. Of the
# last two only what changed since the commit before is looked at, and what is not committed; with --all every header.
# Ends with status 1 and a line a fault.
#   sh tests/habits.sh [--all]
set -eu
cd "$(dirname "$(readlink -f "$0")")/.."
faults=$(mktemp)
trap 'rm -f "$faults"' EXIT

# A folder uses those above it in this list, which is that of framework/README.md, never those below.
folders="children config plugin scene gp experiment record sweep launch analysis report cli"
for file in $(git ls-files 'framework/core/*.[ch]pp' 'framework/lab/*.[ch]pp' 'framework/desk/*.[ch]pp' 'framework/cli/*.[ch]pp'); do
  sed -n "s|^#include \"\([a-z_]*\)/.*|$file \1|p" "$file"
done | awk -v folders="$folders" '
  BEGIN { n = split(folders, names, " "); for (i = 1; i <= n; ++i) rank[names[i]] = i }
  { split($1, path, "/"); from = path[2] == "cli" ? "cli" : path[3]
    if (!($2 in rank)) print $1 ": includes " $2 "/, which is no folder of the framework"
    else if (rank[$2] > rank[from]) print $1 ": " from " knows nothing of " $2 ", which stands below it" }' >>"$faults"
# Plugins see what their authors see, and each other's folders.
git grep -nE '^#include "(config|plugin|scene|gp|experiment|record|sweep|launch|analysis|report|cli)/' -- plugins |
  sed 's|:.*"\(.*\)"|: a plugin includes \1, which is not for plugins|' >>"$faults" || true

changed=$( (git diff --name-only --diff-filter=d HEAD~1 2>/dev/null || true; git ls-files --others --exclude-standard) |
  grep -E '^(framework|plugins|tests)/.*\.[ch]pp$' | sort -u || true)

if [ -n "$changed" ] && clang-format --version 2>/dev/null | grep -q 'version 14\.'; then
  for file in $changed; do
    clang-format --dry-run -Werror "$file" 2>/dev/null || echo "$file: is not as clang-format -i would have it"
  done >>"$faults"
elif [ -n "$changed" ]; then
  echo "habits: skipped: clang-format, which has to be version 14" >&2
fi

[ "${1:-}" != --all ] || changed=$(git ls-files 'framework/*.hpp')
includes="-Iframework/core -Iframework/lab -Iframework/desk -Iframework/shared -Iframework -Iframework/include -Iplugins -Iplugins/backends
  -Itests -isystem /usr/include/eigen3"
echo "$changed" | grep '^framework/.*\.hpp$' | xargs -r -P "$(nproc)" -I FILE sh -c "g++ -std=c++17 -fsyntax-only $(echo $includes) -x c++ FILE >/dev/null 2>&1 ||
  echo 'FILE: does not stand alone: it lacks an include'" >>"$faults"

sort -u "$faults" >&2
[ ! -s "$faults" ]
