#!/bin/sh
# SPDX-License-Identifier: MIT
# What README promises of a machine with nothing but git, in a bare root of a Debian that is made for it and removed
# again, with a clone of HEAD: run, its first command, which prints what README shows, and the plugin of
# plugins/README.md; check, its second, which compares taps with runs/reference. Without either, both. As a user who
# has sudo, as root, or as a user who has not, and then root installs the packages before.
# Needs root, mmdebstrap, a network, and 5 GB in $TMPDIR.
#   sh tests/in_debian.sh 12|13 [run | check] [sudo | root | user]
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)

refuse() {
  echo "in_debian: $1" >&2
  exit 2
}

suite=
what="run check"
who=sudo
for word in "$@"; do
  case $word in
    12) suite=bookworm ;;
    13) suite=trixie ;;
    run | check) what=$word ;;
    sudo | root | user) who=$word ;;
    *) refuse "unknown argument '$word', it takes 12 or 13, run or check, and sudo, root or user" ;;
  esac
done
[ -n "$suite" ] || refuse "say which Debian, 12 or 13"
[ "$(id -u)" = 0 ] || refuse "only root can make a root of another system"
command -v mmdebstrap >/dev/null || refuse "the package mmdebstrap is missing"

# What the READMEs show, so that it is they who are tested.
both=$(sed -n '/^## Two commands/,/^## What one does most/s|^\(\./[^#]*[^# ]\)  *#.*|\1|p' "$root/README.md")
capture=$(sed -n '/^ tap  source/,/^```/{/^```/d;p}' "$root/README.md")
tutorial=$(sed -n '/^cmake --install/,/^```/{/^```/d;p}' "$root/plugins/README.md")
[ "$(echo "$both" | wc -l)" = 2 ] && [ -n "$capture" ] && [ -n "$tutorial" ] || refuse "the READMEs show no commands"

name=tapper
home=/home/tapper
packages=git
case $who in
  sudo) packages=$packages,passwd,sudo ;;
  user) packages=$packages,passwd ;;
  root) name=root home=/root ;;
esac

share=$(mktemp -d)
trap 'rm -rf "$share"' EXIT
trap 'exit 130' INT TERM
git clone -q --no-hardlinks "$root" "$share/palpate"
cp -r "$root/tests/consumer" "$share/my_plugins"
echo "$capture" >"$share/capture"
{
  echo 'set -eux'
  echo 'cd ~/palpate'
  case $what in *run*)
    echo "$(echo "$both" | sed -n 1p) >~/printed"
    echo 'diff ~/capture ~/printed'
    echo 'cd ~/my_plugins'
    echo "$tutorial"
    echo 'cd ~/palpate'
    ;;
  esac
  case $what in *check*) echo "$both" | sed -n 2p ;; esac
} >"$share/commands"
cat >"$share/prepare" <<END
set -eu
[ $name = root ] || useradd --create-home --shell /bin/sh $name
[ $who != sudo ] || echo '$name ALL=(ALL) NOPASSWD: ALL' >/etc/sudoers.d/$name
cp -r /share/. $home
if [ $who = user ]; then
  root=/share/palpate no_install=no
  . /share/palpate/.ci/setup.sh
  lock_setup
  install core test
fi
chown -R $name: $home
END
chmod -R go+rX "$share"
# force-unsafe-io: nobody misses a root that is removed again, and dpkg waits for the disk else.
mmdebstrap --quiet --variant=apt --include="$packages" --keyring=/usr/share/keyrings --dpkgopt=force-unsafe-io \
  --customize-hook='mkdir "$1/share"' --customize-hook="sync-in $share /share" \
  --customize-hook='chroot "$1" sh /share/prepare' \
  --customize-hook="chroot \"\$1\" su - $name -c 'sh commands'" \
  "$suite" /dev/null http://deb.debian.org/debian
echo "in_debian: all is as README says, on $suite as $who" >&2
