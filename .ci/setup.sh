# SPDX-License-Identifier: MIT
# Set-up shared by ./palpate and ./check, to be sourced; lock_setup comes first. All messages go to stderr.

say() { printf '%s\n' "$*" >&2; }

# lock FD NAME WHAT: waits for the lock build/NAME.lock and holds it as FD. Programs that this shell starts inherit FD. If
# the shell is killed while ninja or apt-get is running, the lock is therefore held until they end.
lock() {
  mkdir -p "$root/build"
  eval "exec $1>>\"\$root/build/$2.lock\""
  flock -n "$1" && return 0
  say "waiting for $3"
  flock "$1"
}

# One set-up of this folder at a time. Commands that neither set up nor build begin after unlock_setup.
lock_setup() { lock 9 setup "another set-up of this folder"; }
unlock_setup() { exec 9>&-; }

# packages HEADING...: the packages under these headings of packages.txt.
packages() {
  for heading in "$@"; do
    sed -n "/^\[$heading\]/,/^\[/{/^\[/d;s/[[:space:]]*#.*//;/^$/d;p}" "$root/packages.txt"
  done
}

# look: stores the installed packages among those of packages.txt in `installed`; without dpkg none is known.
look() {
  installed=
  command -v dpkg-query >/dev/null 2>&1 || return 0
  installed=$(dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' \
    $(sed '/^\[/d;s/[[:space:]]*#.*//' "$root/packages.txt") 2>/dev/null | sed -n 's/^[a-z]i *//p')
}

# missing PACKAGE...: those of them that are not installed.
missing() {
  [ $# -eq 0 ] || printf '%s\n' "$@" | grep -vxF -e "$installed" || true
}

# space: the download and disk space that apt states for the packages of `list`: ", 147 MB to fetch, 708 MB of disk".
# With -d and --assume-no, apt neither fetches nor installs.
space() {
  $as_root env LC_ALL=C apt-get install -q -d --assume-no --no-install-recommends $list 2>/dev/null | sed -n '
    s|^Need to get \([0-9.,]* [kMG]*B\).*|, \1 to fetch|p
    s|^After this operation, \([0-9.,]* [kMG]*B\) of additional disk space.*|, \1 of disk|p' | tr -d '\n'
}

# become_root: sets `as_root` to sudo if this user may install packages, else to none. On a terminal it asks once.
become_root() {
  as_root=none
  command -v sudo >/dev/null 2>&1 || return 0
  if [ -t 0 ] && [ -t 2 ]; then
    printf 'missing packages: %s\ninstall them with sudo? [Y/n] ' "$list" >&2
    read -r answer || answer=n
    case $answer in
      '' | [Yy] | [Yy]es) ;;
      *) return 0 ;;
    esac
    # Asks for the password, if it has to, before anything else is written to the terminal.
    ! sudo -v || as_root=sudo
  else
    ! sudo -n true 2>/dev/null || as_root=sudo
  fi
}

# install HEADING...: installs what is missing, if it may.
install() {
  look
  list=$(missing $(packages "$@") | tr '\n' ' ')
  if [ -z "$list" ]; then
    [ "$no_install" = no ] || say "no package is missing"
    return 0
  fi
  by_root="apt-get update && apt-get install --no-install-recommends $list"
  if [ "$no_install" = yes ]; then
    say "packages are missing; install them as root with: $by_root"
    return 0
  fi
  as_root=
  [ "$(id -u)" = 0 ] || become_root
  if ! command -v apt-get >/dev/null 2>&1; then
    say "these packages are missing and cannot be installed from here: $list"
    return 0
  fi
  if [ "$as_root" = none ]; then
    say "packages are missing that only root can install; continuing without them. Run as root:"
    say "  $by_root"
    return 0
  fi
  say "installing $list"
  log=$root/build/install.log
  $as_root apt-get update -q >"$log" 2>&1 && {
    say "installing packages: a minute or two$(space)"
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $list >>"$log" 2>&1
  } || {
    tail -n 5 "$log" >&2
    say "installing failed, see build/install.log; continuing with the installed packages"
  }
  look
}

# minutes N: "about N minutes" of one core, on all cores.
minutes() { echo "about $((1 + $1 / $(nproc 2>/dev/null || echo 2))) minutes"; }

# build PRESET TARGET...: configures if that was never done or other packages were installed then, and builds what
# changed. Ninja shows its progress if that takes more than a moment. With CI=true, warnings are errors.
build() {
  preset=$1
  shift
  folder=$root/build/$preset
  first=no
  [ -f "$folder/packages" ] || first=yes
  if [ ! -f "$folder/build.ninja" ] || [ $first = yes ] || [ "$(cat "$folder/packages")" != "$installed" ]; then
    warnings=
    [ "${CI:-}" != true ] || warnings=-DPALPATE_WERROR=ON
    if ! cmake --preset "$preset" -S "$root" $warnings >"$folder.log" 2>&1; then
      grep -A 4 -E 'CMake Error|Could NOT|: not found' "$folder.log" >&2 || true
      say "configuring failed, see build/$preset.log"
      exit 1
    fi
    printf '%s\n' "$installed" >"$folder/packages"
  fi
  shown=yes # progress and output of ninja, else only if it fails
  if [ $first = yes ]; then
    # Minutes of one core, and space, for everything, for ./check, for ./palpate build, and for the first ./palpate run.
    case "$preset $*" in
      'release ') whole=25 disk='900 MB' ;;
      *' fuzz_tests '*) whole=25 disk='1.9 GB' ;;
      *' palpate_everyday') whole=10 disk='1.1 GB' ;;
      *' palpate_complete '*) whole=8 disk='700 MB' ;;
      *) whole=8 disk='200 MB' ;;
    esac
    say "building preset $preset: $(minutes $whole) the first time, $disk of disk"
  else
    # A step takes 5 s of one core on average. Asked for the steps of build.ninja itself, ninja would only plan to make
    # that file, whose globs are always looked at.
    echo "include build.ninja" >"$folder/plan.ninja"
    steps=$(ninja -C "$folder" -n -f plan.ninja "$@" 2>/dev/null | sed -n 's|^\[[0-9]*/\([0-9]*\)\].*|\1|p' | tail -n 1)
    if [ "${steps:-0}" -ge 10 ]; then
      say "building the parts that this command needs: $steps steps, $(minutes $((steps / 12)))"
    else
      shown=no
    fi
  fi
  status=0
  if [ $shown = yes ]; then
    ninja -C "$folder" "$@" >&2 || status=1
  else
    ninja -C "$folder" "$@" >"$folder.log" 2>&1 || { status=1; cat "$folder.log" >&2; }
  fi
  [ $status = 0 ] || { say "building failed"; exit 1; }
}
