// SPDX-License-Identifier: MIT
// Files that survive kills: written whole under another name and renamed, or appended line by line; and locks that
// end with their process. The folders may come from somebody else: none follows a link that lies in the place of what
// it writes.
#pragma once

#include "children/child_process.hpp"
#include "reading/reading.hpp"

#include <palpate/error.hpp>

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace palpate {

/// Writes `text` to a temporary file, closes that and renames it to `file`: readers see the old content or the new,
/// never a part, and a link is replaced. With `sync` content and name are on the disk when it returns. Throws Error:
/// then `file` is as it was, unless only the sync of its folder failed.
void write_file(const std::filesystem::path& file, const std::string& text, bool sync = false);

/// A file on its way to its name: made empty beside it, as NAME.<16 random hex digits>.tmp, and locked until it has its
/// name. Removed where it does not get there, and after a kill by whoever next writes in that folder.
class TemporaryFile {
 public:
  /// Throws Error.
  explicit TemporaryFile(const std::filesystem::path& file);
  ~TemporaryFile();

  const std::filesystem::path& path() const { return path_; }
  void write(std::string_view text) const;
  /// Takes the place of `file`, once the file system has taken all that was written. Throws Error.
  void publish(bool sync = false);

 private:
  std::filesystem::path file_;
  std::filesystem::path path_;
  Descriptor descriptor_;
};

/// Removes the temporary files in `folder` whose writers were killed: those that nobody holds locked.
void remove_temporaries(const std::filesystem::path& folder);

/// Puts the names in `folder` on the disk, and the names of the folders on the way to it. Throws Error.
void sync_names(const std::filesystem::path& folder);

/// Whether there is something of that name. What this user may not look at is not there. Throws Error where the file
/// system fails.
bool is_there(const std::filesystem::path& path);
/// The same, and how many bytes it has; none where nothing is there.
std::optional<std::uintmax_t> size_if_there(const char* path);

/// Throws Error where `path`, a part of a record, is a link: what is written would lie where another person chose.
void refuse_link(const std::filesystem::path& path);

/// Makes `folder` if need be, and returns it. Throws Error.
std::filesystem::path make_folder(const std::filesystem::path& folder);

/// The same for a part of a record. Throws Error, where it is a link, too.
std::filesystem::path make_inner_folder(const std::filesystem::path& folder);

/// Returns the whole content of a part of a record. Throws Error for what read_bounded() does not read; of kind `run`
/// where the file system fails.
std::string read_file(const std::filesystem::path& file, std::uintmax_t most_bytes = kMostLogBytes);

/// The same; none where is_there() says that there is none. Files of the user and of the installation may be links.
std::optional<std::string> read_if_there(const std::filesystem::path& file, std::uintmax_t most_bytes = kMostLogBytes,
                                         Origin origin = Origin::record);

/// Reads the first line of a part of a record that grows by lines, without its line end and without what is behind it;
/// none where there is no file or no whole line. Throws Error as read_if_there().
std::optional<std::string> first_line_if_there(const std::filesystem::path& file);

/// The last whole line of a part of a record that grows by lines.
struct LastLine {
  std::uintmax_t bytes = 0;  ///< of the file
  std::uintmax_t whole = 0;  ///< of its whole lines: what lies behind them a kill or a full disk cut off
  std::string text;          ///< of the last one, without its line end; "" where there is none
};

/// Reads it without what is before it; none where there is no file. Throws Error as read_if_there().
std::optional<LastLine> last_line_if_there(const std::filesystem::path& file);

/// A file that only grows, by whole lines.
class AppendFile {
 public:
  AppendFile() = default;
  /// Opens or makes `file`. Throws Error.
  explicit AppendFile(const std::filesystem::path& file);

  /// Appends in one system call; with `sync` it is on the disk when it returns. Throws Error: what was not written
  /// whole is cut off again. Where that fails, and after a sync or a flush that failed, each further call throws the
  /// same Error: the kernel has dropped the data, and a second sync would report success.
  void append(const std::string& text, bool sync);

  /// Keeps the first `bytes`. Throws Error.
  void cut(std::uintmax_t bytes) const;

  /// Has the file system take all that was appended, as closing does: NFS reports a full quota only then. Throws Error.
  void flush();

 private:
  friend class FileLock;
  AppendFile(std::filesystem::path file, Descriptor descriptor);

  std::filesystem::path file_;
  Descriptor descriptor_;
  std::optional<Error> failure_;  ///< after which nothing is appended
};

/// A lock of the kernel on a file: it ends with the process, however that ends, and with the children that were forked
/// from it meanwhile; programs that they start do not inherit it. It holds between machines where their file system
/// keeps locks (NFS does, Lustre when it is mounted with `flock`).
class FileLock {
 public:
  FileLock() = default;
  /// Makes `file` if need be and locks it. Throws Error of kind `busy` if another process holds it.
  explicit FileLock(const std::filesystem::path& file);
  FileLock(FileLock&& other) noexcept { *this = std::move(other); }
  FileLock& operator=(FileLock&& other) noexcept;
  /// Unlocks, unless in a forked child: until the process that took the lock lets go, it stays locked.
  ~FileLock();

  /// Throws Error where another process may hold the lock by now: in a forked child, and where the name in the folder,
  /// wherever that was moved, does not lead to the locked file any more.
  void check() const;

  /// The same, and where the path by which it was locked does not lead there: what is written by path would lie
  /// elsewhere.
  void check_in_place() const;

  /// The locked file, to append to: an open file of its own would not be kept from another's by the lock.
  AppendFile append_file() const;

  /// Makes `file` if need be and waits until it can be locked. Throws Error.
  static FileLock wait_for(const std::filesystem::path& file);

  /// Whether some process holds the lock of `file` now. Asking disturbs nobody who is about to take it. Throws Error
  /// where the file system fails.
  static bool is_held(const std::filesystem::path& file);

 private:
  explicit FileLock(const std::filesystem::path& file, int command);

  std::filesystem::path file_;
  Descriptor descriptor_;
  Descriptor folder_;
  int owner_ = 0;  ///< process id
};

/// Throws Error if the file system of `folder`, which exists, keeps no locks: two processes would do the same work.
void check_locks(const std::filesystem::path& folder);

}  // namespace palpate
