# SPDX-License-Identifier: MIT
# Completion for bash by `palpate --complete`. Installed in the folder that bash reads; for ./palpate, source this file.
# shellcheck shell=bash
_palpate() {
  local piece open='' kept='' words=()
  # Bash splits words at = and :, and keeps quotes. The loop joins the parts again.
  for piece in "${COMP_WORDS[@]:1:COMP_CWORD}"; do
    if [[ -n $piece && ${#words[@]} -gt 0 && ($piece == [=:] || -n $open) ]]; then
      words[-1]+=$piece
    else
      words+=("$piece")
    fi
    open=''
    if [[ $piece == [=:] ]]; then open=yes; fi
  done
  # The part of the last word that Bash counts as a word of its own, and does not replace.
  if [[ ${words[-1]} != [\"\']* ]]; then kept=${words[-1]%"${words[-1]##*[=:]}"}; fi
  mapfile -t COMPREPLY < <("${COMP_WORDS[0]/#\~/$HOME}" --complete "${words[@]#[\"\']}" 2>/dev/null)
  COMPREPLY=("${COMPREPLY[@]%%$'\t'*}")
  COMPREPLY=("${COMPREPLY[@]#"$kept"}")
  if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=./,] ]]; then
    compopt -o nospace # more characters may follow
  fi
}
complete -o nosort -o default -F _palpate palpate
