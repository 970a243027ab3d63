# SPDX-License-Identifier: MIT
# Set-up shared by ./palpate and ./check, to be sourced; lock_setup comes first. All it says goes to stderr.

say() { printf '%s\n' "$*" >&2; }

# lock FD NAME WHAT: waits until nobody else holds build/NAME.lock, and holds it, as FD, until that is closed or this shell
# and all that it began have ended. Says for whom it waits.
lock() {
  mkdir -p "$root/build"
  eval "exec $1>>\"\$root/build/$2.lock\""
  if ! flock -n "$1"; then
    read -r holder <"$root/build/$2.lock" && [ -d "/proc/$holder" ] || holder=
    say "waiting for $3${holder:+: process $holder}"
    flock "$1"
  fi
  echo $$ >"$root/build/$2.lock"
}

# One set-up of this folder at a time. What does not set up or build lets go of it first.
lock_setup() { lock 9 setup "another set-up of this folder"; }
unlock_setup() { exec 9>&-; }

# state LOG: how far it is by its log: the last count, as of ninja or ctest, or else the last line.
state() {
  count='s|^\[* *\([0-9]\{1,\}\)/ *\([0-9]\{1,\}\)[] ].*|\1 of \2|p'
  counted=$(tail -n 40 "$1" 2>/dev/null | sed -n "$count" | tail -n 1)
  [ -n "$counted" ] || counted=$(tail -n 1 "$1" 2>/dev/null | tr -d '[:cntrl:]' | sed 's/\(.\{50\}\).*/\1/')
  printf '%s' "$counted"
}

# follow WHAT LOG: says how far it is, on a terminal each second in one line, elsewhere in a line every half minute; until
# it is ended, or this script.
follow() {
  waited=0
  while sleep 1 >/dev/null 2>&1 && kill -0 $$ 2>/dev/null; do
    waited=$((waited + 1))
    if [ -t 2 ]; then
      printf '\r\033[K%s: %s' "$1" "$(state "$2")" >&2
    elif [ $((waited % 30)) = 0 ]; then
      say "$1: $(state "$2")"
    fi
  done
}

# told WHAT LOG COMMAND...: runs the command, its output to the log alone, and says how far it is meanwhile. What ends this
# script ends the command, too.
told() {
  what=$1
  output=$2
  shift 2
  : >"$output"
  follow "$what" "$output" 8>&- 9>&- &
  follower=$!
  # A shell that waits for a command hears no signal; one that waits for its child does. The traps come before the
  # child: a signal between the two would end this script alone.
  trap 'end_worker 129' HUP
  trap 'end_worker 130' INT
  trap 'end_worker 143' TERM
  "$@" >"$output" 2>&1 <&0 &
  status=0
  wait $! || status=$?
  trap - HUP INT TERM
  end_follower
  return $status
}

end_follower() {
  kill $follower 2>/dev/null || true
  wait $follower 2>/dev/null || true
  [ ! -t 2 ] || printf '\r\033[K' >&2
}

# end_worker STATUS: ends the command under way, which began last, waits until it has gone, and ends this script.
end_worker() {
  trap '' HUP INT TERM
  # What root runs, only root may end.
  kill -TERM $! 2>/dev/null || ${as_root:-false} kill -TERM $! 2>/dev/null || true
  wait $! 2>/dev/null || true
  end_follower
  exit "$1"
}

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

# refresh: asks which packages there are, as root by `as_root`. It and fetch become apt: whoever ends them ends that.
refresh() { exec $as_root apt-get update -q; }

# room: what apt says that the packages of `list` take: ", 147 MB to fetch, 708 MB of disk"; nothing where it does not
# say. Told not to go on, and to fetch and no more: where apt has nothing to ask it goes on.
room() {
  $as_root env LC_ALL=C apt-get install -q -d --assume-no --no-install-recommends $list 2>/dev/null | sed -n '
    s|^Need to get \([0-9.,]* [kMG]*B\).*|, \1 to fetch|p
    s|^After this operation, \([0-9.,]* [kMG]*B\) of additional disk space.*|, \1 of disk|p' | tr -d '\n'
}

# fetch: installs the packages of `list`, as root by `as_root`.
fetch() {
  exec $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $list
}

# become_root: how packages are installed by who is not root: `as_root` is sudo, or none. At a terminal it asks once.
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
  log=update
  told "updating the list of packages" "$root/build/$log.log" refresh && {
    log=install
    say "installing $list"
    say "installing packages: a minute or two$(room)"
    told "installing packages" "$root/build/$log.log" fetch
  } || {
    tail -n 5 "$root/build/$log.log" >&2
    say "installing failed, see build/$log.log; continuing with the installed packages"
  }
  look
}

# announce PRESET TARGET...: says how long it will take to build these, where that is more than a moment. A step takes 5 s
# of one core in the mean; one that compiles takes up to half a minute. Asked for what build.ninja says itself, ninja would
# plan no more than to make build.ninja, whose globs are always looked at.
announce() {
  preset=$1
  shift
  echo "include build.ninja" >"$root/build/$preset/plan.ninja"
  plan=$(ninja -C "$root/build/$preset" -n -f plan.ninja "$@" 2>/dev/null) || plan=
  steps=$(printf '%s\n' "$plan" | sed -n 's|^\[[0-9]*/\([0-9]*\)\].*|\1|p' | tail -n 1)
  [ "${steps:-0}" -ge 10 ] || [ "$(printf '%s\n' "$plan" | grep -c 'Building CXX')" -ge 3 ] || return 0
  minutes=$((1 + steps / 12 / $(nproc 2>/dev/null || echo 2)))
  say "building the parts that this command needs: $steps steps, about $(minutes_words "$minutes")"
}

minutes_words() { if [ "$1" = 1 ]; then echo "1 minute"; else echo "$1 minutes"; fi; }

# build PRESET TARGET...: configures if that was never done or other packages are installed than were then, whoever
# installed them, and builds what changed. Where CI=true, as services of continuous integration set it, warnings are errors.
build() {
  preset=$1
  shift
  log=$root/build/$preset.log
  known=$root/build/$preset/packages # that were installed when it was configured
  first=no
  [ -f "$known" ] || first=yes
  if [ ! -f "$root/build/$preset/build.ninja" ] || [ ! -f "$known" ] || [ "$(cat "$known")" != "$installed" ]; then
    warnings=
    [ "${CI:-}" != true ] || warnings=-DPALPATE_WERROR=ON
    if ! told "configuring preset $preset" "$log" cmake --preset "$preset" -S "$root" $warnings; then
      grep -A 4 -E 'CMake Error|Could NOT|: not found' "$log" >&2 || true
      say "configuring failed, see build/$preset.log"
      exit 1
    fi
    printf '%s\n' "$installed" >"$known"
  fi
  if [ $first = yes ]; then
    # Minutes of one core, and room, that everything takes, what ./check builds, and what the first ./palpate run asks
    # for with the plugins of configs/default.yaml.
    case "$preset $*" in
      'release ') whole=25 disk='900 MB' ;;
      *' ') whole=25 disk='1.9 GB' ;;
      *' palpate_everyday' | *' palpate_hostile') whole=14 disk='800 MB' ;;
      *) whole=8 disk='200 MB' ;;
    esac
    say "building preset $preset: about $((1 + whole / $(nproc 2>/dev/null || echo 2))) minutes the first time, $disk of disk"
  else
    announce "$preset" "$@"
  fi
  if ! NINJA_STATUS='[%f/%t] ' told "building preset $preset" "$log" ninja -C "$root/build/$preset" "$@"; then
    grep -v '^\[' "$log" | grep -m 10 -E 'error|FAILED' >&2 || true
    say "building failed, see build/$preset.log"
    exit 1
  fi
}
