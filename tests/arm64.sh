#!/bin/sh
# SPDX-License-Identifier: MIT
# Builds palpate for 64-bit ARM with a cross compiler and tests it under emulation: the files of Debian 12 for arm64 are
# unpacked by mmdebstrap, and programs run in qemu. Unit, contract and stability tests in their short forms
# (PALPATE_BRIEF), then runs that are compared with those of the release build, tap by tap, then packages. Needs root, mmdebstrap, g++-aarch64-linux-gnu, qemu-user-static,
# dpkg-dev and file, a network, 4 GB in the build folder, and an hour.
#   sh tests/arm64.sh [--seeds N] [build | test | compare | packages]...
# N seeds of paper and default are compared, 20 unless said. Without further words, all four.
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
folder=$root/build/arm64
system=$folder/system
build=$folder/build
seeds=20
cores=$(nproc)

refuse() {
  echo "arm64: $1" >&2
  exit 2
}

# What qemu does not do as the kernel does: it starts files that are no programs, keeps no limit of memory, and does not
# tell a parent that its child could not be started. On x86-64 the same tests fail under qemu-x86_64.
not_emulated=ProgramAcquisition.IsEndedWithAllThatItStarted:StartedProgram.ThatIsNotThereIsToldByErrno
not_emulated=$not_emulated:ProcessBackend.AFileThatIsNoProgramIsNotGivenToAShell:MeshFile.ThatTakesFarMoreMemoryThanItsSizeIsRefused

steps=
while [ $# -gt 0 ]; do
  case $1 in
    --seeds) [ $# -gt 1 ] || refuse "--seeds takes a number"; seeds=$2; shift ;;
    build | test | compare | packages) steps="$steps $1" ;;
    *) refuse "unknown argument '$1', it takes --seeds N, build, test, compare and packages" ;;
  esac
  shift
done
steps=${steps:-build test compare packages}
for tool in mmdebstrap aarch64-linux-gnu-g++ qemu-aarch64-static; do
  command -v "$tool" >/dev/null ||
    { echo "arm64: $tool is missing: apt install mmdebstrap g++-aarch64-linux-gnu qemu-user-static" >&2; exit 77; }
done
[ "$(id -u)" = 0 ] || refuse "only root can register an emulator"

# Programs for ARM that others start are handed to qemu by the kernel.
register() {
  [ -e /proc/sys/fs/binfmt_misc/register ] || mount -t binfmt_misc none /proc/sys/fs/binfmt_misc
  [ -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ] || printf '%s' ':qemu-aarch64:M::\x7fELF\x02\x01\x01\x00\x00\x00\x00\x00\x00\x00\x00\x00\x02\x00\xb7\x00:\xff\xff\xff\xff\xff\xff\xff\x00\xff\xff\xff\xff\xff\xff\xff\xff\xfe\xff\xff\xff:/usr/bin/qemu-aarch64-static:F' >/proc/sys/fs/binfmt_misc/register
}

unpack() {
  [ ! -e "$system/usr/include/hwy" ] || return 0
  rm -rf "$system"
  packages=$(sed -n '/^\[core\]/,/^\[ros\]/s/^\(lib[^ ]*-dev\|nlohmann-json3-dev\)  *#.*/\1/p' "$root/packages.txt" | tr '\n' ',')
  mmdebstrap --quiet --arch=arm64 --variant=extract --include="base-files,libc6-dev,libstdc++-12-dev,libblas-dev,liblapack-dev,$packages" bookworm "$system" http://deb.debian.org/debian
  # No package was configured, so that the links of alternatives are not there, and Ceres names its libraries by whole paths.
  for name in blas lapack; do
    for end in so so.3; do ln -sf "$name/lib$name.$end" "$system/usr/lib/aarch64-linux-gnu/lib$name.$end"; done
  done
  sed -i "s|\([;\"]\)\(/usr/lib/aarch64-linux-gnu/\)|\1$system\2|g" "$system/usr/lib/aarch64-linux-gnu/cmake/Ceres/CeresTargets.cmake"
}

configure() {
  cat >"$folder/toolchain.cmake" <<toolchain
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_SYSROOT $system)
set(CMAKE_FIND_ROOT_PATH $system)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static)
toolchain
  cmake -G Ninja -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_TOOLCHAIN_FILE="$folder/toolchain.cmake" >"$folder/cmake.log"
}

# runs PROGRAM FOLDER: the taps of paper and default, two strategies with many seeds each.
runs() {
  rm -rf "$2"
  for config in paper/object_i default; do
    "$1" sweep "$root/configs/$config.yaml" "seed=range(1,$((seeds + 1)))" $([ $config = paper/object_i ] || echo scene.effects=standard) \
      --runs "$2" --quiet >/dev/null
  done
}

# compare FOLDER OTHER: runs whose taps go to the same places, of all.
compare() {
  python3 - "$1" "$2" <<'python'
import csv, pathlib, sys

def places(folder):
    return {file.parent.name: [(row["x"], row["y"], row["outcome"]) for row in csv.DictReader(file.open())]
            for file in pathlib.Path(folder).glob("**/jobs/*/taps.csv")}

one, other = places(sys.argv[1]), places(sys.argv[2])
differ = sorted(job for job in one if one[job] != other.get(job))
print(f"{len(one) - len(differ)} of {len(one)} runs make the same taps on both machines")
for job in differ:
    print("differs:", job)
sys.exit(1 if differ or not one or one.keys() != other.keys() else 0)
python
}

# packages: makes the packages, and checks their architecture and that palpate depends on libfmt.
packages() {
  rm -rf "$folder/packages"
  (cd "$build" && cpack -B "$folder/packages" >"$folder/cpack.log")
  for deb in "$folder"/packages/*.deb; do
    [ "$(dpkg-deb -f "$deb" Architecture)" = arm64 ] || { echo "arm64: $deb is not for arm64" >&2; exit 1; }
  done
  dpkg-deb -f "$folder"/packages/palpate_*.deb Depends | grep 'libfmt9 (>=' ||
    { echo "arm64: palpate does not depend on libfmt9" >&2; exit 1; }
}

mkdir -p "$folder"
export QEMU_LD_PREFIX="$system" PKG_CONFIG_SYSROOT_DIR="$system"
export PKG_CONFIG_LIBDIR="$system/usr/lib/aarch64-linux-gnu/pkgconfig:$system/usr/share/pkgconfig"
register
unpack
[ -e "$build/build.ninja" ] || configure
for step in $steps; do
  case $step in
    build) ninja -C "$build" palpate_complete unit_tests contract_tests stability_tests ;;
    test)
      # A test strips a library, which this machine's own program cannot do for ARM.
      mkdir -p "$folder/bin"
      ln -sf "$(command -v aarch64-linux-gnu-strip)" "$folder/bin/strip"
      for suite in unit contract stability; do
        echo "arm64: $suite tests" >&2
        # One part per core.
        (cd "$build/tests" && seq 0 $((cores - 1)) | PATH="$folder/bin:$PATH" xargs -P "$cores" -I PART \
          env PALPATE_BRIEF=1 GTEST_TOTAL_SHARDS="$cores" GTEST_SHARD_INDEX=PART "./${suite}_tests" --gtest_brief=1 --gtest_filter="-$not_emulated")
      done
      ;;
    compare)
      [ -x "$root/build/release/palpate-whole" ] || refuse "the release build is missing: cmake --preset release && cmake --build --preset release"
      runs "$root/build/release/palpate-whole" "$folder/x86"
      runs "$build/palpate-whole" "$folder/arm"
      compare "$folder/x86" "$folder/arm"
      ;;
    packages) packages ;;
  esac
done
