// SPDX-License-Identifier: MIT
// Files that survive kills: written whole under another name and renamed, or appended line by line; and locks that
// end with their process.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// Writes `text` to a temporary neighbour and renames it to `file`: readers see the old content or the new, never a
/// part. With `sync` content and name are on the disk when it returns. Throws Error.
void write_file(const std::filesystem::path& file, const std::string& text, bool sync = false);

/// The whole content. Throws Error.
std::string read_file(const std::filesystem::path& file);

/// A file that only grows.
class AppendFile {
 public:
  AppendFile() = default;
  /// Opens or makes `file`. Throws Error.
  explicit AppendFile(const std::filesystem::path& file);
  ~AppendFile();
  AppendFile(AppendFile&& other) noexcept;
  AppendFile& operator=(AppendFile&& other) noexcept;

  /// Appends in one system call; with `sync` it is on the disk when it returns. Throws Error.
  void append(const std::string& text, bool sync);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// A lock of the kernel on a file: it ends when the process does, however it ends, and children do not inherit it. It
/// holds between machines where their file system keeps locks (NFS does, Lustre when it is mounted with `flock`).
class FileLock {
 public:
  FileLock() = default;
  /// Makes `file` if need be and locks it. Throws Error of kind `busy` if another process holds it.
  explicit FileLock(const std::filesystem::path& file);
  ~FileLock();
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;

  /// Makes `file` if need be and waits until it can be locked. Throws Error.
  static FileLock wait_for(const std::filesystem::path& file);

  /// Whether some process holds the lock of `file` now. Asking disturbs nobody who is about to take it.
  static bool is_held(const std::filesystem::path& file);

 private:
  int descriptor_ = -1;
};

/// Throws Error if the file system of `folder`, which exists, keeps no locks: two processes would do the same work.
void check_locks(const std::filesystem::path& folder);

}  // namespace palpate
