#!/bin/sh
# SPDX-License-Identifier: MIT
# What README promises of a machine with nothing but git, in a bare root of a Debian that is made for it and removed
# again, with a clone of HEAD: run, its first command, which prints the lines that README shows, and the plugin of
# plugins/README.md; check, its second, which compares taps with runs/reference. Without either, both. As a user who
# has sudo, as root, or as a user who has not, and then root installs the packages before. With ci, where CI=true.
# Needs root, mmdebstrap, a network, and 5 GB in $TMPDIR.
#   sh tests/in_debian.sh 12|13 [run | check] [sudo | root | user] [ci]
# pages runs the blocks "sh" of README and of the pages that it links, each page in a root of its own in which README's
# first command and `./palpate build` have ended and nothing else, after what this page alone says in backquotes by
# `apt install`, `cmake --preset` and `./palpate build`. It prints page, line and last words of what fails. An hour; with
# $PALPATE_ROOT the built root is kept there, and taken from there the next time.
#   sh tests/in_debian.sh 12|13 pages [ci] [PAGE...]
set -eu
root=$(cd "$(dirname "$(readlink -f "$0")")/.." && pwd)

refuse() {
  echo "in_debian: $1" >&2
  exit 2
}

suite=
what="run check"
who=sudo
ci=
pages=
for word in "$@"; do
  case $word in
    12) suite=bookworm ;;
    13) suite=trixie ;;
    run | check | pages) what=$word ;;
    sudo | root | user) who=$word ;;
    ci) ci="export CI=true" ;;
    *.md)
      [ -f "$root/$word" ] || refuse "there is no page $word"
      pages="$pages $word"
      ;;
    *) refuse "unknown argument '$word', it takes 12 or 13, run, check or pages, sudo, root or user, and ci" ;;
  esac
done
[ "$what $who" = "pages sudo" ] || [ "$what" != pages ] || refuse "the commands of pages are tried by a user who has sudo"
[ -n "$suite" ] || refuse "say which Debian, 12 or 13"
[ "$(id -u)" = 0 ] || refuse "only root can make a root of another system"
command -v mmdebstrap >/dev/null || refuse "the package mmdebstrap is missing"

# What the READMEs show, so that it is they who are tested.
both=$(sed -n '/^## Two commands/,/^## Next steps/s|^\(\./[^#]*[^# ]\)  *#.*|\1|p' "$root/README.md")
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

scratch=$(mktemp -d)
trap 'rm -rf --one-file-system "$scratch"' EXIT
trap 'exit 130' INT TERM
share=$scratch/share
mkdir "$share"
git clone -q --no-hardlinks "$root" "$share/palpate"
echo "$capture" >"$share/capture"
{
  echo 'set -eux'
  [ -z "$ci" ] || echo "$ci"
  echo 'cd ~/palpate'
  case $what in *run* | pages)
    echo "$(echo "$both" | sed -n 1p) >~/printed"
    echo 'awk -f ~/palpate/tests/shown.awk ~/capture ~/printed'
    ;;
  esac
  case $what in *run*)
    echo 'cd ~'
    echo "$tutorial"
    echo 'cd ~/palpate'
    ;;
  esac
  case $what in *check*) echo "$both" | sed -n 2p ;; esac
  [ "$what" != pages ] || echo './palpate build'
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
# bare ROOT: a bare root of that Debian in which the commands have ended; /dev/null: nobody keeps it.
bare() {
  mmdebstrap --quiet --variant=apt --include="$packages" --keyring=/usr/share/keyrings --dpkgopt=force-unsafe-io \
    --customize-hook='mkdir "$1/share"' --customize-hook="sync-in $share /share" \
    --customize-hook='chroot "$1" sh /share/prepare' \
    --customize-hook="chroot \"\$1\" su - $name -c 'sh commands'" \
    "$suite" "$1" http://deb.debian.org/debian
}
if [ "$what" != pages ]; then
  bare /dev/null
  echo "in_debian: all is as README says, on $suite as $who" >&2
  exit
fi

# set_up PAGE: what it says in its prose of packages and of programs to build, a command a line.
set_up() {
  tr '\n' ' ' <"$root/$1" | grep -oE '`(sudo )?apt install [a-z][^`]*`|`cmake --preset release &&[^`]*`|`\./palpate build`' |
    sed -E 's/`//g;s/^(sudo )?apt install /sudo apt-get install -q -y --no-install-recommends /' || true
}
# commands PAGE: its line and the command, of every command in a block "sh".
commands() {
  awk '/^ *```/ {inside = $0 ~ /^ *```sh$/; next}
    inside {sub(/^ */, ""); print NR, $0}' "$root/$1"
}
[ -n "$pages" ] || for page in README.md $(grep -oE '\]\([a-zA-Z_/]+\.md' "$root/README.md" | sed 's/^](//' | sort -u); do
  [ -z "$(commands "$page")" ] || pages="$pages $page"
done
built=${PALPATE_ROOT:-$scratch/root}
head=$(git -C "$root" rev-parse HEAD)
if [ -d "$built" ]; then
  [ "$(cat "$built/built_of" 2>/dev/null)" = "$head" ] || refuse "$built has not been built of this commit, remove it"
else
  bare "$built"
  echo "$head" >"$built/built_of"
fi
cat >"$scratch/page" <<'END'
# PAGE NAME: runs what is in /commands, lines of the page and commands; before them what is in /set_up.
page=$1 name=$2 failed=0
try() {
  printf 'cd ~/palpate && { %s\n}\n' "$2" >/command
  su - "$name" -c "sh /command" >/printed 2>&1 </dev/null && return 0
  printf 'in_debian: %s:%s: status %s: %s\n' "$page" "$1" $? "$2"
  tail -n 5 /printed | sed 's/^/  /'
  failed=1
}
apt-get update -q >/dev/null
while read -r line; do try set-up "$line"; done </set_up
while read -r number line; do try "$number" "$line"; done </commands
exit $failed
END
failed=
for page in $pages; do
  echo "in_debian: $page" >&2
  rm -rf "$scratch/upper" "$scratch/work"
  mkdir "$scratch/upper" "$scratch/work"
  set_up "$page" >"$scratch/upper/set_up"
  commands "$page" >"$scratch/upper/commands"
  cp "$scratch/page" "$scratch/upper/page"
  chmod 755 "$scratch/upper"
  # What this page installs or makes goes into `upper`, and is gone with it.
  page=$page name=$name unshare --mount --pid --fork --kill-child sh -euc '
    mount -t overlay overlay -o "lowerdir=$0,upperdir=$1/upper,workdir=$1/work" "$0"
    cd "$0"
    mount -t proc proc proc
    mount --rbind /dev dev
    mount -t tmpfs tmpfs dev/shm
    cp /etc/resolv.conf etc/resolv.conf
    exec chroot . sh /page "$page" "$name"' "$built" "$scratch" >&2 || failed="$failed $page"
done
[ -z "$failed" ] || { echo "in_debian: failed:$failed" >&2; exit 1; }
echo "in_debian: all commands run with what their pages name, on $suite:$pages" >&2
