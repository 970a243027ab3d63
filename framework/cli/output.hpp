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
/// Each is opened in the wrong direction (0 for writing, 1 and 2 for reading), so using it still fails. Call this
/// function first in main().
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

/// After this call, the program survives the end of the process that reads stdout, such as `head`. Commands call it if
/// their record is more important than their output.
void outlive_reader();

/// Sets a line with the path of the record, which finish_output() prints if output was lost.
void set_record_line(std::string line);

/// Flushes stdout and checks that all output was written. Returns `status`, or 1 if `status` is 0 and output was lost.
/// Output after the end of the reader of stdout does not count as lost. After outlive_reader(), the line of
/// set_record_line() is then printed on stderr. Without outlive_reader(), SIGPIPE has already ended the process.
int finish_output(int status);

}  // namespace palpate::cli
