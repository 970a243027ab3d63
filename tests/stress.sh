#!/bin/sh
# SPDX-License-Identifier: MIT
# The long form of the stress test of sweeps: two launchers, and kill -9 at random moments on them and on their jobs,
# half of the kills over simulated jobs, half over jobs on another program. Takes a few minutes; ./check runs a short one.
#   sh tests/stress.sh [KILLS]      (1000)
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
kills=${1:-1000}
PALPATE_KILLS=$((kills / 2)) "$root/build/release/tests/system_tests" --gtest_filter='Of/Stress.*' \
  --gtest_output="xml:$root/build/release/stress.xml"
sed -n 's/.*property name="\(kills\|begun\)" value="\([0-9]*\)".*/\1: \2/p' "$root/build/release/stress.xml"
