// SPDX-License-Identifier: MIT
#include "cli/watcher.hpp"

#include "children/child_process.hpp"
#include "cli/display.hpp"

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

namespace palpate::cli {
namespace {

/// Returns the first line. If half a minute passes without new text, returns the text that has arrived.
std::string first_line(const FileDescriptor& from) {
  constexpr int kMostWait = 30'000;
  std::string out;
  std::array<char, 256> some{};
  pollfd ready{from.number(), POLLIN, 0};
  while (out.find('\n') == std::string::npos) {
    if (::poll(&ready, 1, kMostWait) <= 0) break;  // poll() also returns if a signal stops the run.
    const ssize_t got = ::read(from.number(), some.data(), some.size());
    if (got <= 0) break;
    out.append(some.data(), static_cast<std::size_t>(got));
  }
  return out.substr(0, out.find('\n'));
}

}  // namespace

void start_watcher(const palpate::cli::CommandEnvironment& program, const std::filesystem::path& directory) {
  const std::string whole = program.installation.whole.string();
  std::string said;
  std::optional<Pipe> pipe = open_pipe();
  const FileDescriptor nothing = above_standard(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  palpate::ProgramCall watch{{whole, "watch", directory.string(), "--until-left"}, whole};
  // The watcher must not inherit open files. Otherwise a process that reads all output of this program would also wait
  // until the watcher ends.
  const bool started =
      pipe && nothing && spawn(watch, {nothing.number(), pipe->to_write.number(), pipe->to_write.number()}) > 0;
  if (!started) said = fmt::format("{}: {}", whole, errno == ENOENT ? "is not built" : std::strerror(errno));
  if (started) {
    pipe->to_write.close();
    said = first_line(pipe->to_read);
  }
  print_message(fmt::format("watch: {}\n", said.empty() ? "the page is not ready yet" : said));
}

void Watcher::start() {
  if (started_) return;
  started_ = true;
  start_watcher(program_, directory_);
}

}  // namespace palpate::cli
