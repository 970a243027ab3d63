#!/bin/sh
# SPDX-License-Identifier: MIT
# The campaigns, one after the other, each in its long form; `./check` and `./check --all` run short forms. Takes hours, and
# needs build/release with all of its programs: `./check --long` builds it. Output goes to build/long/NAME.log. Ends with
# status 1 and the names of those that failed; a campaign whose tools are missing is skipped.
#   sh tests/long.sh [NAME...]
set -u
cd "$(dirname "$(readlink -f "$0")")/.." || exit 1
mkdir -p build/long
wanted=" $* "
failed=
skipped=

# campaign NAME TOOL COMMAND...: TOOL is a command without which it is skipped; status 77 skips it, too.
campaign() {
  name=$1 tool=$2
  shift 2
  case $wanted in *" $name "* | "  ") ;; *) return ;; esac
  echo "long: $name" >&2
  status=77
  command -v "$tool" >/dev/null && { "$@" >"build/long/$name.log" 2>&1; status=$?; }
  case $status in
    0) ;;
    77) skipped="$skipped $name" ;;
    *) failed="$failed $name" ;;
  esac
}

# smoke PRESET FOLDER SETTING...: builds the tests of core and its laws there, and runs their short forms.
smoke() {
  preset=$1 folder=$2
  shift 2
  cmake --preset "$preset" -B "build/$folder" "$@" &&
    ninja -C "build/$folder" palpate_complete unit_tests contract_tests &&
    ctest --test-dir "build/$folder" --output-on-failure -R '^everyday/(unit|contract)/'
}

# threads: eight threads of Python over one run, for a minute, under both sanitizers.
threads() {
  for preset in tsan asan; do
    cmake --preset $preset && cmake --build build/$preset --target palpate_complete &&
      PALPATE_SECONDS=60 ctest --test-dir build/$preset --output-on-failure -R eight_threads || return 1
  done
}

tests=build/release/tests
campaign stress sh sh tests/stress.sh
campaign fuzz clang++ sh tests/fuzz.sh
campaign accuracy sh sh tests/accuracy.sh build/release --long
campaign same_taps sh env PALPATE_LONG=1 $tests/system_tests --gtest_brief=1 --gtest_filter='Of/SameTaps.*'
campaign stability sh env PALPATE_LONG=1 $tests/stability_tests --gtest_brief=1
campaign robots $tests/baxter_tests sh tests/robot_campaign.sh
campaign chaos $tests/baxter_tests env PALPATE_CHAOS=1000:5000 $tests/baxter_tests --gtest_brief=1 --gtest_filter='Chaos.*'
campaign clang clang++ smoke debug clang -DCMAKE_CXX_COMPILER=clang++
campaign tsan sh smoke tsan tsan
campaign threads sh threads
[ ! -f tests/arm64.sh ] || campaign arm64 sh sh tests/arm64.sh
for suite in 12 13; do
  campaign "debian_$suite" mmdebstrap sh tests/in_debian.sh $suite ci
  campaign "pages_$suite" mmdebstrap sh tests/in_debian.sh $suite pages
  campaign "packages_$suite" mmdebstrap sh tests/packages.sh $suite
done
campaign benchmarks sh env PALPATE_LONG=1 $tests/system_tests --gtest_brief=1 --gtest_filter='Every/Pages.*'
[ -z "$skipped" ] || echo "long: skipped, because tools are missing:$skipped" >&2
[ -z "$failed" ] || { echo "long: failed, see build/long:$failed" >&2; exit 1; }
