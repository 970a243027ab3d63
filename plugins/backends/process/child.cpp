// SPDX-License-Identifier: MIT
#include "process/child.hpp"

#include "process/protocol.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::process {
namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const std::string& what, int number) {
  throw Error("command", what + ": " + std::strerror(number), {}, Error::Kind::run);
}

struct Pipe {
  Pipe() {
    // Closed on exec from the first moment on: other threads start programs, too.
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) fail("cannot open a pipe", errno);
    to_read = above_standard(ends[0]);
    to_write = above_standard(ends[1]);
  }
  Descriptor to_read;
  Descriptor to_write;
};

/// posix_spawn and not fork: no copy of a large process, nothing of another thread's half-held locks. And not execvp,
/// which hands a file that is no program to a shell.
class Start {
 public:
  Start() {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawnattr_init(&attributes_);
    sigset_t none;
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes_, &none);
    sigset_t usual;
    ::sigemptyset(&usual);
    for (const int signal : {SIGPIPE, SIGINT, SIGTERM, SIGHUP, SIGQUIT}) ::sigaddset(&usual, signal);
    ::posix_spawnattr_setsigdefault(&attributes_, &usual);
    ::posix_spawnattr_setpgroup(&attributes_, 0);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  ~Start() {
    ::posix_spawnattr_destroy(&attributes_);
    ::posix_spawn_file_actions_destroy(&actions_);
  }
  Start(const Start&) = delete;
  Start& operator=(const Start&) = delete;

  /// Hands `file` over under the next number, from that of stdin on.
  void hand_over(const Descriptor& file) { ::posix_spawn_file_actions_adddup2(&actions_, file.number(), ++inherited_); }

  /// The process, or -1 with errno set.
  pid_t operator()(const std::string& file, const std::vector<std::string>& words, const std::string& mark) {
    // Files that the program holds open without the flag, as streams of the standard library do.
    ::posix_spawn_file_actions_addclosefrom_np(&actions_, inherited_ + 1);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    std::vector<char*> environment{const_cast<char*>(mark.c_str())};  // the first of a name counts
    for (char** one = environ; *one != nullptr; ++one) environment.push_back(*one);
    environment.push_back(nullptr);
    pid_t pid = -1;
    errno = ::posix_spawn(&pid, file.c_str(), &actions_, &attributes_, arguments.data(), environment.data());
    return errno == 0 ? pid : -1;
  }

 private:
  int inherited_ = -1;  ///< the last number
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

/// Keeps SIGPIPE from this thread, and from the program, while it writes to a pipe that may have no reader.
class NoSigpipe {
 public:
  NoSigpipe() {
    ::sigemptyset(&pipe_);
    ::sigaddset(&pipe_, SIGPIPE);
    ::pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoSigpipe() {
    const timespec at_once{};
    if (::sigismember(&before_, SIGPIPE) == 0) ::sigtimedwait(&pipe_, nullptr, &at_once);
    ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoSigpipe(const NoSigpipe&) = delete;
  NoSigpipe& operator=(const NoSigpipe&) = delete;

 private:
  sigset_t pipe_{};
  sigset_t before_{};
};

/// Waits for `events` of a descriptor, but not past a glance; whether there are any.
bool glance(const Descriptor& descriptor, short events, Clock::time_point until) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()) +
                    std::chrono::milliseconds(1);  // rounded up, else the last one would be a busy loop
  const auto wait = std::clamp(left, std::chrono::milliseconds(0), kGlance);
  pollfd one{descriptor.number(), events, 0};
  return ::poll(&one, 1, until <= Clock::now() ? 0 : static_cast<int>(wait.count())) > 0;
}

}  // namespace

Child::Child(const std::string& file, const std::vector<std::string>& words, const std::string& diary,
             const Descriptor* kept)
    : diary_(diary) {
  Pipe in;
  Pipe out;
  Start start;
  start.hand_over(in.to_read);
  start.hand_over(out.to_write);
  start.hand_over(diary_.descriptor());
  if (kept != nullptr) start.hand_over(*kept);
  pid_ = start(file, words, descent_.mark());
  if (pid_ < 0) fail("cannot start '" + file + "'", errno);
  input_ = std::move(in.to_write);
  output_ = std::move(out.to_read);
  for (const Descriptor* end : {&input_, &output_}) ::fcntl(end->number(), F_SETFL, O_NONBLOCK);
}

Child::~Child() {
  descent_.look(pid_);
  input_.close();
  if (!wait_for_end()) {
    ::kill(-pid_, SIGTERM);
    wait_for_end();
  }
  // Before it is reaped, so that the number of the group is still its own: what it started must not outlive it either.
  descent_.end(pid_);
  diary_.trim();
}

Child::Heard Child::send(const std::string& text, const Patience& patience) {
  const NoSigpipe quiet;
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t wrote = ::write(input_.number(), text.data() + done, text.size() - done);
    if (wrote >= 0) {
      done += static_cast<std::size_t>(wrote);
      continue;
    }
    if (errno != EAGAIN && errno != EINTR) return Heard::ended;
    if (patience.broken_off()) return Heard::interrupted;
    if (!glance(input_, POLLOUT, patience.until) && Clock::now() >= patience.until) return Heard::late;
  }
  return Heard::line;
}

Child::Heard Child::hear(std::string& line, const Patience& patience) {
  for (;;) {
    diary_.trim();
    const auto end = heard_.find('\n');
    line = heard_.substr(0, end);
    if (line.size() > kLongestLine) return Heard::too_long;
    if (end != std::string::npos) {
      heard_.erase(0, end + 1);
      return Heard::line;
    }
    if (patience.broken_off()) return Heard::interrupted;
    // Asked before the look at the pipe: what it said before it ended is then already in there.
    const bool over = gone();
    if (glance(output_, POLLIN, over ? Clock::now() : patience.until)) {
      std::array<char, 4096> some;
      const ssize_t got = ::read(output_.number(), some.data(), some.size());
      if (got > 0) heard_.append(some.data(), static_cast<std::size_t>(got));
      if (got == 0) return Heard::ended;
    } else if (over) {  // and what it started holds the pipe open
      return Heard::ended;
    } else if (Clock::now() >= patience.until) {
      return Heard::late;
    }
  }
}

std::string Child::fate() {
  if (!wait_for_end()) return "closed its stdin or stdout";
  siginfo_t info{};
  if (::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOWAIT) != 0) return "ended";
  std::string how = "ended with exit status " + std::to_string(info.si_status);
  if (info.si_code != CLD_EXITED) {
    const char* name = ::sigdescr_np(info.si_status);
    how = "was ended by signal " + std::to_string(info.si_status) + (name ? std::string(" (") + name + ")" : "");
  }
  const std::string words = diary_.last_words();
  return words.empty() ? how : how + ", its last words: " + shown(words);
}

/// Whether it ended; it is not reaped yet. An error means that somebody else has: SIGCHLD is ignored.
bool Child::gone() const {
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOWAIT | WNOHANG) != 0 || info.si_pid != 0;
}

bool Child::wait_for_end() {
  const auto until = Clock::now() + kGrace;
  while (!gone()) {
    diary_.trim();
    if (Clock::now() >= until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace palpate::process
