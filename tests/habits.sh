#!/bin/sh
# SPDX-License-Identifier: MIT
# What reviewers would otherwise have to look for: arrows between folders, retired names, long sentences, large classes, headers that
# stand alone, clang-format and clang-tidy. Of the last three only what changed since the commit before is looked at, and what is not committed;
# clang-tidy takes seconds for a file, so it reads the first ten of them, without its analyzer. With --all everything is
# looked at, with the analyzer, which takes the better part of an hour. Ends with status 1 and a line a fault.
#   sh tests/habits.sh [--all]
set -eu
cd "$(dirname "$(readlink -f "$0")")/.."
found=$(mktemp -d)
generated=$(mktemp -d)
trap 'rm -rf "$found" "$generated"' EXIT

# A folder uses those above it in this list, which is that of framework/README.md, never those below.
folders="math children reading answers regular config host scene gp belief experiment record sweep launch analysis tune bundle calibrate report watch cli"
# The folders of palpate_core.
core="framework/config framework/host framework/scene framework/gp framework/belief framework/experiment framework/record"
for file in $(git ls-files 'framework/*.[ch]pp' ':!framework/include' ':!framework/shared' ':!framework/python'); do
  [ ! -f "$file" ] || sed -n "s|^#include \"\([a-z_]*\)/.*|$file \1|p" "$file"
done | awk -v folders="$folders" '
  BEGIN { n = split(folders, names, " "); for (i = 1; i <= n; ++i) rank[names[i]] = i }
  { split($1, path, "/"); from = path[2]
    if (!($2 in rank)) print $1 ": includes " $2 "/, which is no folder of the framework"
    else if (rank[$2] > rank[from]) print $1 ": " from " knows nothing of " $2 ", which stands below it" }' >"$found/arrows"
# What a tap may depend on has the same bytes on every machine: palpate/math.hpp. Baxter's driver runs on one, and texts
# of numbers (config/display_units.cpp) decide nothing.
# shellcheck disable=SC2086 # the names are to be split
git grep -nE '(std|Eigen)::(exp2?|expm1|log|log1p|log2|log10|hypot|sin|cos|tan|a?sinh?|a?cosh?|atan2?|a?tanh|pow|cbrt|erfc?|l?tgamma)\(|Eigen::(AngleAxis|Rotation2D)|(\)|array)\.(exp|log|log1p|pow|sin|cos|tan|atan|tanh|erf)\(\)' -- \
  $core 'framework/include/*.hpp' 'framework/shared/*.[ch]pp' 'plugins/*.[ch]pp' \
  ':!framework/shared/math' ':!framework/config/display_units.cpp' ':!plugins/backends/baxter' |
  sed 's|^\([^:]*:[0-9]*\):.*|\1: an elementary function of the platform, palpate/math.hpp has its own|' >"$found/elementary" || true

# Plugins see what their authors see, and each other's folders; the belief `solids` is made of the GPs of core, too.
git grep -nE '^#include "(config|host|scene|gp|belief|experiment|record|sweep|launch|analysis|report|watch|cli)/' -- plugins ':!plugins/beliefs/solids' |
  sed 's|:.*"\(.*\)"|: a plugin includes \1, which is not for plugins|' >"$found/plugins" || true

# Files of others are read by the bounded reader alone (shared/reading): regular ones, up to a limit, through no link in a
# record. record/files.cpp and record_files.cpp open what they write; the devices named here are nobody's.
git grep -nE 'std::i?fstream|fopen *\(|(^|[ =(!])::open(at)?\(|directory_iterator|opendir *\(|LoadFile *\(' -- \
  'framework/*.[ch]pp' 'plugins/*.[ch]pp' |
  grep -vE '^(framework/shared/reading/read_file|framework/record/files|plugins/programs/record_files)\.cpp:' |
  grep -vE '"/dev/(null|full)"' |
  sed 's|^\([^:]*:[0-9]*\):.*|\1: opens a file or lists a folder itself, which is for shared/reading|' >"$found/reading" || true

# People see quantities by config/display_units.hpp: no line fixes the decimals of a length or a time itself.
git grep -nE '\{:\.[0-9]f\} (cm|mm|m|s)\b|toFixed\(' -- 'framework/cli/*.cpp' 'framework/analysis/*.cpp' \
  'framework/report/*.cpp' 'framework/report/page/web/*.js' |
  sed 's|^\([^:]*:[0-9]*\):.*|\1: fixes the decimals of a quantity, which is for config/display_units.hpp or common.js|' >"$found/quantities" || true

# Retired names, as whole words; a word that has another meaning, too, is listed with its key. Three lines a file are shown.
# tests/same_taps.csv maps old names to new ones.
git grep -nowIF --untracked -f - -- . ':!tests/habits.sh' ':!tests/same_taps.csv' <<'names' |
"doubted"
"handed_over"
Workshop
acquisition=foresight
acquisition=inside
acquisition=mixture
acquisition=outline
backend.motion
backend.place
backend=adaptive
backend=chosen
backend=continuous
backend=gentle
backend=paper
backend=two_stage
dead start
dead starts
desks.md
exactness.md
footprint.acceptance
footprint.blur
footprint.contradictions
footprint.expected
footprint.handed_over
footprint.hollow
footprint.largest
footprint.left
footprint.lies
footprint.mistaken
footprint.mistakes
footprint.pieces
footprint.pushed
footprint.pushes
footprint.smallest
footprint: classifier
footprint: regression
footprint: shape
footprint=classifier
footprint=regression
footprint=shape
foresight
framework/core
framework/desk
framework/lab
gates.md
haste
height.lies
height.systematic
height_process
height_refused
instruction_set
interventions
lies: 0
live start
live starts
lowrank.precision
lowrank.tolerance
missed_taps
nearest_m
off_surface
off_surface_taps
on_surface
on_surface_above
on_surface_probability
on_surface_taps
outline_and_fill
palpate_desk
palpate_lab
plugins footprint/classifier
plugins footprint/regression
plugins footprint/shape
posterior: auto
posterior: dense
posterior: grid
posterior: lowrank
posterior=auto
posterior=dense
posterior=grid
posterior=lowrank
rmse_on_surface
rmse_on_surface_m
set_aside
space.compositions
space.misfit
surface_process
true_on_surface
type: classifier
type: mixture
type: regression
type: shape
ways_broken
weight_process
names
  awk -F : '++count[$1] <= 3 { name = $0; sub(/^[^:]*:[^:]*:/, "", name); print $1 ":" $2 ": has the retired name " name }' >"$found/names"

# words MODE PAGE...: reads the prose of pages: without code, HTML and addresses, each cell of a table by itself. Outside
# of tables a sentence begins with a capital: one that begins with code is hard to see and counts with the one before. MODE
# `long` prints sentences of more than 35 words, `what` how often "what" and "who" occur in 1000 words of each page.
words() {
  mode=$1
  shift
  awk -v mode="$mode" '
    function finish() {
      if (mode == "long" && count > 35) print page ":" start ": has a sentence of " count " words, 35 are the limit"
      count = ended = 0
    }
    function report() {
      if (mode == "what" && total) printf "%s%s %.1f", (reported++ ? ", " : ""), page, 1000 * asking / total
      total = asking = 0
    }
    function read(text,    parts, n, i, word) {
      n = split(text, parts, " ")
      for (i = 1; i <= n; ++i) {
        if (ended && (in_cell || parts[i] ~ /^["*(\[]*[A-Z]/)) finish()
        ended = 0
        word = tolower(parts[i])
        gsub(/^[^a-z0-9]+|[^a-z0-9]+$/, "", word)
        if (word == "") continue
        if (!count++) start = FNR
        ++total
        if (word ~ /^(what|who)(ever)?$/) ++asking
        if (parts[i] ~ /[.?!][]"*)]*$/ && parts[i] !~ /^(e\.g|i\.e|cf|vs)\.$/) ended = 1
      }
    }
    FNR == 1 { finish(); report(); page = FILENAME; fenced = 0; indented = 0; blank = 1 }
    /^ *```/ { fenced = !fenced; finish(); blank = 1; next }
    fenced { next }
    /^ *$/ { finish(); blank = 1; next }
    /^    / && (blank || indented) { indented = 1; blank = 0; next }
    { indented = 0; blank = 0
      if ($0 ~ /^ *([-*]|[0-9]+\.) / || $0 ~ /^ *[|#]/) finish()
      gsub(/`[^`]*`/, "code"); gsub(/<[^>]*>/, ""); gsub(/\]\([^)]*\)/, "]")
      if ($0 ~ /^ *\|/) {
        cells = split($0, cell, "|")
        in_cell = 1
        for (c = 1; c <= cells; ++c) { read(cell[c]); finish() }
        in_cell = 0
      } else read($0)
      if ($0 ~ /^ *#/) finish() }
    END { finish(); report(); if (mode == "what") print "" }' "$@"
}
# No class grows beyond its limits, and no folder beyond its ceiling.
python3 tests/class_sizes.py >"$found/classes" || true
sh tests/size.sh 2>&1 >/dev/null | sed 's/^size.sh: //' >"$found/size" || true

pages=$(git ls-files '*.md')
# shellcheck disable=SC2086 # the names are to be split
words long $pages >"$found/sentences"
# shellcheck disable=SC2086
echo "habits: 'what' and 'who' in 1000 words: $(words what $pages)" >&2

if [ "${1:-}" = --all ]; then
  changed=$(git ls-files framework plugins tests)
  most=100000 analyzer=
else
  changed=$(git diff --name-only --diff-filter=d HEAD~1 2>/dev/null || true; git ls-files --others --exclude-standard)
  most=10 analyzer='-clang-analyzer-*'
fi
changed=$(echo "$changed" | grep -E '^(framework|plugins|tests)/.*\.[ch]pp$' | sort -u || true)

# of14 TOOL: whether the tool is there, in the version whose word counts.
of14() {
  "$1" --version 2>/dev/null | grep -q 'version 14\.' || { echo "habits: skipped: $1, which has to be version 14" >&2; return 1; }
}
if [ -n "$changed" ] && of14 clang-format; then
  for file in $changed; do
    clang-format --dry-run -Werror "$file" 2>/dev/null || echo "$file: is not as clang-format -i would have it"
  done >"$found/format"
fi

# each FILES COMMAND: runs the command, which names FILE, for each of them, as many at once as there are cores, and keeps
# what it says.
each() { echo "$1" | xargs -r -P "$(nproc)" -I FILE sh -c "{ $2; } >\$(mktemp $found/each.XXXXXX) 2>/dev/null || true"; }

# The build writes the table of launchers; one entry is enough here.
mkdir "$generated/launch"
echo 'PALPATE_LAUNCHER(local, false)' >"$generated/launch/launcher_table.inc"
includes="-I$generated -Iframework/shared -Iframework -Iframework/include -isystem /usr/include/eigen3 $(/usr/bin/python3-config --includes 2>/dev/null || true)"
# Highway's header is read once for each instruction set, by a file that has named itself.
each "$(echo "$changed" | grep '^framework/.*\.hpp$' | grep -v '^framework/shared/math/highway\.hpp$')" \
  "g++ -std=c++17 -fsyntax-only $includes -x c++ FILE || echo 'FILE: does not stand alone: it lacks an include'"

# What ROS generates is there only where it was built.
sources=$(echo "$changed" | grep '\.cpp$' | grep -vE '/(baxter|fake_baxter|fuzz|bad_plugins)/' || true)
if [ -n "$sources" ] && of14 clang-tidy; then
  # Every file alone: the files of a unity build have no entries of their own.
  cmake --preset release -B build/tidy -DPALPATE_BATCH=1 -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
  # Sources that this build does not compile, such as starters, have no options to be read with.
  sources=$(for file in $sources; do ! grep -qF "/$file\"" build/tidy/compile_commands.json || echo "$file"; done)
  [ "$(echo "$sources" | wc -l)" -le "$most" ] ||
    echo "habits: clang-tidy reads $most of $(echo "$sources" | wc -l) changed files, the rest with --all" >&2
  each "$(echo "$sources" | head -n "$most")" \
    "clang-tidy --quiet --checks='$analyzer' -p build/tidy FILE | grep -E '(error|warning):' | sed 's|^$PWD/||'"
fi

cat "$found"/* | sort -u >&2
[ -z "$(cat "$found"/*)" ]
