#!/bin/sh
# SPDX-License-Identifier: MIT
# The packages for Debian. Of a build, as ./check --all has it: they are made, lintian finds no error, they hold what they
# should, and where they are unpacked they run the paper's experiment as the build does, build the plugin of
# plugins/README.md and load the run in Python.
#   sh tests/packages.sh build/release
# Of a Debian, 12 or 13, as root: they are made, on another Debian than this one in a bare root, of HEAD; in a second bare
# root they are installed one by one, and a user who is not root does the same three things with them. Needs mmdebstrap, a
# network, 5 GB in $TMPDIR, and on another Debian half an hour. With a folder behind it the packages are left there.
#   sh tests/packages.sh 12|13 [FOLDER]
# Ends with status 77 where something is missing that it cannot do without.
set -eu
umask 022
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

fail() {
  echo "packages: $1" >&2
  exit 1
}
needs() {
  for tool in "$@"; do
    command -v "$tool" >/dev/null && continue
    echo "packages: skipped: $tool is missing (packages.txt)" >&2
    exit 77
  done
}

# What the READMEs show, so that it is they who are tested; with packages nothing is installed by hand below a prefix.
# shellcheck disable=SC2016 # backquotes of the READMEs
capture=$(sed -n '/^ tap  source/,/^```/{/^```/d;p}' "$root/README.md")
# shellcheck disable=SC2016
tutorial=$(sed -n '/bin\/palpate new kernel/,/^```/{/^```/d;s/ -DCMAKE_PREFIX_PATH=[^ ]*//;s|^~/opt/palpate/bin/||;p}' "$root/plugins/README.md")
{ [ -n "$capture" ] && [ -n "$tutorial" ]; } || fail "the READMEs show no commands"
share=$work/share
mkdir "$share" "$share/debs"
echo "$capture" >"$share/capture"
cp "$root/tests/shown.awk" "$share"
cat >"$share/run" <<END
set -eux
palpate --version
palpate run configs/default.yaml >printed
awk -f $share/shown.awk $share/capture printed
palpate run configs/paper/object_i.yaml --quiet
grep -q 'EIGEN_MAX_ALIGN_BYTES=16;' runs/object_i/*/record.jsonl # no instructions but those of every amd64
END
cat >"$share/plugin" <<END
set -eux
$tutorial
END
cat >"$share/python" <<END
import glob, palpate
(directory,) = glob.glob("runs/object_i/*")
there = palpate.load(directory)
here = palpate.run("configs/paper/object_i.yaml", name="python")
assert len(there.taps) == 17 and (there.taps["height"] == here.taps["height"]).all()
assert there.summary["rmse_m"] == here.summary["rmse_m"] and there.manifest["build"] == here.manifest["build"]
END

# pack BUILD: the packages of a build.
pack() { (cd "$1" && cpack -B "$share/debs" >"$work/cpack.log" 2>&1) || { cat "$work/cpack.log" >&2; fail "cpack failed"; }; }

# check_files: what lintian says, and what is in them.
check_files() {
  rm -rf "$share/debs/_CPack_Packages"
  lintian --allow-root --fail-on error "$share"/debs/*.deb >&2 || fail "lintian finds errors"
  for line in 'palpate ./usr/bin/palpate' 'palpate ./usr/lib/palpate/kernel/rbf.so' 'palpate ./usr/lib/palpate/build.json' \
    'palpate ./usr/lib/palpate/python/palpate_acquisition.py' 'palpate ./usr/share/palpate/plugins/starters/python/starter.py' \
    'palpate ./usr/share/palpate/configs/paper/object_i.yaml' 'palpate ./usr/share/man/man1/palpate-run.1.gz' \
    'palpate ./usr/share/zsh/vendor-completions/_palpate' 'palpate ./usr/share/doc/palpate/copyright' \
    'palpate-dev ./usr/include/palpate/plugin.hpp' 'palpate-dev ./usr/lib/cmake/palpate/palpateConfig.cmake' \
    'palpate-baxter ./usr/lib/palpate/backend/baxter.so' \
    'python3-palpate ./usr/lib/python3/dist-packages/palpate/__init__.py'; do
    for deb in "$share/debs/${line%% *}"_*.deb; do
      if [ ! -f "$deb" ]; then
        case $line in palpate-baxter* | python3-*) continue 2 ;; esac # not built here
        fail "there is no package ${line%% *}"
      fi
      dpkg-deb --contents "$deb" >"$work/contents"
      grep -qF " ${line#* }" "$work/contents" || fail "$line: not there"
    done
  done
  for deb in "$share"/debs/*.deb; do
    strange=$(dpkg-deb --contents "$deb" | grep -vE '^(-rw-r--r--|-rwxr-xr-x|drwxr-xr-x|lrwxrwxrwx) root/root .* \./(usr/.*)?$' || true)
    [ -z "$strange" ] || fail "$deb: $strange"
  done
  # The driver's libraries are for those alone who have a Baxter.
  ! dpkg-deb -f "$share"/debs/palpate_*.deb Depends | grep ros || fail "palpate depends on ROS"
}

version_id=$(sed -n 's/^VERSION_ID="*\([0-9]*\).*/\1/p' /etc/os-release 2>/dev/null || true)
needs cpack lintian dpkg-deb dpkg-shlibdeps file

if [ -f "${1:-}/CPackConfig.cmake" ] && [ $# = 1 ]; then
  build=$(cd "$1" && pwd)
  # Where a tool is missing it says which, and makes nothing.
  mkdir "$work/tools"
  ln -s /usr/bin/* "$work/tools"
  for tool in file dpkg-shlibdeps; do
    rm "$work/tools/$tool"
    if (cd "$build" && PATH=$work/tools "$(command -v cpack)" -B "$work/none") >"$work/cpack.log" 2>&1; then
      fail "cpack makes packages without $tool"
    fi
    grep -q "cpack needs $tool: apt-get install " "$work/cpack.log" || fail "cpack does not say that it needs $tool"
    ln -s "/usr/bin/$tool" "$work/tools/$tool"
  done
  pack "$build"
  check_files
  for deb in "$share"/debs/*.deb; do dpkg -x "$deb" "$work/there"; done
  mkdir "$work/stranger" "$work/own"
  cd "$work/stranger"
  export PATH="$work/there/usr/bin:$PATH" CMAKE_PREFIX_PATH="$work/there/usr" PYTHONPATH="$work/there/usr/lib/python3/dist-packages"
  unset PALPATE_PLUGIN_PATH
  sh "$share/run" >&2
  (cd "$work/own" && "$build/palpate-whole" run "$root/configs/paper/object_i.yaml" --quiet)
  cmp runs/object_i/*/taps.csv "$work"/own/runs/object_i/*/taps.csv
  # Without their symbols they are still the same build.
  "$build/palpate-whole" run "$root/configs/paper/object_i.yaml" | grep -q '^already done' || fail "they are another build"
  sh "$share/plugin" >&2
  [ ! -d "$work/there/usr/lib/python3" ] || /usr/bin/python3 -B "$share/python"
  echo "packages: all is well" >&2
  exit 0
fi

case ${1:-} in
  12) suite=bookworm ;;
  13) suite=trixie ;;
  *)
    echo "packages: say which: the folder of a build, or 12 or 13 for a Debian" >&2
    exit 2
    ;;
esac
[ "$(id -u)" = 0 ] || { echo "packages: only root can make a root of another system" >&2; exit 2; }
needs mmdebstrap
# bare HOOK...: a bare root of that Debian, with the hooks.
bare() {
  mmdebstrap --quiet --variant=apt --keyring=/usr/share/keyrings --dpkgopt=force-unsafe-io \
    --customize-hook="mkdir -p \"\$1$share\"" --customize-hook="sync-in $share $share" "$@" \
    "$suite" /dev/null http://deb.debian.org/debian
}

if [ "$1" = "$version_id" ]; then
  cmake --build "$root/build/release" --target palpate_complete >&2
  pack "$root/build/release"
else
  # shellcheck source=/dev/null
  . "$root/.ci/setup.sh"
  git clone -q --no-hardlinks "$root" "$share/palpate"
  maintainer=$(sed -n 's/^PALPATE_MAINTAINER:STRING=//p' "$root/build/release/CMakeCache.txt")
  cat >"$share/build" <<END
set -eu
cd $share/palpate
cmake --preset release '-DPALPATE_MAINTAINER=$maintainer'
cmake --build --preset release --target palpate_complete
cd build/release
cpack -B $share/debs
END
  bare --include="$(packages core python ros | tr '\n' ','),dpkg-dev,file" \
    --customize-hook="chroot \"\$1\" sh $share/build >&2" \
    --customize-hook="sync-out $share/debs $share/debs"
  rm -rf "$share/palpate"
fi
check_files
# What the image's file does in its base, a bare root does here.
image=$(sed -n 's/^RUN //p' "$root/framework/cmake/debian/Containerfile")
[ -n "$image" ] || fail "the Containerfile installs nothing"
cat >"$share/stranger" <<END
set -eux
useradd --create-home --shell /bin/sh stranger
get="apt-get install -q -y --no-install-recommends"
debs=$share/debs
cp -r \$debs /debs
$image
palpate --help >/dev/null
apt-get update -q
su - stranger -c 'sh $share/run'
\$get \$debs/palpate-dev_*.deb g++ ninja-build
su - stranger -c 'sh $share/plugin'
if [ -f \$debs/python3-palpate_*.deb ]; then
  \$get \$debs/python3-palpate_*.deb
  su - stranger -c 'python3 $share/python'
  python3 -c 'import palpate'
fi
if [ -f \$debs/palpate-baxter_*.deb ]; then
  \$get \$debs/palpate-baxter_*.deb
  su - stranger -c 'palpate plugins backend/baxter' >/dev/null
fi
apt-get purge -q -y 'palpate*' 'python3-palpate*'
! find / -xdev -path '*palpate*' -not -path '$share/*' -not -path '/home/*' -not -path '/proc/*' | grep .
END
chmod -R go+rX "$work"
bare --include=passwd --customize-hook="chroot \"\$1\" sh $share/stranger >&2"
[ $# = 1 ] || cp "$share"/debs/*.deb "$2"
echo "packages: all is well, on $suite" >&2
