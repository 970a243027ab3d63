// SPDX-License-Identifier: MIT
// The standard output of the program. A failed write does not end a command, but changes its exit status, so that a
// lost table does not look like a printed one.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace palpate::cli {

/// Opens those of the files 0, 1 and 2 that are closed, in the wrong direction. So no file of a record gets such a
/// number, and a write to them fails. Call this function first.
void occupy_standard_files();

/// Prints text for people on stdout, with control characters replaced (printable()), because it may contain foreign
/// text. After a failure, the first reason is kept and further text is dropped. Does not throw.
void print_text(std::string_view text);
/// Prints data for programs unchanged: JSON, YAML, words of a completion.
void print_data(std::string_view text);
template <class... Arguments>
void print_out(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_text(fmt::format(format, std::forward<Arguments>(arguments)...));
}
void flush_output();

/// From now on, the program survives the end of the reader of stdout, such as `head`. For commands whose record is
/// worth more than their output.
void outlive_reader();

/// Sets a line about the record of the command. finish_output() prints it on stderr if stdout has failed.
void set_record_line(std::string line);

/// Flushes stdout and checks that all output was written. Returns `status`, or 1 if `status` is 0 and output was lost.
/// A reader that has ended is not a loss: after outlive_reader(), stderr gets the line about the record. Without
/// outlive_reader(), SIGPIPE has already ended the process.
int finish_output(int status);

}  // namespace palpate::cli
