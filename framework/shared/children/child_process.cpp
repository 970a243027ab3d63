// SPDX-License-Identifier: MIT
#include "children/child_process.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

/// Returns pointers to the texts, followed by a null pointer, as functions of the C library expect.
std::vector<char*> pointers(const std::vector<std::string>& texts) {
  std::vector<char*> out;
  for (const std::string& text : texts) out.push_back(const_cast<char*>(text.c_str()));
  out.push_back(nullptr);
  return out;
}

/// Runs the work of a forked child. noexcept, because an exception must not unwind the copied stack of the parent.
[[noreturn]] void be_child(const FileDescriptor& to_parent, pid_t parent,
                           const std::function<int(const ChildProcess::Say&)>& work) noexcept {
  // The parent may have ended before the call of prctl().
  if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0 || ::getppid() != parent) ::_exit(1);
  ::setpgid(0, 0);
  ::_exit(work([&](std::string_view text) {
    if (!write_all(to_parent, text)) ::_exit(1);
  }));
}

}  // namespace

void FileDescriptor::close() {
  const int reason = errno;
  if (number_ >= 0) ::close(number_);
  number_ = -1;
  errno = reason;
}

FileDescriptor above_standard(int number) {
  FileDescriptor low(number);
  if (number < 0 || number > STDERR_FILENO) return low;
  return FileDescriptor(::fcntl(number, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
}

std::optional<Pipe> open_pipe() {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  Pipe out{above_standard(ends[0]), above_standard(ends[1])};
  if (!out.to_read || !out.to_write) return std::nullopt;
  return out;
}

bool write_all(const FileDescriptor& to, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(to.number(), text.data(), text.size());
    if (written < 0 && errno != EINTR) return false;
    text.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
  return true;
}

std::vector<std::string> own_environment() {
  std::vector<std::string> out;
  for (char** one = environ; *one != nullptr; ++one) out.emplace_back(*one);
  return out;
}

/// Uses posix_spawn, because fork would copy a large process and the locks of other threads. execvp is not used,
/// because it passes a file that is not an executable program to a shell.
pid_t spawn(const ProgramCall& program, const std::vector<int>& files) {
  const std::vector<char*> words = pointers(program.words);
  const std::vector<char*> environment = pointers(program.environment);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  int number = 0;
  for (const int file : files) ::posix_spawn_file_actions_adddup2(&actions, file, number++);
  // Closes files without O_CLOEXEC, such as streams of the standard library.
  ::posix_spawn_file_actions_addclosefrom_np(&actions, number);
  if (!program.folder.empty()) ::posix_spawn_file_actions_addchdir_np(&actions, program.folder.c_str());
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  sigset_t usual;
  ::sigemptyset(&usual);
  for (const int signal : {SIGPIPE, SIGXFSZ}) ::sigaddset(&usual, signal);  // this process may ignore these signals
  short flags = POSIX_SPAWN_SETSIGDEF;
  if (program.own_group) {
    sigset_t none;
    ::sigemptyset(&none);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) ::sigaddset(&usual, signal);
    ::posix_spawnattr_setpgroup(&attributes, 0);
    flags |= POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK;
  }
  ::posix_spawnattr_setsigdefault(&attributes, &usual);
  ::posix_spawnattr_setflags(&attributes, flags);
  const char* const file = program.file.empty() ? words.front() : program.file.c_str();
  pid_t pid = -1;
  const int refused = ::posix_spawnp(&pid, file, &actions, &attributes, words.data(), environment.data());
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (refused == 0) return pid;
  errno = refused;
  return -1;
}

std::unique_ptr<ChildProcess> ChildProcess::fork(const std::function<int(const Say&)>& work) {
  std::unique_ptr<ChildProcess> out(new ChildProcess);
  std::optional<Pipe> pipe = open_pipe();
  if (!pipe) return nullptr;
  std::fflush(nullptr);  // otherwise the child would write the buffered output again
  const pid_t parent = ::getpid();
  out->pid_ = ::fork();
  if (out->pid_ == 0) {
    pipe->to_read.close();
    be_child(pipe->to_write, parent, work);
  }
  if (out->pid_ < 0) return nullptr;
  ::setpgid(out->pid_, out->pid_);  // parent and child both call setpgid(), because either may run first
  out->pipe_ = std::move(pipe->to_read);
  return out;
}

std::unique_ptr<ChildProcess> ChildProcess::start(const ProgramCall& program, std::string_view input) {
  std::unique_ptr<ChildProcess> out(new ChildProcess);
  // The input is in an unnamed file, because writing to a program that waits for its output to be read can block for
  // ever.
  const FileDescriptor given = above_standard(::memfd_create("input", MFD_CLOEXEC));
  if (!given || !write_all(given, input) || ::lseek(given.number(), 0, SEEK_SET) != 0) return nullptr;
  std::optional<Pipe> pipe = open_pipe();
  if (!pipe) return nullptr;
  out->pid_ = spawn(program, {given.number(), pipe->to_write.number(), pipe->to_write.number()});
  if (out->pid_ < 0) return nullptr;
  out->pipe_ = std::move(pipe->to_read);
  return out;
}

ChildProcess::~ChildProcess() {
  if (ended()) return;
  signal(SIGKILL);
  reap();
}

void ChildProcess::listen(const std::vector<ChildProcess*>& children, double seconds) {
  std::vector<pollfd> pipes;
  for (const ChildProcess* child : children) pipes.push_back({child->pipe_.number(), POLLIN, 0});  // poll() ignores -1
  // The time is rounded up. Otherwise wait() would repeat many waits of 0 ms at the end of its time.
  ::poll(pipes.data(), pipes.size(), static_cast<int>(std::ceil(1000.0 * std::clamp(seconds, 0.0, 3600.0))));
  for (std::size_t i = 0; i < pipes.size(); ++i) {
    if (pipes[i].revents != 0) children[i]->read_output();
  }
}

bool ChildProcess::wait(double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  for (double left = seconds; !ended(); left = std::chrono::duration<double>(end - Clock::now()).count()) {
    listen({this}, left);
    if (left <= 0.0) break;
  }
  return ended();
}

void ChildProcess::signal(int number) const {
  if (!ended()) ::kill(pid_, number);  // kill(-1) would signal every process of the machine
}

void ChildProcess::read_output() {
  std::array<char, 65536> some;
  const ssize_t size = ::read(pipe_.number(), some.data(), some.size());
  if (size > 0) output_.append(some.data(), static_cast<std::size_t>(size));
  if (size == 0) reap();
}

void ChildProcess::reap() {
  pid_t reaped = -1;
  while ((reaped = ::waitpid(pid_, &status_, 0)) < 0 && errno == EINTR) {
  }
  if (reaped < 0) status_ = -1;
  pid_ = -1;
  pipe_.close();
}

}  // namespace palpate
