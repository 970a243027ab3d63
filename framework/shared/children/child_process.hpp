// SPDX-License-Identifier: MIT
// Child processes, the one room for them: programs that are started, and work that is forked from this process because
// it may crash, hang, or run beside other work that plugins cannot bear in threads.
//
// Framework and shipped plugins both use it, and it uses nothing but the C library. No exception leaves it: where the
// system refuses, nothing is returned and errno says why, so that each caller says in its own words what could not be
// done. A child hears its parent by what it was begun with, and is heard through one pipe, whose end is the child's.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace palpate {

/// An open file of this process, closed in programs that it starts.
class Descriptor {
 public:
  Descriptor() = default;
  /// Takes over `number`; -1 stands for none.
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { close(); }

  explicit operator bool() const { return number_ >= 0; }
  int number() const { return number_; }
  /// Leaves errno alone.
  void close();

 private:
  int number_ = -1;
};

/// Takes over `number`, what opening a file gave, under one above the standard ones even where this process was started
/// without them: a child gets its own standard files first, and they must not hit what it gets after them. None, with
/// errno, where `number` is negative.
Descriptor above_standard(int number);

/// Both ends are above the standard files, and closed in programs from the first moment on: other threads start some.
struct Pipe {
  Descriptor to_read;
  Descriptor to_write;
};
std::optional<Pipe> open_pipe();

/// Writes all of `text`, through signals. False, with errno, where that fails.
bool write_all(const Descriptor& to, std::string_view text);

/// "NAME=VALUE" of this process, one each.
std::vector<std::string> own_environment();

struct Program {
  std::vector<std::string> words;  ///< its name and its arguments; no shell sees them
  std::string file{};              ///< what is run; if empty, the name, which is looked for on PATH
  std::vector<std::string> environment = own_environment();  ///< of one name the first counts
  /// In a process group of its own it hears none of the terminal's signals, and takes all others as a fresh program
  /// does; else it ends at Ctrl-C as this process does, and ignores what this one ignores but SIGPIPE and SIGXFSZ.
  bool own_group = true;
  std::string folder{};  ///< in which it begins; if empty, the current one
};

/// Starts a program that has `files` open under the numbers 0, 1, 2 ..., and no other file, whatever this process has
/// open. All of `files` are above the numbers that they get. Returns its process id, which the caller is to wait for,
/// or -1 with errno: ENOENT where there is no such program. For who talks with a program; others use ChildProcess.
pid_t spawn(const Program& program, const std::vector<int>& files);

/// A child of this process that needs no more than to be heard and awaited.
class ChildProcess {
 public:
  /// Says something to the parent, at once; where that is gone, the child ends.
  using Say = std::function<void(std::string_view text)>;

  /// Forks: the child does `work` and ends with the exit status that it returns, and takes nothing down (it may call
  /// std::exit() instead, which does). What is thrown there is a crash of the child, signal SIGABRT. It is in a process
  /// group of its own, as this process hears what the terminal says, and is killed when this process, or the thread
  /// that calls, is gone. Null, with errno, where there is no process to be had.
  static std::unique_ptr<ChildProcess> fork(const std::function<int(const Say& say)>& work);

  /// Starts `program`, which reads `input`. What it writes to stdout and stderr is heard as it comes. It does not die
  /// with this process. Null, with errno, as with spawn().
  static std::unique_ptr<ChildProcess> start(const Program& program, std::string_view input = {});

  /// Kills it if it still is there. Afterwards it is reaped.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits until one of `children` says something or ends, for up to `seconds` (at most an hour) and not beyond a
  /// signal, and takes in what that is. Those that have ended are passed over.
  static void listen(const std::vector<ChildProcess*>& children, double seconds);

  /// Waits for its end for up to `seconds`, through signals. Returns whether it has ended.
  bool wait(double seconds = std::numeric_limits<double>::infinity());

  bool ended() const { return pid_ < 0; }
  /// All that it has said so far.
  const std::string& said() const { return said_; }
  /// How it ended, as waitpid() tells; -1 if somebody else has reaped it.
  int status() const { return status_; }

  /// Sends it a signal, unless it has ended.
  void signal(int number) const;
  /// Closes its pipe. For a forked child, whose siblings are none of its own and yet would count among its open files.
  void forget() { pipe_.close(); }

 private:
  ChildProcess() = default;
  void hear();
  void reap();

  pid_t pid_ = -1;
  Descriptor pipe_;  ///< none once it has ended
  int status_ = 0;
  std::string said_;
};

}  // namespace palpate
