# SPDX-License-Identifier: MIT
# Completion for fish: asks the program. Installed where fish looks; for ./palpate, source it.
function __palpate_complete
    set -l words (commandline -opc)
    set -l word (commandline -ct)
    set -l program (string replace -r '^~' "$HOME" -- $words[1])
    set -l found (command $program --complete $words[2..-1] "$word" 2>/dev/null)
    if set -q found[1]
        printf '%s\n' $found
    else
        __fish_complete_path "$word"
    end
end
complete -c palpate -f -k -a '(__palpate_complete)'
