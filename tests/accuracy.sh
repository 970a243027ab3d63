#!/bin/sh
# SPDX-License-Identifier: MIT
# Holds the accuracy of the default and of `weighted` to tests/benchmark/accuracy.csv: RMSE and IoU after fixed numbers of
# taps, means over fixed seeds. A value fails that is worse by more than three standard errors of the difference.
#   sh tests/accuracy.sh BUILD [SWEEP...]            the short form, 100 s on two cores; ./check --all runs it
#   sh tests/accuracy.sh BUILD --long [SWEEP...]     five times as many seeds: differences of half the size show
#   sh tests/accuracy.sh BUILD [--long] --write [--reason TEXT] [SWEEP...]
#                                                    records the new values; worse values, other seeds or jobs and rows
#                                                    that no job makes only with a reason, which is written beside them
#   --set KEY=VALUE   an override of every sweep: is this setting worse?      --seeds N   the first N seeds alone
# BUILD is the directory of a build that has the program and all plugins.
#
# A recorded row that no job of its sweep makes fails, and so do a job without a row, another number of seeds and another
# number of jobs per seed (the objects that the mean of a seed is taken over). A row that was given up keeps its line,
# with 0 seeds and the reason.
#
# The standard error. Values of the same code are equal, bit by bit. A change that moves one tap gives a run other
# taps from there on: it ends better or worse by chance, although object, placement and noise are the same. So the new
# value is compared with the old value seed by seed (of a seed: the mean over all its objects), and the standard error
# is that of the mean of these differences: their standard deviation over the square root of the number of seeds. The
# column standard_error is that of the value itself; it also has what seeds share, such as a placement that is hard
# for every code. With another random stream for the footprint, which is neither better nor worse, the standard error
# of the difference is 1.5 to 2.4 % of the RMSE and 0.5 to 2.7 % of the IoU of the default, from any side 6 and 4 %,
# and no value fails. A loss of 7 % (any side: 19 %) shows in the short form, of 3 % (8 %) in the long form. A neutral
# change fails one value with a probability of 0.6 % with 12 seeds, the fewest, and of 0.3 % with 30 (Student's t). A
# difference below 0.5 % of the value never fails: where most runs are equal, the standard error of so few differences
# says little.
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
table=$root/tests/benchmark/accuracy.csv
usage() {
  echo "accuracy: takes the directory of a build, then --long, --write, --reason TEXT, --set KEY=VALUE, --seeds N and of" \
    "the sweeps $sweeps" >&2
  exit 2
}
sweeps="objects standard clutter any_side"
[ -x "${1:-}/palpate" ] || usage
program=$(cd "$1" && pwd)/palpate
shift
[ ! -x "$program-whole" ] || [ "$("$program" --version)" = "$("$program-whole" --version)" ] ||
  { echo "accuracy: $program-whole, which runs sweeps, is of another build than $program: build both" >&2; exit 2; }
form=short
mode=check
reason=
wanted=
most=0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
: >"$work/set"
while [ $# -gt 0 ]; do
  case $1 in
    --long) form=long ;;
    --write) mode='write' ;;
    --reason | --set | --seeds)
      [ $# -ge 2 ] || usage
      case $1 in --reason) reason=$2 ;; --set) echo "$2" >>"$work/set" ;; --seeds) most=$2; case $2 in "" | *[!0-9]* | 0 | 1) echo "accuracy: --seeds takes a number from 2 on: the error of a mean needs two" >&2; exit 2 ;; esac ;; esac
      shift
      ;;
    *) case " $sweeps " in *" $1 "*) wanted="$wanted $1" ;; *) usage ;; esac ;;
  esac
  shift
done
case $reason in *'"'* | *'
'*) echo "accuracy: a reason is one line without double quotes" >&2; exit 2 ;; esac
if [ "$mode" = write ] && { [ -s "$work/set" ] || [ "$most" -gt 0 ]; }; then
  echo "accuracy: --write records what the configs say, of all seeds: leave out --set and --seeds" >&2
  exit 2
fi
seeds_file=$root/tests/benchmark/accuracy/$form.csv
export PALPATE_PLUGIN_PATH='' HOME="$work"

# run SWEEP: runs its jobs, and prints lines "ROW,SEED,JOBS,RMSE,IOU", means over the JOBS objects of a seed. The seeds are those of
# no benchmark: whoever tunes by this table leaves them unused.
run() {
  case $1 in
    objects | standard) short=30 ;;
    clutter) short=80 ;;
    any_side) short=12 ;;
  esac
  count=$short
  [ "$form" = short ] || count=$((5 * short))
  [ "$most" -eq 0 ] || [ "$most" -ge "$count" ] || count=$most
  name=$1
  iou=footprint_iou error=rmse_m
  case $name in
    objects) set -- strategies.yaml motion=per_tap scene.effects=none strategy=default,weighted taps=17,30 ;;
    standard) set -- strategies.yaml motion=per_tap scene.effects=standard strategy=default,weighted taps=30 ;;
    clutter) set -- clutter.yaml strategy=default,weighted taps=60 ;;
    any_side) set -- any_side.yaml acquisition=discovery taps=19; iou=volume_iou error=rms_surface_distance_m ;;
  esac
  config=$root/configs/benchmark/$1
  shift
  while read -r word; do set -- "$@" "$word"; done <"$work/set"
  # Each takes up to two minutes in the short form; whoever waits sees which.
  echo "accuracy: $name, seeds 60000 to $((59999 + count))" >&2
  (cd "$root" && exec "$program" sweep "$config" "$@" "seed=range(60000,$((60000 + count)))" "name=$name" \
    log.surface=false --quiet --runs "$work/runs") >"$work/said" 2>&1 || {
    cat "$work/said" >&2
    echo "accuracy: not all jobs of $name are done" >&2
    return 1
  }
  awk -F, -v name="$name" -v iou="$iou" -v error="$error" '
    NR == 1 { for (i = NF; i >= 1; --i) at[$i] = i; next }
    {
      row = name "_" $at["taps"] "_" ("strategy" in at ? $at["strategy"] : $at["acquisition"])
      key = row "," $at["seed"]
      if (!(key in jobs)) keys[++n] = key
      ++jobs[key]
      # What is missing, or not a number, stays so.
      if ($at[error] !~ /^[0-9.]+(e[-+]?[0-9]+)?$/) bad[key] = 1
      if ($at[iou] !~ /^[0-9.]+(e[-+]?[0-9]+)?$/) bad[key] = 1
      rmse[key] += $at[error]
      share[key] += $at[iou]
    }
    END {
      for (i = 1; i <= n; ++i) {
        key = keys[i]
        if (key in bad) { print "accuracy: a run of " key " has no RMSE or IoU" >"/dev/stderr"; exit 1 }
        printf "%s,%d,%.12g,%.12g\n", key, jobs[key], rmse[key] / jobs[key], share[key] / jobs[key]
      }
    }' "$work/runs/$name"/*/results.csv
  rm -rf "$work/runs"
}

if [ "$mode" = write ]; then
  mkdir -p "${seeds_file%/*}"
  [ -e "$table" ] || echo "form,row,metric,seeds,value,standard_error,reason" >"$table"
  [ -e "$seeds_file" ] || echo "row,seed,jobs,rmse_m,iou" >"$seeds_file"
elif [ ! -e "$table" ] || [ ! -e "$seeds_file" ]; then
  echo "accuracy: nothing is recorded in $seeds_file: record the $form form by --write" >&2
  exit 1
fi
[ -n "$wanted" ] || wanted=$sweeps
for sweep in $sweeps; do
  case " $wanted " in *" $sweep "*) run "$sweep" >>"$work/new" ;; esac
done

# Compares seed by seed; with --write, writes table and seeds into $work.
judged=0
awk -F, -v form="$form" -v mode="$mode" -v reason="$reason" -v work="$work" -v part="$most" \
  -v wanted=" $wanted " '
  function shown(metric, value) { return metric == "rmse_m" ? sprintf("%.2f mm", 1000 * value) : sprintf("%.3f", value) }
  function mean_of(row, metric, values,    i, sum) {
    sum = 0
    for (i = 1; i <= count[row]; ++i) sum += values[row, metric, seed_of[row, i]]
    return sum / count[row]
  }
  # Standard error of the mean over the seeds of values, less those of another table where `less` says so.
  function error_of(row, metric, mean, less,    i, sum, value) {
    sum = 0
    for (i = 1; i <= count[row]; ++i) {
      value = now[row, metric, seed_of[row, i]] - (less ? before[row, metric, seed_of[row, i]] : 0) - mean
      sum += value * value
    }
    return sqrt(sum / (count[row] - 1) / count[row])
  }
  FILENAME ~ /accuracy\.csv$/ {
    if (FNR == 1) next
    key = $1 "," $2 "," $3
    lines[++kept] = key
    line[key] = $0
    if ($4 == 0) next  # was given up
    if ($1 == form) known[$2]
    seeds[key] = $4
    value[key] = $5
    text = $0
    sub(/^[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,[^,]*,/, "", text)
    why[key] = text
    next
  }
  FILENAME != work "/new" {
    if (FNR == 1) next
    old_row[++old_rows] = $1
    old_line[old_rows] = $0
    known[$1]
    jobs_before[$1, $2] = $3
    before[$1, "rmse_m", $2] = $4
    before[$1, "iou", $2] = $5
    ++recorded[$1]
    next
  }
  {
    if (!($1 in count)) rows[++n] = $1
    seed_of[$1, ++count[$1]] = $2
    jobs_now[$1, $2] = $3
    now[$1, "rmse_m", $2] = $4
    now[$1, "iou", $2] = $5
    new_line[++new_lines] = $0
  }
  # What of seeds and jobs differs from the record: "" if nothing does.
  function other_runs(row,    j, seed) {
    for (j = 1; j <= count[row]; ++j) {
      seed = seed_of[row, j]
      if (!((row, seed) in jobs_before)) return "seed " seed " is not recorded"
      if (jobs_before[row, seed] != jobs_now[row, seed]) return jobs_before[row, seed] " -> " jobs_now[row, seed] " jobs of seed " seed
    }
    return part == 0 && recorded[row] != count[row] ? recorded[row] " -> " count[row] " seeds" : ""
  }
  END {
    for (row in known) {
      sweep = row
      sub(/_[0-9]+_.*$/, "", sweep)
      if (row in count || !index(wanted, " " sweep " ")) continue
      if (mode == "check" || reason == "") {
        print "accuracy: " form "," row " is recorded, and no job makes it: give it up by --write --reason TEXT" >"/dev/stderr"
        failed = 1
        continue
      }
      given_up[row]
      for (m = 1; m <= 2; ++m) {
        key = form "," row "," (m == 1 ? "rmse_m" : "iou")
        if (!(key in line)) lines[++kept] = key
        line[key] = key ",0,,,\"" reason "\""
      }
      printf "%-24s given up\n", row
    }
    for (i = 1; i <= n; ++i) {
      row = rows[i]
      others = other_runs(row)
      for (m = 1; m <= 2; ++m) {
        metric = m == 1 ? "rmse_m" : "iou"
        sign = m == 1 ? 1 : -1
        key = form "," row "," metric
        new = mean_of(row, metric, now)
        error = error_of(row, metric, new, 0)
        stated = ""
        verdict = "new"
        differs = others
        if (differs == "") {
          old = mean_of(row, metric, before)
          if (part == 0 && (seeds[key] != count[row] || old - value[key] > 1e-9 || value[key] - old > 1e-9))
            differs = "not the mean of its seeds in accuracy/" form ".csv"
        }
        compared = key in value && differs == ""
        if (!compared && (mode == "check" || key in value && reason == "")) {
          print "accuracy: " key ": " (key in value ? differs : "not recorded") ": record it by --write" \
            (key in value ? " --reason TEXT" : "") >"/dev/stderr"
          failed = 1
          continue
        }
        if (!compared && key in value) stated = "\"" reason "\""
        if (compared) {
          worse = sign * (new - old)
          paired = error_of(row, metric, new - old, 1)
          limit = 3 * paired
          if (limit < 0.005 * old) limit = 0.005 * old
          verdict = worse > 1e-7 * old ? "worse" : worse < -1e-7 * old ? "better" : "equal"
          if (mode == "check" && worse > limit) {
            verdict = "FAILED"
            failed = 1
            printf "accuracy: %s %s: %s -> %s, worse by %s, three standard errors of the difference being %s (%d seeds)\n",
              row, metric, shown(metric, old), shown(metric, new), shown(metric, worse), shown(metric, 3 * paired), count[row] >"/dev/stderr"
          }
          if (mode == "write" && verdict == "worse" && reason == "") {
            failed = 1
            printf "accuracy: %s %s: %s -> %s is worse: give the reason by --reason TEXT\n", row, metric, shown(metric, old),
              shown(metric, new) >"/dev/stderr"
          }
          stated = verdict == "worse" ? "\"" reason "\"" : verdict == "equal" ? why[key] : ""
        }
        if (compared) {
          printf "%-24s %-6s %9s -> %9s  %-6s  standard error of the difference %s, of the value %s\n", row, metric,
            shown(metric, old), shown(metric, new), verdict, shown(metric, paired), shown(metric, error)
        } else {
          printf "%-24s %-6s %9s  new, standard error %s\n", row, metric, shown(metric, new), shown(metric, error)
        }
        if (verdict == "equal") continue
        if (!(key in line)) lines[++kept] = key
        line[key] = sprintf("%s,%d,%.10g,%.3g,%s", key, count[row], new, error, stated)
      }
    }
    if (mode == "write" && !failed) {
      print "form,row,metric,seeds,value,standard_error,reason" >(work "/table")
      for (i = 1; i <= kept; ++i) print line[lines[i]] >(work "/table")
      print "row,seed,jobs,rmse_m,iou" >(work "/seeds")
      for (i = 1; i <= old_rows; ++i) if (!(old_row[i] in count) && !(old_row[i] in given_up)) print old_line[i] >(work "/seeds")
      for (i = 1; i <= new_lines; ++i) print new_line[i] >(work "/seeds")
    }
    exit failed
  }' "$table" "$seeds_file" "$work/new" || judged=1
if [ "$mode" = write ] && [ "$judged" = 0 ]; then
  cp "$work/table" "$table"
  cp "$work/seeds" "$seeds_file"
fi
exit "$judged"
