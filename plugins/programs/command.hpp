// SPDX-License-Identifier: MIT
// The option `command` of a config, which starts a program, and the checksum of that program.
#pragma once

#include <palpate/options.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate::programs {

/// Splits `text` at blanks. Blanks within 'single' or "double" quotes are kept, and the quotes are removed. No other
/// character is special. Returns nullopt if a quote is not closed, or if there is no word.
std::optional<std::vector<std::string>> split_command(const std::string& text);

/// Lists the option `command` and returns its words. Rejects a command without words.
std::optional<std::vector<std::string>> list_command(std::string& command, Fields& fields);

/// Lists the option `checksum`. It is the hash that content_of() returns.
void list_checksum(std::string& checksum, Fields& fields);

/// Returns the file of `program`. The name is a path relative to `folder` (default: the working directory), or a name
/// that is looked up in the folders of PATH. Throws Error if no such executable file exists.
std::string find_program(const std::string& program, const std::string& folder = {});

/// Checksum of a command, with the file and content of its program.
struct ProgramFingerprint {
  std::string checksum;  ///< 32 hex digits
  std::string file;      ///< name of the program in the command; empty if it is not a readable file
  std::string program;   ///< content of this file
};

/// Returns a hash of the command in which the content of the program replaces its name. So the id of a run depends on
/// the program's content, not on its location. The program is the first word. If this word is an interpreter, the
/// program is the first existing file after it; with -m or -c, no file counts as the program. Programs found by PATH,
/// and folders, count by name. Other words also count by name, because a program may write the files that they name.
/// Relative paths start in `folder`.
ProgramFingerprint content_of(const std::vector<std::string>& words, const std::string& folder = {});

/// Returns find_program() of the first word if the content of `command` has this checksum. Otherwise throws Error with
/// place "checksum". The kind of the error is `busy`, because a missing or changed program may be restored later.
std::string find_checked(const std::string& command, const std::vector<std::string>& words, const std::string& folder,
                         const std::string& checksum);

/// Returns foreign text in quotes for a message. Long text is cut, and characters other than printable ASCII become
/// '?'.
std::string shown(const std::string& text);

}  // namespace palpate::programs
