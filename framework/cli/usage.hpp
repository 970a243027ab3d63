// SPDX-License-Identifier: MIT
// `--help` and the manual pages. Both are made from the declarations of the commands in CLI11.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpate::cli {

/// Returns the options and positional arguments of `command` in the order of `--help`. Positional arguments come first,
/// then options without a heading, then options below a heading.
std::vector<const CLI::Option*> arguments_of(const CLI::App& command);

/// Returns the name of an option's value in the help, for example FOLDER, N or KEY=VALUE. Returns "" for a flag.
std::string value_of(const CLI::Option& option);

/// Returns the values that an option accepts; an empty list if the option does not list its values.
std::vector<std::string> choices_of(const CLI::Option& option);

/// Returns the description of `option`, with its limits, its default and its relations to other options.
std::string meaning_of(const CLI::Option& option);

/// Returns the text of `--help` for a command, or for the program if `app` has no parent. Lines have at most 100
/// characters, except for longer words.
std::string help_text(const CLI::App& app);

/// Writes palpate.1 and palpate-COMMAND.1 into `folder`. The folder is created. Throws std::runtime_error if a file
/// cannot be written.
void write_manual(const CLI::App& app, const std::filesystem::path& folder);

}  // namespace palpate::cli
