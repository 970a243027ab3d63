#!/bin/sh
# SPDX-License-Identifier: MIT
# The long form of two tests with kill -9 at random moments, minutes long; ./check runs short ones. The stress test of
# sweeps: two launchers, and kills of them and of their jobs, half over simulated jobs, half over jobs on another program.
# And a tenth as many kills of one run on a robot's program, of which no tap may be asked for twice, and none lost.
#   sh tests/stress.sh [KILLS]      (1000)
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
kills=${1:-1000}

# A test and how many kills each of its cases makes.
run() {
  PALPATE_KILLS=$2 "$root/build/release/tests/system_tests" --gtest_filter="$1" \
    --gtest_output="xml:$root/build/release/stress.xml"
  sed -n 's/.*property name="\(kills\|begun\|programs\|contacts\|unknown\)" value="\([0-9]*\)".*/\1: \2/p' \
    "$root/build/release/stress.xml"
}
run 'Of/Stress.*' $((kills / 2))
run 'AKilledRun.*' $((kills / 10))
