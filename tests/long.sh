#!/bin/sh
# SPDX-License-Identifier: MIT
# The campaigns, one after the other, each in its long form; `./check` and `./check --all` run short forms. Takes hours, and
# needs build/release with all of its programs: `./check --long` builds it. Output goes to build/long/NAME.log. Ends with
# status 1 if a campaign failed or was skipped, and names these campaigns.
#   sh tests/long.sh [NAME...]
set -u
cd "$(dirname "$(readlink -f "$0")")/.." || exit 1
tests=build/release/tests
names="sanitizers stress fuzz accuracy coverage same_taps bundle lines stability robots chaos clang tsan threads arm64"
names="$names debian_12 pages_12 packages_12 debian_13 pages_13 packages_13 benchmarks"
for name in "$@"; do
  case " $names " in *" $name "*) continue ;; esac
  echo "long: there is no campaign '$name', the campaigns are $names" >&2
  exit 2
done

# needs TOOL...: status 77 and the reason if a command is missing. The tool `root` is a user who is root.
needs() {
  for tool in "$@"; do
    if [ "$tool" = root ]; then
      [ "$(id -u)" = 0 ] || { echo "needs root"; return 77; }
    else
      command -v "$tool" >/dev/null || { echo "$tool is missing"; return 77; }
    fi
  done
}

# gtest SUITE FILTER: tests of the release build in their long form.
gtest() { env PALPATE_LONG=1 "$tests/$1_tests" --gtest_brief=1 --gtest_filter="$2"; }

# smoke PRESET FOLDER SETTING...: builds the unit and contract tests there, and runs their short forms.
smoke() {
  preset=$1 folder=$2
  shift 2
  cmake --preset "$preset" -B "build/$folder" "$@" &&
    ninja -C "build/$folder" palpate_complete unit_tests contract_tests &&
    ctest --test-dir "build/$folder" --output-on-failure --no-tests=error -R '^everyday/(unit|contract)/'
}

# sanitizers: every test under the address and undefined-behaviour sanitizers.
sanitizers() {
  cmake --preset asan && cmake --build build/asan &&
    ctest --test-dir build/asan -j "$((3 * $(nproc)))" --output-on-failure --no-tests=error -LE '^everyday$' --repeat until-pass:2
}

# coverage: how often the intervals of `compare` hold, over sweeps that are drawn from 2880 recorded jobs.
coverage() {
  rm -rf build/long/coverage
  build/release/palpate sweep tests/benchmark/coverage/arm.yaml --runs build/long/coverage --quiet &&
    $tests/interval_coverage 1000 build/long/coverage/*/*/results.csv=rmse_m
}

# bundle: the paper's comparison from 1000 starts and its figures as a bundle, which is verified; 300 changes of a bundle
# are found.
bundle() {
  here=build/long/bundle
  rm -rf "$here" && mkdir -p "$here" &&
    for config in comparison figures; do build/release/palpate sweep "configs/paper/$config.yaml" --runs "$here/runs" --quiet || return; done &&
    build/release/palpate sweep configs/paper/comparison.yaml name=scales acquisition=weighted \
      kernel.length_scale=1.7cm,3cm,13cm --runs "$here/runs" --quiet &&
    build/release/palpate bundle "$here"/runs/*/* -o "$here/paper.palpate.tar.gz" \
      --result 'compare comparison --by acquisition --metric object_taps,rmse_m' \
      --result 'compare comparison --by acquisition --metric object_taps --where "first_hit_tap <= 3"' \
      --result 'curves comparison --by acquisition' \
      --result 'compare scales --by kernel.length_scale --metric rmse_height_m --where "first_hit_tap <= 3"' &&
    build/release/palpate verify "$here/paper.palpate.tar.gz" && gtest system 'Bundle.*'
}

# lines: taps from any side by a program and by ask and tell, against those of the simulator.
lines() {
  gtest system 'AnyLine.*' &&
    PALPATE_LONG=1 ctest --test-dir build/release --output-on-failure --no-tests=error -R who_tells_distances_in_the_scene
}

# threads: eight threads of Python over one run, for a minute, under both sanitizers.
threads() {
  [ -d build/release/python ] || { echo "the Python module is missing"; return 77; }
  for preset in tsan asan; do
    cmake --preset $preset && cmake --build build/$preset --target palpate_complete &&
      PALPATE_SECONDS=60 ctest --test-dir build/$preset --output-on-failure --no-tests=error -R eight_threads || return 1
  done
}

# campaign NAME: status 77 if something is missing, with the reason as the last line of its output.
campaign() {
  case $1 in
    sanitizers) sanitizers ;;
    stress) sh tests/stress.sh ;;
    fuzz) needs clang++ && sh tests/fuzz.sh ;;
    accuracy) sh tests/accuracy.sh build/release --long ;;
    coverage) coverage ;;
    same_taps) gtest system 'Of/SameTaps.*' ;;
    lines) lines ;;
    stability) gtest stability '*' ;;
    robots) needs $tests/baxter_tests && sh tests/robot_campaign.sh ;;
    chaos) needs $tests/baxter_tests && PALPATE_CHAOS=1000:5000 $tests/baxter_tests --gtest_brief=1 --gtest_filter='Chaos.*' ;;
    clang) needs clang++ && smoke debug clang -DCMAKE_CXX_COMPILER=clang++ ;;
    tsan) smoke tsan tsan ;;
    threads) threads ;;
    arm64) needs root && sh tests/arm64.sh ;;
    debian_*) needs root mmdebstrap && sh tests/in_debian.sh "${1#*_}" ci ;;
    pages_*) needs root mmdebstrap && sh tests/in_debian.sh "${1#*_}" pages ;;
    packages_*) needs root mmdebstrap && sh tests/packages.sh "${1#*_}" ;;
    benchmarks) gtest system 'Every/Pages.*' ;;
  esac
}

mkdir -p build/long
failed=
skipped=
[ $# -gt 0 ] || set -- $names
for name in "$@"; do
  echo "long: $name" >&2
  (campaign "$name") >"build/long/$name.log" 2>&1
  case $? in
    0) ;;
    77) skipped="$skipped
  $name: $(tail -n 1 "build/long/$name.log")" ;;
    *) failed="$failed $name" ;;
  esac
done
[ -z "$skipped" ] || echo "long: skipped:$skipped" >&2
[ -z "$failed" ] || echo "long: failed, see build/long:$failed" >&2
[ -z "$failed$skipped" ]
