#!/bin/sh
# SPDX-License-Identifier: MIT
# The long form of the tests with kill -9 at random moments, minutes long; ./check runs short ones. The stress test of
# sweeps: two launchers, and kills of them and of their jobs, half over simulated jobs, half over jobs on another program.
# Runs and sweeps, of each three in twenty of that number and each killed twice, of which every file must be that of the
# unbroken one.
# And a tenth as many kills of one run on a robot's program, and of one on the robot of ROS nodes where that is built: of
# neither may a tap be asked for twice, and none lost.
#   sh tests/stress.sh [KILLS]      (1000)
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
kills=${1:-1000}

# A label, a test and how many kills each of its cases makes.
run() {
  PALPATE_KILLS=$3 "$root/build/release/tests/$1_tests" --gtest_filter="$2" \
    --gtest_output="xml:$root/build/release/stress.xml"
  sed -n 's/.*property name="\(kills\|begun\|programs\|contacts\|unknown\|descents\)" value="\([0-9]*\)".*/\1: \2/p' \
    "$root/build/release/stress.xml"
}
run system 'Of/Stress.*' $((kills / 2))
run system 'AtRandomMoments/Kill*' $((kills * 3 / 20))
run system 'AKilledRun.*' $((kills / 10))
[ ! -x "$root/build/release/tests/baxter_tests" ] || run baxter 'RobotRun.KilledAgainAndAgain*' $((kills / 10))
