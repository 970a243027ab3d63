// SPDX-License-Identifier: MIT
#include "launch/children.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

/// What a child says through its pipe: a dot for each thing that is done; a '!' and behind it what went wrong, its last
/// words; or nothing more.
constexpr char kDone = '.';
constexpr char kTrouble = '!';

void say(int pipe, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = ::write(pipe, text.data() + at, text.size() - at);
    if (written < 0 && errno != EINTR) ::_exit(1);
    at += written > 0 ? static_cast<std::size_t>(written) : 0;
  }
}

/// Every `step`-th thing from `first` on: neighbours take about as long, so that all children end together.
[[noreturn]] void be_child(int pipe, int parent, std::size_t first, std::size_t step, std::size_t count,
                           const std::function<void(std::size_t)>& work) {
  // Between fork and this call the parent may have died already.
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != parent) ::_exit(1);
  // Of the terminal's signals the parent hears, and ends its children.
  ::setpgid(0, 0);
  try {
    for (std::size_t i = first; i < count; i += step) {
      work(i);
      say(pipe, {kDone});
    }
  } catch (const std::exception& trouble) {
    say(pipe, kTrouble + std::string(trouble.what()));
  } catch (...) {
    say(pipe, kTrouble + std::string("a plugin threw something that is no exception"));
  }
  ::_exit(0);
}

/// The children of one call. Kills what is left of them at its end.
class Children {
 public:
  Children() = default;
  ~Children() {
    for (const Child& child : children_) {
      if (child.pipe >= 0) ::kill(child.pid, SIGKILL);
    }
    for (const Child& child : children_) {
      if (child.pipe >= 0) ::close(child.pipe);
      while (::waitpid(child.pid, nullptr, 0) < 0 && errno == EINTR) {
      }
    }
  }
  Children(const Children&) = delete;
  Children& operator=(const Children&) = delete;

  void start(std::size_t first, std::size_t step, std::size_t count, const std::function<void(std::size_t)>& work) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw system_error("no pipe for a process");
    std::fflush(nullptr);  // or the child would print it again
    const int parent = ::getpid();
    const pid_t pid = ::fork();
    if (pid == 0) {
      ::close(ends[0]);
      be_child(ends[1], parent, first, step, count, work);
    }
    const int why = errno;
    ::close(ends[1]);
    if (pid < 0) {
      ::close(ends[0]);
      errno = why;
      throw system_error("no process for a part of the work");
    }
    children_.push_back({pid, ends[0], {}});
  }

  /// Waits for news, not for long nor beyond a signal, and adds to `done` what was done. Returns whether any child is
  /// still there.
  bool listen(std::size_t& done) {
    std::vector<pollfd> pipes;
    for (const Child& child : children_) pipes.push_back({child.pipe, POLLIN, 0});  // closed ones, -1, are passed over
    constexpr int kMilliseconds = 100;
    ::poll(pipes.data(), pipes.size(), kMilliseconds);
    for (std::size_t i = 0; i < children_.size(); ++i) {
      if (pipes[i].revents != 0) hear(children_[i], done);
    }
    return std::any_of(children_.begin(), children_.end(), [](const Child& child) { return child.pipe >= 0; });
  }

 private:
  struct Child {
    pid_t pid = -1;
    int pipe = -1;  ///< -1 once it has said all
    std::string trouble;
  };

  static Error system_error(const char* what) {
    return Error("", fmt::format("{}: {}", what, std::strerror(errno)), {}, Error::Kind::run);
  }

  static void hear(Child& child, std::size_t& done) {
    std::array<char, 4096> said{};
    const ssize_t size = ::read(child.pipe, said.data(), said.size());
    if (size < 0) return;
    for (ssize_t i = 0; i < size; ++i) {
      const char letter = said[static_cast<std::size_t>(i)];
      if (child.trouble.empty() && letter == kDone) {
        ++done;
      } else {
        child.trouble += letter;
      }
    }
    if (size > 0) return;
    ::close(child.pipe);
    child.pipe = -1;
    if (!child.trouble.empty()) throw Error("", child.trouble.substr(1), {}, Error::Kind::run);
  }

  std::vector<Child> children_;
};

}  // namespace

bool in_children(std::size_t count, int workers, const std::function<void(std::size_t)>& work,
                 const std::atomic<bool>* interrupted, const std::function<void(std::size_t)>& progress) {
  const std::size_t step = std::min(count, static_cast<std::size_t>(std::max(1, workers)));
  Children children;
  for (std::size_t first = 0; first < step; ++first) children.start(first, step, count, work);
  std::size_t done = 0;
  for (bool any = step > 0; any;) {
    const std::size_t before = done;
    any = children.listen(done);
    if (progress && done != before) progress(done);
    if (interrupted != nullptr && interrupted->load() && done < count) return false;
  }
  if (done < count) throw Error("", "a process that did a part of the work was killed", "try again", Error::Kind::run);
  return true;
}

}  // namespace palpate
