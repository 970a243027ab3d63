# SPDX-License-Identifier: MIT
# Completion for bash: asks the program. Installed where bash looks; for ./palpate, source it.
# shellcheck shell=bash
_palpate() {
  mapfile -t COMPREPLY < <("${COMP_WORDS[0]/#\~/$HOME}" --complete bash "${COMP_WORDS[@]:1:COMP_CWORD}" 2>/dev/null)
  if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=./,] ]]; then
    compopt -o nospace # the word goes on
  fi
}
complete -o nosort -F _palpate palpate
