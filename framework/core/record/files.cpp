// SPDX-License-Identifier: MIT
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& file, const char* action) {
  throw Error(file.string(), std::string(action) + ": " + std::strerror(errno), {}, Error::Kind::run);
}

/// Opens what is to be written, but no link: whoever made that would choose what is overwritten.
Descriptor open_to_write(const fs::path& file, int flags) {
  Descriptor opened(::open(file.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, 0666));
  if (opened) return opened;
  if (errno == ELOOP) refuse_link(file);
  fail(file, "cannot be opened");
}

/// A lock of the open file and not of the process: another one of the same process is refused, too, and a lock can be
/// asked after without taking it.
const struct flock kWholeFile { F_WRLCK, SEEK_SET, 0, 0, 0 };

Descriptor open_lock(const fs::path& file) { return open_to_write(file, O_RDWR | O_CREAT); }

constexpr const char* kTemporary = ".tmp";

}  // namespace

Neighbour::Neighbour(const fs::path& file) : file_(file) {
  std::uint64_t unforeseen = 0;
  if (::getrandom(&unforeseen, sizeof unforeseen, 0) != sizeof unforeseen) fail(file, "no random name for it");
  path_ = file.string() + fmt::format(".{:016x}{}", unforeseen, kTemporary);
  descriptor_ = Descriptor(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
  if (!descriptor_) fail(file, "cannot be made");
}

Neighbour::~Neighbour() {
  if (!path_.empty()) ::unlink(path_.c_str());
}

void Neighbour::rename() {
  if (::rename(path_.c_str(), file_.c_str()) != 0) fail(file_, "cannot be renamed to");
  path_.clear();
}

void write_file(const fs::path& file, const std::string& text, bool sync) {
  write_file(
      file, [&](const TextOut& out) { out(text); }, sync);
}

void write_file(const fs::path& file, const Text& text, bool sync) {
  Neighbour neighbour(file);
  text([&](std::string_view piece) {
    if (!write_all(neighbour.descriptor(), piece)) fail(file, "cannot be written");
  });
  if (sync && ::fsync(neighbour.descriptor().number()) != 0) fail(file, "cannot be synced");
  neighbour.rename();
  if (sync) {
    const Descriptor folder{::open(file.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
    if (folder) ::fsync(folder.number());
  }
}

void remove_neighbours(const fs::path& folder, std::initializer_list<const char*> names) {
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    const fs::path& file = entry.path();
    if (file.extension() != kTemporary) continue;
    const auto of = [&](const char* name) { return file.stem().stem() == name; };
    if (names.size() == 0 || std::any_of(names.begin(), names.end(), of)) fs::remove(file, none);
  }
}

void cut_file(const fs::path& file, std::uintmax_t bytes) {
  const Descriptor out = open_to_write(file, O_WRONLY);
  if (::ftruncate(out.number(), static_cast<off_t>(bytes)) != 0) fail(file, "cannot be cut");
}

bool is_there(const fs::path& path) {
  std::error_code none;
  return fs::exists(path, none);
}

void refuse_link(const fs::path& path) {
  std::error_code none;
  if (!fs::is_symlink(path, none)) return;
  throw Error(path.string(), "is a link, and nothing is written through one", "remove it", Error::Kind::run);
}

fs::path make_folder(const fs::path& folder) {
  std::error_code trouble;
  fs::create_directories(folder, trouble);
  if (trouble) throw Error(folder.string(), "cannot be made: " + trouble.message(), {}, Error::Kind::run);
  return folder;
}

fs::path make_inner_folder(const fs::path& folder) {
  refuse_link(folder);
  return make_folder(folder);
}

std::string read_file(const fs::path& file, std::uintmax_t most_bytes) {
  std::optional<std::string> text = read_if_there(file, most_bytes);
  if (!text) throw Error(file.string(), "cannot be read");
  return std::move(*text);
}

std::optional<std::string> read_if_there(const fs::path& file, std::uintmax_t most_bytes) {
  const auto refuse = [&] { throw Error(file.string(), "cannot be read"); };
  const Descriptor in{::open(file.c_str(), O_RDONLY | O_CLOEXEC)};
  if (!in && (errno == ENOENT || !is_there(file))) return std::nullopt;
  struct stat what {};
  if (!in || ::fstat(in.number(), &what) != 0) refuse();
  const auto bytes = static_cast<std::uintmax_t>(what.st_size);
  if (bytes > most_bytes)
    throw Error(file.string(), "is too large for what it should hold", "the file is damaged: put it back as it was");
  // One more byte than a file has shows its end; of a pipe nothing is known before.
  std::string text(bytes + 1, '\0');
  for (std::size_t read = 0;;) {
    const ssize_t more = ::read(in.number(), text.data() + read, text.size() - read);
    if (more < 0 && errno == EINTR) continue;
    if (more < 0) refuse();  // a folder can be opened, too
    read += static_cast<std::size_t>(more);
    if (more == 0) return text.resize(read), text;
    if (read == text.size()) text.resize(2 * text.size() + 4096);
  }
}

AppendFile::AppendFile(const fs::path& file)
    : file_(file), descriptor_(open_to_write(file, O_WRONLY | O_CREAT | O_APPEND)) {
  struct stat open {};
  if (::fstat(descriptor_.number(), &open) != 0) fail(file, "cannot be opened");
  device_ = open.st_dev;
  inode_ = open.st_ino;
}

void AppendFile::append(const std::string& text, bool sync) {
  if (!write_all(descriptor_, text)) fail(file_, "cannot be written");
  if (sync && ::fdatasync(descriptor_.number()) != 0) fail(file_, "cannot be synced");
}

bool AppendFile::is_in_place() const {
  struct stat named {};
  return ::stat(file_.c_str(), &named) == 0 && named.st_dev == device_ && named.st_ino == inode_;
}

FileLock::FileLock(const fs::path& file) : descriptor_(open_lock(file)) {
  if (::fcntl(descriptor_.number(), F_OFD_SETLK, &kWholeFile) == 0) return;
  if (errno == EAGAIN || errno == EACCES) {
    throw Error(file.parent_path().string(), "another process holds this run", "wait for it, or stop it",
                Error::Kind::busy);
  }
  fail(file, "cannot be locked");
}

FileLock FileLock::wait_for(const fs::path& file) {
  FileLock lock;
  lock.descriptor_ = open_lock(file);
  while (::fcntl(lock.descriptor_.number(), F_OFD_SETLKW, &kWholeFile) != 0) {
    if (errno != EINTR) fail(file, "cannot be locked");
  }
  return lock;
}

bool FileLock::is_held(const fs::path& file) {
  const Descriptor in{::open(file.c_str(), O_RDONLY | O_CLOEXEC)};
  struct flock other = kWholeFile;
  return in && ::fcntl(in.number(), F_OFD_GETLK, &other) == 0 && other.l_type != F_UNLCK;
}

void check_locks(const fs::path& folder) {
  const fs::path file = folder / "lock";
  const FileLock first = FileLock::wait_for(file);
  if (FileLock::is_held(file)) return;
  throw Error(folder.string(), "its file system keeps no locks: two processes could do the same work",
              "put --runs on another one; Lustre keeps them when mounted with 'flock'");
}

}  // namespace palpate
