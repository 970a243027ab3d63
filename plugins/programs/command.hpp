// SPDX-License-Identifier: MIT
// The command of a config that starts a program, and what of the program enters the id of a run.
#pragma once

#include <palpate/options.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate::programs {

/// The words of `text`, split at blanks. 'single' and "double" quotes keep blanks together and are taken away; nothing
/// else means anything, neither a backslash nor a dollar sign. None if a quote is left open or no word is there.
std::optional<std::vector<std::string>> split_command(const std::string& text);

/// Lists `command`, the option by which a config names a program, and returns its words. Refused where there are none.
std::optional<std::vector<std::string>> list_command(std::string& command, Fields& fields);

/// Lists `checksum`, the option that has the hash of content_of().
void list_checksum(std::string& checksum, Fields& fields);

/// The file that runs as `program`: a path from `folder` (from the current one if that is empty), a bare name from the
/// folders of PATH. Throws Error where no such file may be executed.
std::string find_program(const std::string& program, const std::string& folder = {});

/// A command as its program's content has it.
struct Content {
  std::string checksum;  ///< 32 hex digits
  std::string file;      ///< the program, as the command names it; empty where that names no file that can be read
  std::string program;   ///< the content of that file
};

/// Returns a hash of the command in which the content of the program stands for its name, so that the id of a run
/// follows what the program does, not where it lies. The program is the first word, or, of an interpreter, the first
/// one that is there; behind -m and -c none is. One that is found by PATH, and a folder, count by name. Other words are
/// no content: a program may write the files that they name. Relative paths begin in `folder`.
Content content_of(const std::vector<std::string>& words, const std::string& folder = {});

/// Returns find_program() of the first word. Before that, throws Error of kind `busy`, its `where` "checksum", unless
/// the content of `command`, which has such words, has this checksum: a program that is gone or changed may come back.
std::string find_checked(const std::string& command, const std::vector<std::string>& words, const std::string& folder,
                         const std::string& checksum);

/// A piece of foreign text, quoted to stand within one line: cut where it is long, '?' for all but printable ASCII.
std::string shown(const std::string& text);

}  // namespace palpate::programs
