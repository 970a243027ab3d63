// SPDX-License-Identifier: MIT
// From the text of an option to a program and its arguments, without a shell.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace palpate::process {

/// The words of `text`, split at blanks. 'single' and "double" quotes keep blanks together and are taken away; nothing
/// else means anything, neither a backslash nor a dollar sign. None if a quote is left open or no word is there.
std::optional<std::vector<std::string>> split_command(const std::string& text);

/// The file that runs as `program`: a path as it stands, a bare name from the folders of PATH. None if no such file may
/// be executed.
std::optional<std::string> find_program(const std::string& program);

}  // namespace palpate::process
