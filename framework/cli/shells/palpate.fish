# SPDX-License-Identifier: MIT
# Completion for fish by `palpate --complete`. This file is installed in a folder that fish searches. To complete
# ./palpate in a clone, source this file.
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
