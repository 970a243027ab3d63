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

/// A lock of the kernel on a file: it ends when the process does, however it ends, and children do not inherit it.
class FileLock {
 public:
  FileLock() = default;
  /// Makes `file` if need be and locks it. Throws Error of kind `busy` if another process holds it.
  explicit FileLock(const std::filesystem::path& file);
  ~FileLock();
  FileLock(FileLock&& other) noexcept;
  FileLock& operator=(FileLock&& other) noexcept;

  /// Whether some process holds the lock of `file` now.
  static bool is_held(const std::filesystem::path& file);

 private:
  int descriptor_ = -1;
};

}  // namespace palpate
