#!/bin/sh
# SPDX-License-Identifier: MIT
# The long form of the campaign on the arms of the tests' robot: so many taps on each, under spikes, friction and stalls,
# on soft and on hard things, and thirty in a row on each of those; then on a robot with Rethink's springs whose messages
# are late, whose force is filtered and whose zero changes with the pose. Prints a line for every condition and fails where the
# driver breaks what it promises. Takes a few minutes, with MuJoCo (libmujoco-dev) half an hour; ./check runs a short one.
#   sh tests/robot_campaign.sh [TAPS]      (500)
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
PALPATE_CAMPAIGN=${1:-500} "$root/build/release/tests/baxter_tests" --gtest_filter='OnTheArm/Campaign.*:ForceBound.*'
