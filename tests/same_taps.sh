#!/bin/sh
# SPDX-License-Identifier: MIT
# Compares the taps of this build with those of another build, cell by cell. Run it after a change that is meant to change
# no tap, with a build of the commit before it in a tree of its own: each program runs the configs of its own tree.
#   sh tests/same_taps.sh OTHER/build/release/palpate [--seeds N] [--here PROGRAM] [--renames FILE] [SWEEP...]
# N (200) is the number of seeds of the sweep `paper`; the others have a tenth or less. Ends with status 1 where taps
# differ, and names the first jobs, taps and columns.
#
# What was renamed stands in tests/same_taps.csv, or in FILE, a line for each name: what,other,here.
#   word,OLD,NEW     a whole word of a sweep, such as motion=paper: the other program is given OLD for NEW
#   key,OLD,NEW      a name within a word, such as height.outlier_probability, or min_object_height of a map in braces: the same
#   column,OLD,NEW   a column of taps.csv, or what stands before a dot of it; without OLD it is new, without NEW it is gone;
#                    a table without NEW keeps OLD
# A column without a partner fails.
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
usage() {
  echo "same_taps: takes OTHER/build/PRESET/palpate, then --seeds N, --here PROGRAM, --renames FILE and names of sweeps" >&2
  exit 2
}
[ -x "${1:-}" ] || usage
other=$(readlink -f "$1")
shift
here=$root/build/release/palpate
renames=$root/tests/same_taps.csv
seeds=200
wanted=
while [ $# -gt 0 ]; do
  case $1 in
    --seeds | --here | --renames)
      [ $# -ge 2 ] || usage
      case $1 in --seeds) seeds=$2 ;; --here) here=$(readlink -f "$2") ;; --renames) renames=$(readlink -f "$2") ;; esac
      shift
      ;;
    -*) usage ;;
    *) wanted="$wanted $1" ;;
  esac
  shift
done
if [ "$seeds" -lt 1 ] || [ ! -x "$here" ] || [ ! -r "$renames" ]; then usage; fi
# Sweeps are run by palpate-whole, which an older build may have left.
for program in "$here" "$other"; do
  [ ! -x "$program-whole" ] || [ "$("$program" --version)" = "$("$program-whole" --version)" ] ||
    { echo "same_taps: $program-whole is of another build than $program: build both" >&2; exit 2; }
done
# A program is BUILD/palpate in TREE/build.
here_tree=$(cd "$(dirname "$here")/../.." && pwd)
other_tree=$(cd "$(dirname "$other")/../.." && pwd)
for tree in "$here_tree" "$other_tree"; do
  [ -d "$tree/configs" ] || { echo "same_taps: $tree has no configs: the program is to lie in TREE/build/PRESET" >&2; exit 2; }
done
awk -F, 'NR > 1 && (NF != 3 || $1 !~ /^(word|key|column)$/ || ($1 != "column" && ($2 == "" || $3 == "")) || $2 $3 == "") {
  print FILENAME ":" NR ": is neither word,OLD,NEW nor key,OLD,NEW nor column,OLD,NEW" > "/dev/stderr"; bad = 1
} END { exit 2 * bad }' "$renames"

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
trap 'exit 130' INT TERM
export PALPATE_PLUGIN_PATH='' HOME="$scratch"

# of_other WORD: what the other program calls it.
of_other() {
  awk -F, -v word="$1" '
    $1 == "word" { words[$3] = $2 }
    $1 == "key" { keys[$3] = $2 }
    END {
      if (word in words) { print words[word]; exit }
      while (match(word, /[A-Za-z0-9_.]+/)) {
        name = substr(word, RSTART, RLENGTH)
        for (key in keys) {
          if (name == key || index(name, key ".") == 1) { name = keys[key] substr(name, length(key) + 1); break }
        }
        out = out substr(word, 1, RSTART - 1) name
        word = substr(word, RSTART + RLENGTH)
      }
      print out word
    }' "$renames"
}

# compared HERE OTHER: reads lines "JOB ID-HERE ID-OTHER", compares both taps.csv of each and prints the first that differ.
compared() {
  awk -F, -v here="$1" -v other="$2" '
    # The cells of a line of CSV, in which a quoted cell may hold commas and doubled quotes.
    function cells(line, out,    n, rest, cell, end) {
      n = 0
      rest = line ","
      while (rest != "") {
        if (substr(rest, 1, 1) == "\"") {
          cell = "\""
          rest = substr(rest, 2)
          while ((end = index(rest, "\"")) > 0) {
            cell = cell substr(rest, 1, end)
            rest = substr(rest, end + 1)
            if (substr(rest, 1, 1) != "\"") break
            cell = cell "\""
            rest = substr(rest, 2)
          }
          rest = substr(rest, 2)
        } else {
          end = index(rest, ",")
          cell = substr(rest, 1, end - 1)
          rest = substr(rest, end + 1)
        }
        out[++n] = cell
      }
      return n
    }
    # What a column of the other program is called here; empty: it is gone.
    function renamed(name,    old) {
      for (old in new_of) {
        if (name == old) return new_of[old] == "" || new_of[old] in at ? new_of[old] : name
        if (index(name, old ".") == 1) return new_of[old] == "" ? "" : new_of[old] substr(name, length(old) + 1)
      }
      return name
    }
    function is_new(name,    one) {
      if (name in new_of) return 1  # renamed here, where it has another meaning
      for (one in added) if (name == one || index(name, one ".") == 1) return 1
      return 0
    }
    function differs(job, text) {
      if (!(job in told)) { told[job] = 1; if (++different <= 5) print "  job " job ": " text }
    }
    FNR == NR {
      if ($1 != "column") next
      mapped = 1
      if ($2 == "") added[$3] = 1
      else new_of[$2] = $3
      next
    }
    {
      split($0, word, " ")
      job = word[1]
      ++jobs
      a = here "/" word[2] "/taps.csv"
      b = other "/" word[3] "/taps.csv"
      if ((getline line_a <a) <= 0) differs(job, "no taps.csv here")
      if ((getline line_b <b) <= 0) differs(job, "no taps.csv of the other program")
      if (line_a "|" line_b != heads) {  # the columns, once for all jobs that have the same
        heads = line_a "|" line_b
        same_columns = line_a == line_b && !mapped
        lost = ""
        split("", at)
        split("", partner)
        columns = cells(line_a, names_a)
        for (i = 1; i <= columns; ++i) at[names_a[i]] = i
        n = cells(line_b, names_b)
        for (i = 1; i <= n; ++i) {
          name = renamed(names_b[i])
          if (name in at) partner[at[name]] = i
          else if (name != "" && lost == "") lost = "column " names_b[i] " of the other program has no partner here"
        }
        for (i = 1; i <= columns; ++i) {
          if (!(i in partner) && !is_new(names_a[i]) && lost == "") lost = "column " names_a[i] " has no partner in the other program"
        }
      }
      if (lost != "") differs(job, lost)
      for (row = 1; !(job in told); ++row) {
        more_a = getline line_a <a
        more_b = getline line_b <b
        if (more_a <= 0 && more_b <= 0) break
        ++taps
        if (more_a <= 0 || more_b <= 0) differs(job, "tap " row " only " (more_a > 0 ? "here" : "of the other program"))
        else if (line_a != line_b || !same_columns) {
          n_a = cells(line_a, cells_a)
          n_b = cells(line_b, cells_b)
          for (i = 1; i <= columns; ++i) {
            if ((i in partner) && cells_a[i] "" != cells_b[partner[i]] "")
              differs(job, "tap " row ": " names_a[i] " is " cells_a[i] " here, " cells_b[partner[i]] " of the other program")
          }
        }
      }
      close(a)
      close(b)
    }
    END {
      if (different > 0) { print "taps.csv differs in " different " of " jobs " jobs, the first above"; exit 1 }
      if (jobs == 0 || taps == 0) { print "there are no taps to compare"; exit 1 }
      print "taps.csv of " jobs " jobs equal, " taps " taps"
    }' "$renames" -
}

# sweep NAME CONFIG WORD...: the same jobs by both programs, each by the config of its own tree and with its own plugins.
sweep() {
  name=$1
  case " $wanted " in "  " | *" $name "*) ;; *) return 0 ;; esac
  shift
  echo "same_taps: $name" >&2
  for which in here other; do
    program=$here
    tree=$here_tree
    if [ "$which" = other ]; then
      program=$other
      tree=$other_tree
      for word in "$@"; do
        shift
        set -- "$@" "$(of_other "$word")"
      done
    fi
    (cd "$tree" && exec "$program" sweep "$@" "name=$name" --quiet --runs "$scratch/$which") >"$scratch/said" 2>&1 || {
      cat "$scratch/said" >&2
      echo "$name: not all jobs of $program are done" >&2
      return 1
    }
    # A job by its number, not by its id: that hashes all options, some of which one of the two may not know.
    sed -n 's/.*"job": \([0-9]*\), "id": "\([0-9a-f]*\)".*/\1 \2/p' "$scratch/$which/$name"/*/manifest.jsonl |
      sort >"$scratch/$name.$which"
  done
  # A job of one program alone stays, without an id of the other.
  if join -a 1 -a 2 -e - -o 0,1.2,2.2 "$scratch/$name.here" "$scratch/$name.other" | sort -n |
    compared "$(echo "$scratch/here/$name"/*/jobs)" "$(echo "$scratch/other/$name"/*/jobs)" >"$scratch/said"; then
    echo "$name: $(cat "$scratch/said")"
  else
    echo "$name: $(tail -n 1 "$scratch/said")"
    sed '$d' "$scratch/said"
    return 1
  fi
  rm -rf "$scratch/here/$name" "$scratch/other/$name"
}

tenth="seed=range(0,$(((seeds + 9) / 10)))"
twentieth="seed=range(0,$(((seeds + 19) / 20)))"
fiftieth="seed=range(0,$(((seeds + 49) / 50)))"
objects=object_i,object_ii,dome,l,ring,cylinder,two_blocks,rod,cube,tall_cone,tilted_block,large_block
solids=any_bottle,any_bowl,any_bracket,any_jug,any_leaning,any_lidded_box,any_mug,any_two
# All that a simulated arm may do wrong, which no shipped set has together, and often: labels that flip when they are read
# again, contacts with what is not of the scene, objects that are pushed, places out of reach.
wrong='{force_noise: {}, force_drift: {}, stiffness: {object: 1500 N/m, arm: 4 kN/m}, joint_lag: {}, latency: {}, pose_noise: {}'
wrong="$wrong, height_offset: {constant: 8 mm, drift: 0.03 mm/s}, missed_contacts: {probability: 0.05}, tip_radius: {}"
wrong="$wrong, false_contacts: {probability: 0.05}, foreign_objects: {probability: 0.1}, push: {probability: 0.1}, reach: {}, shaft: {}}"
status=0
sweep paper configs/paper/object_i.yaml scene=object_i,object_i_right,object_ii \
  acquisition=uncertainty,weighted,random,grid "seed=range(0,$seeds)" || status=1
sweep default configs/default.yaml "scene=$objects" scene.placement=random "$tenth" || status=1
sweep standard configs/default.yaml "scene=$objects" scene.placement=random scene.effects=standard "$tenth" || status=1
sweep wrong configs/default.yaml scene=object_i,ring,two_blocks,cube scene.placement=random "scene.effects=$wrong" \
  "$tenth" || status=1
sweep motion_paper configs/default.yaml scene=object_i,l,tall_cone scene.placement=random motion=paper \
  scene.effects=standard "$tenth" || status=1
sweep strategies configs/default.yaml strategy=random,grid,uncertainty,weighted,weighted_two_part scene=object_ii,ring \
  scene.placement=random scene.effects=standard "$tenth" || status=1
sweep ceres configs/paper/object_i.yaml fitting=ceres acquisition=uncertainty,weighted scene=object_i,object_ii \
  "$twentieth" || status=1
sweep ceres_default configs/default.yaml fitting=ceres scene=object_i,dome scene.effects=standard "$twentieth" || status=1
sweep drawn configs/default.yaml scene=random_outline,clutter scene.placement=random belief.footprint=primitives,gp_classifier \
  "$twentieth" || status=1
sweep any_side configs/any_side.yaml "scene=$solids" taps=12 "$fiftieth" || status=1
sweep any_side_wrong configs/any_side.yaml scene=any_mug,any_lidded_box taps=12 \
  'scene.effects={force_noise: {}, stiffness: {}, joint_lag: {}, pose_noise: {}, false_contacts: {}, push: {after: 6}}' \
  "$fiftieth" || status=1
sweep any_side_view configs/any_side.yaml scene=any_mug taps=6 acquisition=discovery,uncertainty,random \
  'belief.view={elevation: 10 deg, rays: 100}' "$fiftieth" || status=1
exit "$status"
