// SPDX-License-Identifier: MIT
// The standard output of the program. A failed write does not end a command, but changes its exit status. Callers
// therefore notice if a table was lost.
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

namespace palpate::cli {

/// Opens each closed file descriptor among 0, 1 and 2. Otherwise a file of a record could get one of these numbers.
/// Descriptor 0 is opened for writing, and 1 and 2 for reading, so that using them as standard streams still fails.
/// Call this function first in main().
void occupy_standard_files();

/// Prints text for people on stdout. Control characters are replaced by printable(), because parts of the text may come
/// from files of others. After a failed write, the reason is stored and further text is dropped. Does not throw.
void print_text(std::string_view text);
/// Prints data for programs without any change, such as JSON, YAML and completions.
void print_data(std::string_view text);
template <class... Arguments>
void print_out(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
  print_text(fmt::format(format, std::forward<Arguments>(arguments)...));
}
void flush_output();

/// After this call, the program continues if the process that reads stdout, such as `head`, ends. Commands call this
/// function if their record is more important than their output.
void outlive_reader();

/// Sets a line with the path of the record. finish_output() prints the line if a write to stdout failed.
void set_record_line(std::string line);

/// Flushes stdout and checks that all output was written. Returns `status`, or 1 if `status` is 0 and output was lost.
/// If the process that reads stdout has ended, its missing output does not count as lost. In this case, the line of
/// set_record_line() is printed on stderr. This requires outlive_reader(); without it, SIGPIPE would already have ended
/// this process.
int finish_output(int status);

}  // namespace palpate::cli
