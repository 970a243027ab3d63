// SPDX-License-Identifier: MIT
// Child processes: programs, and forked processes for work that may crash or hang or that cannot use threads.
//
// Framework and shipped plugins use these functions, which need only the C library. The functions do not throw. If a
// system call fails, they return an empty result and set errno, so that callers can report the failed action. A child
// gets its input at the start. It writes its output to one pipe, which closes when the child ends.
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

/// An open file of this process. Programs that the process starts do not inherit the file.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  /// Takes ownership of `number`; -1 for none.
  explicit FileDescriptor(int number) : number_(number) {}
  FileDescriptor(FileDescriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~FileDescriptor() { close(); }

  explicit operator bool() const { return number_ >= 0; }
  int number() const { return number_; }
  /// Closes the file. Does not change errno.
  void close();

 private:
  int number_ = -1;
};

/// Takes ownership of `number`, the result of open(), and moves it above the numbers of the standard files (0 to 2).
/// open() returns a number from 0 to 2 if this process was started without standard files. A child's standard files
/// would then replace the opened file. Returns an empty FileDescriptor, and keeps errno, if `number` is negative.
FileDescriptor above_standard(int number);

/// Both ends of a pipe, with numbers above the standard files. The flag O_CLOEXEC is set when the pipe is created,
/// because another thread may start a program at any time.
struct Pipe {
  FileDescriptor to_read;
  FileDescriptor to_write;
};
std::optional<Pipe> open_pipe();

/// Writes all of `text`, even if signals interrupt the writing. Returns false and sets errno after an error.
bool write_all(const FileDescriptor& to, std::string_view text);

/// Returns the environment of this process, one "NAME=VALUE" per variable.
std::vector<std::string> own_environment();

struct ProgramCall {
  std::vector<std::string> words;                            ///< name and arguments, not interpreted by a shell
  std::string file{};                                        ///< executable; if empty, the name is searched on PATH
  std::vector<std::string> environment = own_environment();  ///< if a name occurs twice, its first value is used
  /// Whether the program has its own process group. If so, it gets no signals of the terminal, and has the default
  /// signal handling. If not, Ctrl-C ends the program, and it ignores the signals that this process ignores, except
  /// SIGPIPE and SIGXFSZ.
  bool own_group = true;
  std::string folder{};  ///< working folder; if empty, the current one
};

/// Starts a program whose only open files are `files`, with the numbers 0, 1, 2, .... Each number in `files` must be
/// larger than its new number. Returns the process id, or -1 and sets errno; ENOENT means that there is no such
/// program. The caller must wait for the process (waitpid()). Use this function to exchange messages with a running
/// program, and ChildProcess otherwise.
pid_t spawn(const ProgramCall& program, const std::vector<int>& files);

/// Child process whose output is read until its end.
class ChildProcess {
 public:
  /// Writes a text to the parent at once. If the parent has ended, the child ends.
  using Say = std::function<void(std::string_view text)>;

  /// Forks a child that runs `work` and then exits with the return value of `work`, without running destructors of
  /// static objects. `work` may call std::exit(), which runs these destructors. An exception of `work` ends the child
  /// by SIGABRT. The child has its own process group, because this process handles the signals of the terminal. The
  /// child is killed when this process or the calling thread ends. Returns null and sets errno if no process can be
  /// created.
  static std::unique_ptr<ChildProcess> fork(const std::function<int(const Say& say)>& work);

  /// Starts `program` with `input` as its stdin. Its stdout and stderr are the child's output. The program continues if
  /// this process ends. Returns null and sets errno if the program cannot be started.
  static std::unique_ptr<ChildProcess> start(const ProgramCall& program, std::string_view input = {});

  /// Kills the child if it has not ended, and waits for its end.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Waits until one of `children` writes or ends, for up to `seconds` (at most an hour) or until a signal, and reads
  /// the output. Ignores children that have ended.
  static void listen(const std::vector<ChildProcess*>& children, double seconds);

  /// Waits for the end of the child for up to `seconds`; signals do not shorten the wait. Returns whether the child has
  /// ended.
  bool wait(double seconds = std::numeric_limits<double>::infinity());

  bool ended() const { return pid_ < 0; }
  /// Returns all output so far.
  const std::string& said() const { return output_; }
  /// Returns the status of waitpid(); -1 if another caller has reaped the child.
  int status() const { return status_; }

  /// Sends a signal to the child, unless it has ended.
  void signal(int number) const;
  /// Closes the pipe. A forked child inherits the pipes of its siblings and closes them by this function.
  void forget() { pipe_.close(); }

 private:
  ChildProcess() = default;
  void read_output();
  void reap();

  pid_t pid_ = -1;
  FileDescriptor pipe_;  ///< closed after the end
  int status_ = 0;
  std::string output_;
};

}  // namespace palpate
