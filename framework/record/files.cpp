// SPDX-License-Identifier: MIT
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& file, const char* action) {
  throw Error(file.string(), std::string(action) + ": " + std::strerror(errno), {}, Error::Kind::run);
}

void write_all(int descriptor, const std::string& text, const fs::path& file) {
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(descriptor, text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(file, "cannot be written");
    done += static_cast<std::size_t>(count);
  }
}

/// A lock of the open file and not of the process: another one of the same process is refused, too, and a lock can be
/// asked after without taking it.
const struct flock kWholeFile { F_WRLCK, SEEK_SET, 0, 0, 0 };

int open_lock(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor < 0) fail(file, "cannot be opened");
  return descriptor;
}

/// Closes on leaving, errors on the way included.
struct Descriptor {
  int value;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

}  // namespace

void write_file(const fs::path& file, const std::string& text, bool sync) {
  const fs::path temporary = file.string() + ".tmp";
  {
    const Descriptor out{::open(temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
    if (out.value < 0) fail(temporary, "cannot be made");
    write_all(out.value, text, temporary);
    if (sync && ::fsync(out.value) != 0) fail(temporary, "cannot be synced");
  }
  if (::rename(temporary.c_str(), file.c_str()) != 0) fail(file, "cannot be renamed to");
  if (sync) {
    const Descriptor folder{::open(file.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (folder.value >= 0) ::fsync(folder.value);
  }
}

std::string read_file(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  // A directory can be opened, too, and only reading it fails.
  std::error_code none;
  if (!in || fs::is_directory(file, none)) throw Error(file.string(), "cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

AppendFile::AppendFile(const fs::path& file)
    : file_(file), descriptor_(::open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) fail(file, "cannot be opened");
}

AppendFile::~AppendFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

AppendFile::AppendFile(AppendFile&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

AppendFile& AppendFile::operator=(AppendFile&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

void AppendFile::append(const std::string& text, bool sync) {
  write_all(descriptor_, text, file_);
  if (sync && ::fdatasync(descriptor_) != 0) fail(file_, "cannot be synced");
}

FileLock::FileLock(const fs::path& file) : descriptor_(open_lock(file)) {
  if (::fcntl(descriptor_, F_OFD_SETLK, &kWholeFile) == 0) return;
  const int why = errno;
  ::close(std::exchange(descriptor_, -1));
  if (why == EAGAIN || why == EACCES) {
    throw Error(file.parent_path().string(), "another process holds this run", "wait for it, or stop it",
                Error::Kind::busy);
  }
  errno = why;
  fail(file, "cannot be locked");
}

FileLock FileLock::wait_for(const fs::path& file) {
  FileLock lock;
  lock.descriptor_ = open_lock(file);
  while (::fcntl(lock.descriptor_, F_OFD_SETLKW, &kWholeFile) != 0) {
    if (errno != EINTR) fail(file, "cannot be locked");
  }
  return lock;
}

FileLock::~FileLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

FileLock::FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

bool FileLock::is_held(const fs::path& file) {
  const Descriptor in{::open(file.c_str(), O_RDONLY | O_CLOEXEC)};
  struct flock other = kWholeFile;
  return in.value >= 0 && ::fcntl(in.value, F_OFD_GETLK, &other) == 0 && other.l_type != F_UNLCK;
}

void check_locks(const fs::path& folder) {
  const fs::path file = folder / "lock";
  const FileLock first = FileLock::wait_for(file);
  if (FileLock::is_held(file)) return;
  throw Error(folder.string(), "its file system keeps no locks: two processes could do the same work",
              "put --runs on another one; Lustre keeps them when mounted with 'flock'");
}

}  // namespace palpate
