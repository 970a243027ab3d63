# SPDX-License-Identifier: MIT
# Set-up shared by ./palpate and ./check, to be sourced. All it says goes to stderr.

say() { printf '%s\n' "$*" >&2; }

# packages HEADING...: the packages under these headings of packages.txt.
packages() {
  for heading in "$@"; do
    sed -n "/^\[$heading\]/,/^\[/{/^\[/d;s/[[:space:]]*#.*//;/^$/d;p}" "$root/packages.txt"
  done
}

# look: asks which packages of packages.txt, of any heading, are installed, and keeps their names in `installed`. Where
# there is no dpkg, none is known to be.
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

# install HEADING...: installs what is missing, if it may.
install() {
  look
  list=$(missing $(packages "$@") | tr '\n' ' ')
  if [ -z "$list" ]; then
    [ "$no_install" = no ] || say "no package is missing"
    return 0
  fi
  if [ "$no_install" = yes ]; then
    say "missing packages: $list"
    return 0
  fi
  as_root=
  if [ "$(id -u)" != 0 ]; then
    as_root=sudo
    if ! sudo -n true 2>/dev/null && ! { [ -t 0 ] && command -v sudo >/dev/null 2>&1; }; then as_root=none; fi
  fi
  if [ "$as_root" = none ] || ! command -v apt-get >/dev/null 2>&1; then
    say "these packages are missing and cannot be installed from here: $list"
    return 0
  fi
  say "installing $list"
  if ! { $as_root apt-get update -q && DEBIAN_FRONTEND=noninteractive $as_root apt-get install -q -y --no-install-recommends $list; } \
      >"$root/build/install.log" 2>&1; then
    tail -n 5 "$root/build/install.log" >&2
    say "installing failed, the whole story is in build/install.log; going on with what is there"
  fi
  look
}

# build PRESET TARGET...: configures if that was never done or other packages are installed than were then, whoever
# installed them, and builds what changed. Where CI=true, as services of continuous integration set it, warnings are errors.
build() {
  preset=$1
  shift
  log=$root/build/$preset.log
  known=$root/build/$preset/packages # that were installed when it was configured
  if [ ! -f "$root/build/$preset/build.ninja" ] || [ ! -f "$known" ] || [ "$(cat "$known")" != "$installed" ]; then
    warnings=
    [ "${CI:-}" != true ] || warnings=-DPALPATE_WERROR=ON
    if ! cmake --preset "$preset" -S "$root" $warnings >"$log" 2>&1; then
      grep -A 4 -E 'CMake Error|Could NOT' "$log" >&2 || true
      say "configuring failed, the whole story is in build/$preset.log"
      exit 1
    fi
    printf '%s\n' "$installed" >"$known"
    say "building preset $preset, about a minute or two"
  fi
  if ! ninja -C "$root/build/$preset" --quiet "$@" >"$log" 2>&1; then
    grep -m 10 -E 'error|FAILED' "$log" >&2 || true
    say "building failed, the whole story is in build/$preset.log"
    exit 1
  fi
}

mkdir -p "$root/build"
# One set-up at a time; the lock ends with this shell or with what it hands over to.
exec 9>"$root/build/setup.lock"
flock 9
