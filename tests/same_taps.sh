#!/bin/sh
# SPDX-License-Identifier: MIT
# Whether this build taps as another one does, to the last byte: taps.csv of the paper's three scenes by four
# acquisitions by so many seeds, and of configs/default.yaml over the benchmark's twelve objects by a tenth of them.
# Run it when a change is meant to change no tap, with a build of the commit before it in a folder of its own. Ends with
# status 1 and the first jobs that differ.
#   sh tests/same_taps.sh OTHER/build/release/palpate [SEEDS]      (200)
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
other=$(readlink -f "$1")
seeds=${2:-200}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# sweep NAME WORD...: the same jobs by both programs, each with its own plugins, and their taps compared.
sweep() {
  name=$1
  shift
  for which in here other; do
    program=$root/build/release/palpate
    [ "$which" = here ] || program=$other
    "$program" sweep "$@" "name=$name" log.surface=false --quiet --runs "$scratch/$which" >/dev/null
    # A job's place in the sweep, not its id: that hashes all options, some of which one of the two may not know.
    (cd "$scratch/$which/$name"/*/jobs && sed -n 's/.*"job": \([0-9]*\), "id": "\([0-9a-f]*\)".*/\1 \2/p' ../manifest.jsonl |
      while read -r job id; do echo "$job $(md5sum <"$id/taps.csv")"; done) >"$scratch/$name.$which"
  done
  if diff "$scratch/$name.here" "$scratch/$name.other" >"$scratch/difference"; then
    echo "$name: taps.csv of $(wc -l <"$scratch/$name.here") jobs equal"
  else
    echo "$name: taps.csv differs in $(grep -c '^<' "$scratch/difference") of $(wc -l <"$scratch/$name.here") jobs:"
    head -n 5 "$scratch/difference"
    return 1
  fi
}

objects=object_i,object_ii,dome,l,ring,cylinder,two_blocks,rod,cube,tall_cone,tilted_block,large_block
status=0
sweep paper "$root/configs/paper/object_i.yaml" scene=object_i,object_i_right,object_ii \
  acquisition=uncertainty,weighted,random,grid "seed=range(0,$seeds)" || status=1
sweep default "$root/configs/default.yaml" "scene=$objects" scene.placement=random \
  "seed=range(0,$(((seeds + 9) / 10)))" || status=1
exit "$status"
