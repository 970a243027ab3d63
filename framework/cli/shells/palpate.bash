# SPDX-License-Identifier: MIT
# Completion for bash by `palpate --complete`. This file is installed in a folder that bash searches. To complete
# ./palpate in a clone, source this file.
# shellcheck shell=bash
_palpate() {
  local piece open='' kept='' words=()
  # Bash splits words at = and :, and keeps quotes. The loop joins the parts of a word again.
  for piece in "${COMP_WORDS[@]:1:COMP_CWORD}"; do
    if [[ -n $piece && ${#words[@]} -gt 0 && ($piece == [=:] || -n $open) ]]; then
      words[-1]+=$piece
    else
      words+=("$piece")
    fi
    open=''
    if [[ $piece == [=:] ]]; then open=yes; fi
  done
  # `kept` is the part of the last word up to its last = or :. Bash treats this part as a separate word and does not
  # replace it.
  if [[ ${words[-1]} != [\"\']* ]]; then kept=${words[-1]%"${words[-1]##*[=:]}"}; fi
  mapfile -t COMPREPLY < <("${COMP_WORDS[0]/#\~/$HOME}" --complete "${words[@]#[\"\']}" 2>/dev/null)
  COMPREPLY=("${COMPREPLY[@]%%$'\t'*}")
  COMPREPLY=("${COMPREPLY[@]#"$kept"}")
  if [[ ${#COMPREPLY[@]} -eq 1 && ${COMPREPLY[0]} == *[=./,] ]]; then
    compopt -o nospace # more characters may follow
  fi
}
complete -o nosort -o default -F _palpate palpate
