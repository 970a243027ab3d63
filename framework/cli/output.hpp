// SPDX-License-Identifier: MIT
// Standard output of the program. What cannot be printed ends no command, but decides its exit status: a table that was
// lost must not look like one that was printed.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace palpate::cli {

/// Opens those of the files 0, 1 and 2 that the process was started without, the wrong way round: no file of a record
/// gets such a number, and printing fails instead of going nowhere. To be called first.
void occupy_standard_files();

/// Prints text for people on stdout, as printable() has it: parts of it may come from a stranger. The reason of the
/// first failure is kept, and what follows it is dropped. Never throws for that.
void print_text(std::string_view text);
/// The same for programs, byte for byte: JSON, YAML, the words of a completion.
void print_data(std::string_view text);
template <class... Arguments>
void print_out(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_text(fmt::format(format, std::forward<Arguments>(arguments)...));
}
void flush_output();

/// From here on a reader that is gone, as `head` or `tee` may be, does not end the program: for commands whose record
/// is worth more than their words.
void outlive_reader();

/// A line about the record of the command, which finish_output() repeats on stderr if stdout has failed.
void name_record(std::string line);

/// Hands all that was printed to the file of stdout and checks that it took it. Returns the exit status of the program:
/// `status`, or 1 where that is 0 and words were lost. A reader that is gone loses none; after outlive_reader() stderr
/// has the line about the record, and without it the process ends by SIGPIPE before this is called.
int finish_output(int status);

}  // namespace palpate::cli
