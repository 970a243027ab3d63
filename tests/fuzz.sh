#!/bin/sh
# SPDX-License-Identifier: MIT
# A campaign of libFuzzer at every door by which bytes of others come in (fuzz/harness.hpp), two doors at a time: so many
# inputs in all, most of them at the doors that are quick to answer. Ends with status 1 at a crash, an exception that is
# no Error, an input that takes more than 2 s or 1 GiB; the input is then in build/fuzz/found, and once it is mended
# belongs into fuzz/corpus, which ./check goes through. Needs clang and its runtime libraries.
#   sh tests/fuzz.sh [INPUTS]      (10000000)
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
inputs=${1:-10000000}
build=$root/build/fuzz
cmake --preset fuzz -S "$root" >/dev/null
ninja -C "$build" --quiet $(ninja -C "$build" -t targets all | sed -n 's/^\(fuzz_[a-z]*\): phony/\1/p' | grep -v fuzz_tests)
mkdir -p "$build/found" "$build/logs"

# A door, its share of the inputs in thousandths, and their greatest length.
fuzz() {
  mkdir -p "$build/corpus/$1"
  [ -x "$build/tests/fuzz_$1" ] || return 0
  if "$build/tests/fuzz_$1" -runs=$((inputs / 1000 * $2)) -timeout=2 -rss_limit_mb=1024 -max_len="$3" -print_final_stats=1 \
      -artifact_prefix="$build/found/$1-" "$build/corpus/$1" "$root/tests/fuzz/corpus/$1" >"$build/logs/$1" 2>&1; then
    echo "$1: $(sed -n 's/.*number_of_executed_units: *//p' "$build/logs/$1") inputs, nothing found," \
      "$(sed -n 's/.*peak_rss_mb: *//p' "$build/logs/$1") MB at most"
  else
    echo "$1: $(grep -m 1 -E 'ERROR|SUMMARY|terminate|runtime error' "$build/logs/$1"), see build/fuzz/logs/$1"
    return 1
  fi
}

first() { fuzz answer 400 2000 && fuzz scores 100 300 && fuzz record 15 4000 && fuzz mesh 1 4000; }
second() { fuzz words 300 300 && fuzz heights 100 4000 && fuzz xmlrpc 50 4000 && fuzz table 20 2000 && fuzz plan 10 4000 && fuzz bundle 20 4000 && fuzz config 4 4000; }
first &
second
wait $!
