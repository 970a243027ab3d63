// SPDX-License-Identifier: MIT
// `--help` and the manual pages, from what CLI11 knows of the commands.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpate::cli {

/// Returns the options and positional arguments of `command` in the order of `--help`: positional ones, those without a
/// heading of their own, the others.
std::vector<const CLI::Option*> arguments_of(const CLI::App& command);

/// Returns the word that help has for the value of `option`: FOLDER, N, KEY=VALUE; "" for a flag.
std::string value_of(const CLI::Option& option);

/// Returns the values that `option` accepts; none where there are more than a few.
std::vector<std::string> choices_of(const CLI::Option& option);

/// Returns the description of `option` with its limits, default and relations to other options.
std::string meaning_of(const CLI::Option& option);

/// Returns the text of `--help` of a command or, for the app without a parent, of the program. Lines have at most 100
/// letters, but for words that have more.
std::string help_text(const CLI::App& app);

/// Writes palpate.1 and palpate-COMMAND.1 into `folder`, which is made. Throws std::runtime_error where it cannot.
void write_manual(const CLI::App& app, const std::filesystem::path& folder);

}  // namespace palpate::cli
