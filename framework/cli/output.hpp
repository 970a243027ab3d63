// SPDX-License-Identifier: MIT
// The standard output of the program. A failed write does not end a command but changes its exit status. A lost table
// is therefore not mistaken for a printed one.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace palpate::cli {

/// Opens those of the file descriptors 0, 1 and 2 that are closed, each for the wrong direction. Otherwise a file of a
/// record could get one of these numbers. A read or write through these descriptors still fails. Call this function
/// first in main().
void occupy_standard_files();

/// Prints text for people on stdout. Control characters are replaced by printable(), because the text may contain
/// foreign text. After a failed write, the reason is kept and further text is dropped. Does not throw.
void print_text(std::string_view text);
/// Prints data for programs without any change, such as JSON, YAML and completions.
void print_data(std::string_view text);
template <class... Arguments>
void print_out(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_text(fmt::format(format, std::forward<Arguments>(arguments)...));
}
void flush_output();

/// After this call, the program survives the end of the process that reads stdout, such as `head`. It is for commands
/// whose record is more important than their output.
void outlive_reader();

/// Sets a line about the record of the command.
void set_record_line(std::string line);

/// Flushes stdout and checks that all output was written. Returns `status`, or 1 if `status` is 0 and output was lost.
/// If the reader of stdout has ended, this does not count as lost output. After outlive_reader(), the line about the
/// record is then printed on stderr. Without outlive_reader(), SIGPIPE has already ended the process.
int finish_output(int status);

}  // namespace palpate::cli
