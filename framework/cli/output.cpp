// SPDX-License-Identifier: MIT
#include "cli/output.hpp"

#include "cli/command_context.hpp"
#include "cli/display.hpp"

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

namespace palpate::cli {
namespace {

constexpr int kUnknown = -1;
/// The errno of the first failed write to stdout; 0 if no write failed.
int failure = 0;
bool outlives = false;
std::string record;

void note_failure() {
  if (failure == 0) failure = errno != 0 ? errno : kUnknown;
}

}  // namespace

void occupy_standard_files() {
  for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(number, F_GETFD) >= 0) continue;
    // open() returns the lowest free descriptor, which is `number`.
    ::open(number == STDIN_FILENO ? "/dev/full" : "/dev/null", number == STDIN_FILENO ? O_WRONLY : O_RDONLY);
  }
}

void print_text(std::string_view text) { print_data(displayable(text)); }

void print_data(std::string_view text) {
  errno = 0;
  if (failure == 0 && std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) note_failure();
}

void flush_output() {
  errno = 0;
  if (std::fflush(stdout) != 0) note_failure();
}

void outlive_reader() {
  std::signal(SIGPIPE, SIG_IGN);
  outlives = true;
}

void set_record_line(std::string line) { record = std::move(line); }

int finish_output(int status) {
  flush_output();
  errno = 0;
  // Also detects failed writes of CLI11, which prints through std::cout and therefore through stdout.
  if (std::ferror(stdout) != 0) note_failure();
  // Some file systems report lost data only when the file is closed.
  errno = 0;
  const int copy = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  if (copy >= 0 && ::close(copy) != 0) note_failure();
  if (failure == 0) return status;
  if (failure == EPIPE && outlives) {
    if (!record.empty()) print_message(record + "\n");
    return status;
  }
  print_message(fmt::format("standard output: cannot be written{}{}{}{}\n", failure == kUnknown ? "" : ": ",
                            failure == kUnknown ? "" : std::strerror(failure), record.empty() ? "" : "; ", record));
  return status == kDone ? kFailed : status;
}

}  // namespace palpate::cli
