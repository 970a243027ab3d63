# SPDX-License-Identifier: MIT
# Completion for bash: asks the program. Installed where bash looks; for ./palpate, source it.
# shellcheck shell=bash
_palpate() {
  local piece open='' kept='' words=()
  # Bash takes a word apart at each = and :, and leaves quotes where they are.
  for piece in "${COMP_WORDS[@]:1:COMP_CWORD}"; do
    if [[ -n $piece && ${#words[@]} -gt 0 && ($piece == [=:] || -n $open) ]]; then
      words[-1]+=$piece
    else
      words+=("$piece")
    fi
    open=''
    if [[ $piece == [=:] ]]; then open=yes; fi
  done
  # What it takes for a word before the one that it completes.
  if [[ ${words[-1]} != [\"\']* ]]; then kept=${words[-1]%"${words[-1]##*[=:]}"}; fi
  mapfile -t COMPREPLY < <("${COMP_WORDS[0]/#\~/$HOME}" --complete "${words[@]#[\"\']}" 2>/dev/null)
  COMPREPLY=("${COMPREPLY[@]%%$'\t'*}")
  COMPREPLY=("${COMPREPLY[@]#"$kept"}")
  if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=./,] ]]; then
    compopt -o nospace # the word goes on
  fi
}
complete -o nosort -o default -F _palpate palpate
