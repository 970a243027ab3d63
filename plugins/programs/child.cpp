// SPDX-License-Identifier: MIT
#include "programs/child.hpp"

#include "programs/command.hpp"
#include "reading/read_file.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::programs {
namespace {

using Clock = std::chrono::steady_clock;

/// Blocks SIGPIPE for this thread while it writes to a pipe whose reader may have ended.
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

/// Waits for `events` of a descriptor until `until`, but not longer than kPollInterval. Returns whether an event
/// occurred.
bool wait_for_event(const FileDescriptor& descriptor, short events, Clock::time_point until) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - Clock::now()) +
                    std::chrono::milliseconds(1);  // The time is rounded up, which avoids a busy loop at the end.
  const auto wait = std::clamp(left, std::chrono::milliseconds(0), kPollInterval);
  pollfd one{descriptor.number(), events, 0};
  return ::poll(&one, 1, until <= Clock::now() ? 0 : static_cast<int>(wait.count())) > 0;
}

/// Returns the process id and the parent's id of each running process of this machine.
std::vector<std::pair<pid_t, pid_t>> processes() {
  std::vector<std::pair<pid_t, pid_t>> out;
  for (const std::filesystem::path& folder : list_folder("/proc")) {
    const std::string name = folder.filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string line = read_bounded(folder / "stat", kMostSystemBytes, FileOrigin::user).text;
    // The format is PID (NAME) STATE PARENT ..., where NAME may contain any character.
    const std::size_t behind = line.rfind(')');
    if (behind == std::string::npos || behind + 4 > line.size()) continue;
    if (line[behind + 2] == 'Z' || line[behind + 2] == 'X') continue;
    out.emplace_back(std::stoi(name), std::atoi(line.c_str() + behind + 4));
  }
  return out;
}

bool carries(pid_t pid, const std::string& mark) {
  const std::string file = "/proc/" + std::to_string(pid) + "/environ";
  const std::string all = '\0' + read_bounded(file, kMostSystemBytes, FileOrigin::user).text;
  return all.find('\0' + mark + '\0') != std::string::npos;
}

}  // namespace

Child::Child(ProgramCall program, const std::string& stderr_file, const FileDescriptor& kept) : stderr_(stderr_file) {
  static std::atomic<int> count{0};
  // Each plugin has a separate copy of this counter. The address of the copy is unique in the process.
  const auto whose = reinterpret_cast<std::uintptr_t>(&count);
  mark_ = "PALPATE_PROGRAM=" + std::to_string(::getpid()) + "." + std::to_string(whose) + "." + std::to_string(++count);
  // Orphaned descendants of the program become children of this process from now on.
  ::prctl(PR_SET_CHILD_SUBREAPER, 1);
  std::optional<Pipe> in = open_pipe();
  std::optional<Pipe> out = open_pipe();
  if (!in || !out) fail("command", "cannot open a pipe");
  std::vector<int> files{in->to_read.number(), out->to_write.number(), stderr_.descriptor().number()};
  if (kept) files.push_back(kept.number());
  program.environment.insert(program.environment.begin(), mark_);
  pid_ = spawn(program, files);
  if (pid_ < 0) fail("command", "cannot start '" + program.file + "'");
  input_ = std::move(in->to_write);
  output_ = std::move(out->to_read);
  for (const FileDescriptor* end : {&input_, &output_}) ::fcntl(end->number(), F_SETFL, O_NONBLOCK);
}

Child::~Child() {
  find_descendants();
  input_.close();
  if (!wait_for_end()) {
    ::kill(-pid_, SIGTERM);
    wait_for_end();
  }
  // The group is killed before the program is reaped. Until then, the id of the group cannot be reused, because it is
  // the process id of the program.
  kill_descendants();
  stderr_.trim();
}

Child::ReadResult Child::send(const std::string& text, const WaitLimit& limit) {
  const NoSigpipe quiet;
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t wrote = ::write(input_.number(), text.data() + done, text.size() - done);
    if (wrote >= 0) {
      done += static_cast<std::size_t>(wrote);
      continue;
    }
    if (errno != EAGAIN && errno != EINTR) return ReadResult::ended;
    if (limit.stopped()) return ReadResult::interrupted;
    if (Clock::now() >= limit.until) return ReadResult::late;
    // The program may write while it reads. Its output is therefore read here, so that its pipe does not fill up.
    pollfd ends[]{{input_.number(), POLLOUT, 0}, {output_.number(), POLLIN, 0}};
    ::poll(ends, buffer_.size() < kMostBuffered ? 2 : 1, static_cast<int>(kPollInterval.count()));
    if ((ends[1].revents & POLLIN) != 0) read_some();
  }
  return ReadResult::complete;
}

ssize_t Child::read_some() {
  std::array<char, 65536> some;
  const ssize_t got = ::read(output_.number(), some.data(), some.size());
  if (got > 0) buffer_.append(some.data(), static_cast<std::size_t>(got));
  return got;
}

std::optional<Child::ReadResult> Child::read_more(const WaitLimit& limit) {
  if (limit.stopped()) return ReadResult::interrupted;
  // The end of the program is checked before the pipe is read. If the program has ended, all its output is already in
  // the pipe.
  const bool over = gone();
  if (wait_for_event(output_, POLLIN, over ? Clock::now() : limit.until)) {
    if (read_some() == 0) return ReadResult::ended;
  } else if (over) {  // A descendant keeps the pipe open.
    return ReadResult::ended;
  } else if (Clock::now() >= limit.until) {
    return ReadResult::late;
  }
  return std::nullopt;
}

Child::ReadResult Child::read(std::string& line, const WaitLimit& limit) {
  for (;;) {
    stderr_.trim();
    const auto end = buffer_.find('\n');
    line = buffer_.substr(0, end);
    if (line.size() > kLongestLine) return ReadResult::too_long;
    if (end != std::string::npos) {
      buffer_.erase(0, end + 1);
      return ReadResult::complete;
    }
    if (const auto heard = read_more(limit)) return *heard;
  }
}

Child::ReadResult Child::read(std::string& bytes, std::size_t count, const WaitLimit& limit) {
  for (;;) {
    stderr_.trim();
    if (buffer_.size() >= count) {
      bytes = buffer_.substr(0, count);
      buffer_.erase(0, count);
      return ReadResult::complete;
    }
    if (const auto heard = read_more(limit)) {
      bytes = buffer_;
      return *heard;
    }
  }
}

std::string Child::describe_end() {
  if (!wait_for_end()) return "closed its stdin or stdout";
  siginfo_t info{};
  if (::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOWAIT) != 0) return "ended";
  std::string how = "ended with exit status " + std::to_string(info.si_status);
  if (info.si_code != CLD_EXITED) {
    const char* name = ::sigdescr_np(info.si_status);
    how = "was ended by signal " + std::to_string(info.si_status) + (name ? std::string(" (") + name + ")" : "");
  }
  const std::string words = stderr_.last_words();
  return words.empty() ? how : how + ", its last output: " + shown(words);
}

/// Returns whether the program has ended. Does not reap the program. An error of waitid() means that another part of
/// this process has reaped it, because SIGCHLD is ignored.
bool Child::gone() const {
  siginfo_t info{};
  return ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOWAIT | WNOHANG) != 0 || info.si_pid != 0;
}

bool Child::wait_for_end() {
  const auto until = Clock::now() + kGrace;
  while (!gone()) {
    stderr_.trim();
    if (Clock::now() >= until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

/// Adds the present descendants of the program to descendants_. It is called before the program is asked to end. Later,
/// descendants without the mark could no longer be recognised, because their parents have ended.
void Child::find_descendants() {
  const auto all = processes();
  descendants_.insert(pid_);
  for (std::size_t before = 0; before != descendants_.size();) {
    before = descendants_.size();
    for (const auto& [pid, parent] : all) {
      if (descendants_.count(pid) != 0) continue;
      const bool left_behind = parent == ::getpid() && carries(pid, mark_);
      if (descendants_.count(parent) != 0 || left_behind) descendants_.insert(pid);
    }
  }
}

/// Kills the program, its group and all descendants with SIGKILL. Reaps those that are children of this process. The
/// program must not have been reaped.
void Child::kill_descendants() {
  // The loop repeats until no descendant is left. A killed process may have started another process just before, and
  // orphans become children of this process. A recorded process id counts only if its parent is this process or a
  // descendant, because ids are reused. A process in a blocked driver may never end, so the number of passes is
  // limited.
  constexpr int kLooks = 2000;
  for (int i = 0; i < kLooks; ++i) {
    find_descendants();
    bool left = false;
    for (const auto& [pid, parent] : processes()) {
      const bool near = parent == ::getpid() || descendants_.count(parent) != 0;
      if (!near || descendants_.count(pid) == 0) continue;
      ::kill(pid, SIGKILL);
      left = true;
    }
    if (!left) break;
    ::kill(-pid_, SIGKILL);
    ::usleep(1000);
  }
  for (const pid_t pid : descendants_) ::waitpid(pid, nullptr, WNOHANG);
}

}  // namespace palpate::programs
