// SPDX-License-Identifier: MIT
#include "launch/command.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

/// What a child is started with; taken down at the end of the scope.
class SpawnPlan {
 public:
  explicit SpawnPlan(int output) {
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&files, output, STDERR_FILENO);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    ::posix_spawnattr_setpgroup(&attributes, 0);
  }
  ~SpawnPlan() {
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&files);
  }
  SpawnPlan(const SpawnPlan&) = delete;
  SpawnPlan& operator=(const SpawnPlan&) = delete;

  posix_spawn_file_actions_t files{};
  posix_spawnattr_t attributes{};
};

std::vector<char*> seen_environment(const std::function<bool(std::string_view)>& sees) {
  std::vector<char*> out;
  for (char** one = environ; *one != nullptr; ++one) {
    const std::string_view text = *one;
    if (!sees || sees(text.substr(0, text.find('=')))) out.push_back(*one);
  }
  out.push_back(nullptr);
  return out;
}

}  // namespace

Command::Command(const std::vector<std::string>& words, const std::function<bool(std::string_view name)>& sees) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw Error(words.front(), fmt::format("no pipe to it: {}", std::strerror(errno)), {}, Error::Kind::run);
  }
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const SpawnPlan plan(ends[1]);
  const int refused = ::posix_spawnp(&pid_, arguments.front(), &plan.files, &plan.attributes, arguments.data(),
                                     seen_environment(sees).data());
  ::close(ends[1]);
  pipe_ = ends[0];
  if (refused == 0) return;
  ::close(pipe_);
  if (refused == ENOENT) throw Error(words.front(), "is not installed, or not on PATH");
  throw Error(words.front(), fmt::format("cannot be started: {}", std::strerror(refused)));
}

Command::~Command() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    reap();
  }
  ::close(pipe_);
}

bool Command::wait(double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (pid_ > 0) {
    const double left = std::chrono::duration<double>(end - Clock::now()).count();
    pollfd readable{pipe_, POLLIN, 0};
    // Rounded up: a wait that is a little too short would go round and round.
    const int ready = ::poll(&readable, 1, left > 0.0 ? static_cast<int>(1000.0 * left) + 1 : 0);
    if (ready <= 0) return false;
    std::array<char, 65536> buffer{};
    const ssize_t size = ::read(pipe_, buffer.data(), buffer.size());
    if (size > 0) output_.append(buffer.data(), static_cast<std::size_t>(size));
    if (size == 0) reap();
  }
  return true;
}

void Command::reap() {
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = -1;
  status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string shell_word(const std::string& text) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./,:=@+%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
    } else {
      out += c;
    }
  }
  return out + "'";
}

}  // namespace palpate
