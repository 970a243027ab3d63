// SPDX-License-Identifier: MIT
// Writes files that stay intact if the process is killed: write_file() renames a complete temporary file, and
// AppendFile appends line by line. Also locks files; a lock ends with its process. Another user may have made the
// folders, so the functions do not follow a symbolic link at the path of a file that they write.
#pragma once

#include "children/child_process.hpp"
#include "reading/read_file.hpp"

#include <palpate/error.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace palpate {

/// Writes `text` to a temporary file, closes it and renames it to `file`. Readers see the old or the new content, never
/// a part; if `file` is a link, the link is replaced. With `sync`, the content and the name of the file are on the disk
/// when the function returns. Throws Error; `file` is then unchanged, unless only the sync of its folder failed.
void write_file(const std::filesystem::path& file, const std::string& text, bool sync = false);

/// A locked temporary file that publish() renames to its final name `file`. It is created empty next to `file`, as
/// NAME.<16 random hex digits>.tmp. The destructor deletes it if it was not published. After a kill, the next process
/// that writes in the folder deletes it.
class TemporaryFile {
 public:
  /// Throws Error.
  explicit TemporaryFile(const std::filesystem::path& file);
  ~TemporaryFile();

  const std::filesystem::path& path() const { return path_; }
  void write(std::string_view text) const;
  /// Flushes all that was written, then renames the temporary file to `file`. Throws Error.
  void publish(bool sync = false);

 private:
  std::filesystem::path file_;
  std::filesystem::path path_;
  FileDescriptor descriptor_;
};

/// A new folder of this user among the temporary files of the system (TMPDIR). The destructor removes it.
class ScratchFolder {
 public:
  /// Throws Error.
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Removes those temporary files in `folder` that no process has locked, because the processes that wrote them were
/// killed.
void remove_temporaries(const std::filesystem::path& folder);

/// Syncs the directory entries of `folder`, and of each folder above it, to the disk. Throws Error.
void sync_names(const std::filesystem::path& folder);

/// Returns whether `path` exists and this user may access it. Throws Error if the file system fails.
bool is_there(const std::filesystem::path& path);
/// Returns the size of `path` in bytes; nullopt if is_there() is false.
std::optional<std::uintmax_t> size_if_there(const char* path);

/// Throws Error if `path`, a part of a record, is a link, because another user could have chosen the link's target.
void refuse_link(const std::filesystem::path& path);

/// Makes `folder` if it does not exist, and returns it. Throws Error.
std::filesystem::path make_folder(const std::filesystem::path& folder);

/// Makes `folder`, a part of a record, like make_folder(). Throws Error, for example if `folder` is a link.
std::filesystem::path make_inner_folder(const std::filesystem::path& folder);

/// Returns the content of a file of a record. Throws Error if read_bounded() cannot read it; the Error has kind `run`
/// if the file system fails.
std::string read_file(const std::filesystem::path& file, std::uintmax_t most_bytes = kMostLogBytes);

/// Returns the content of a file; nullopt if is_there() is false. The file may be a link if `origin` is `user`, but not
/// if it is `record`.
std::optional<std::string> read_if_there(const std::filesystem::path& file, std::uintmax_t most_bytes = kMostLogBytes,
                                         FileOrigin origin = FileOrigin::record);

/// Returns the first line, without its line end, of a file that grows by whole lines. Reads only the beginning of the
/// file. Returns nullopt if there is no file or no complete line. Throws Error as read_if_there() does.
std::optional<std::string> first_line_if_there(const std::filesystem::path& file);

/// The last complete line of a file that grows by whole lines.
struct LastLine {
  std::uintmax_t bytes = 0;  ///< size of the file
  /// number of bytes of all complete lines; any further bytes are a line that a kill or a full disk cut off
  std::uintmax_t whole = 0;
  std::string text;  ///< the last complete line, without its line end; "" if there is none
};

/// Returns the last complete line, and reads only the end of the file. Returns nullopt if there is no file. Throws
/// Error as read_if_there() does.
std::optional<LastLine> last_line_if_there(const std::filesystem::path& file);

/// A file that only grows, by complete lines.
class AppendFile {
 public:
  AppendFile() = default;
  /// Opens `file`, or makes it if it does not exist. Throws Error.
  explicit AppendFile(const std::filesystem::path& file);

  /// Appends `text` with one system call. With `sync`, the text is on the disk when the function returns. If the file
  /// cannot be written, removes the part of the text that was written, and throws Error. If this removal, a sync or
  /// flush() fails, all later calls of append() and flush() throw the same Error. The reason is that the kernel has
  /// then dropped the data, and a second sync would report success.
  void append(const std::string& text, bool sync);

  /// Truncates the file to its first `bytes`. Throws Error.
  void cut(std::uintmax_t bytes) const;

  /// Passes all appended data to the file system, as close() does, because NFS reports a full quota only at this point.
  /// Throws Error.
  void flush();

 private:
  friend class FileLock;
  AppendFile(std::filesystem::path file, FileDescriptor descriptor);

  std::filesystem::path file_;
  FileDescriptor descriptor_;
  std::optional<Error> failure_;  ///< error of an earlier call; append() and flush() throw it again
};

/// A lock of the kernel on a file. The destructor releases it. If the destructor does not run, for example after a
/// kill, the lock ends when the process has ended, and all children that it forked while it held the lock. Programs
/// that these processes start do not inherit the lock. The lock also works between machines if their file system has
/// locks (NFS; Lustre mounted with `flock`).
class FileLock {
 public:
  FileLock() = default;
  /// Makes `file` if it does not exist, and locks it. Throws Error of kind `busy` if another process has locked it.
  explicit FileLock(const std::filesystem::path& file);
  FileLock(FileLock&& other) noexcept { *this = std::move(other); }
  FileLock& operator=(FileLock&& other) noexcept;
  /// Releases the lock; in a forked child the file stays locked until the process that took the lock releases it.
  ~FileLock();

  /// Throws Error if another process may hold the lock now: in a forked child, or if the folder no longer contains the
  /// locked file under its name. Moving the folder itself is not an error.
  void check() const;

  /// Throws Error as check() does. Also throws if the path given to the constructor no longer leads to the locked file,
  /// because writing by path would then change other files.
  void check_in_place() const;

  /// Returns the locked file for appending. The lock does not protect a file that is opened separately.
  AppendFile append_file() const;

  /// Makes `file` if it does not exist, and waits until it can lock the file. Throws Error.
  static FileLock wait_for(const std::filesystem::path& file);

  /// Returns whether some process holds the lock of `file` now. This check does not disturb a process that is about to
  /// take the lock. Throws Error if the file system fails.
  static bool is_held(const std::filesystem::path& file);

 private:
  explicit FileLock(const std::filesystem::path& file, int command);

  std::filesystem::path file_;
  FileDescriptor descriptor_;
  FileDescriptor folder_;
  int owner_ = 0;  ///< id of the process that took the lock
};

/// Throws Error if the file system of the existing folder `folder` has no locks, because two processes could then do
/// the same work.
void check_locks(const std::filesystem::path& folder);

}  // namespace palpate
