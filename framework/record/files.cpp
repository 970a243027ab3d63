// SPDX-License-Identifier: MIT
#include "record/files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>

#include <fcntl.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

Error failed(const fs::path& file, const char* action) {
  return Error(file.string(), std::string(action) + ": " + std::strerror(errno), {}, Error::Kind::run);
}

[[noreturn]] void fail(const fs::path& file, const char* action) { throw failed(file, action); }

/// Opens a file with a descriptor above those of the standard streams. Otherwise, if the process was started without
/// these streams, the file would become one of them.
FileDescriptor open_file(const fs::path& file, int flags) {
  // If the path is a pipe, O_NONBLOCK avoids waiting for the process at its other end.
  return above_standard(::open(file.c_str(), flags | O_CLOEXEC | O_NONBLOCK | O_NOCTTY, 0666));
}

/// Opens a file for writing. Fails if the path is a link, because the author of the link could choose which file is
/// overwritten.
FileDescriptor open_to_write(const fs::path& file, int flags) {
  FileDescriptor opened = open_file(file, flags | O_NOFOLLOW);
  if (opened) return opened;
  if (errno == ELOOP) refuse_link(file);
  fail(file, "cannot be opened");
}

/// Argument of fcntl() for a lock that belongs to the open file and not to the process, so a second lock in the same
/// process fails, too. A process can test for such a lock without taking it.
const struct flock kWholeFile { F_WRLCK, SEEK_SET, 0, 0, 0 };

FileDescriptor open_lock(const fs::path& file) { return open_to_write(file, O_RDWR | O_CREAT | O_APPEND); }

/// Duplicates the descriptor and closes the copy. At each close, Linux passes all written data to the file system. The
/// original descriptor keeps its lock.
bool flush_file(const FileDescriptor& file) {
  const int copy = ::fcntl(file.number(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  return copy >= 0 && ::close(copy) == 0;
}

void sync_folder(const fs::path& folder) {
  const FileDescriptor opened = open_file(folder, O_RDONLY | O_DIRECTORY);
  if (!opened && errno == EACCES) return;  // the folder of another user, which this process did not make
  // These errors are ignored: the file system cannot sync folders (EINVAL) or is read-only (EROFS).
  const auto needs_none = [] { return errno == EINVAL || errno == EROFS; };
  if (!opened || (::fsync(opened.number()) != 0 && !needs_none())) fail(folder, "cannot be synced");
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

constexpr std::string_view kTemporary = ".tmp";
constexpr std::size_t kDigits = 16;
constexpr int kTrials = 100;  ///< random names to try; the first one is almost always free

bool is_temporary(const std::string& name) {
  const std::size_t end = name.size() - std::min(name.size(), kTemporary.size());
  if (end <= kDigits || name.compare(end, kTemporary.size(), kTemporary) != 0) return false;
  return name[end - kDigits - 1] == '.' && name.find_first_not_of("0123456789abcdef", end - kDigits) == end;
}

/// Removes the temporary files in `folder` the first time that this process writes there.
void remove_temporaries_once(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<std::string> seen;
  {
    const std::lock_guard<std::mutex> guard(mutex);
    if (!seen.insert(folder.native()).second) return;
  }
  remove_temporaries(folder);
}

/// Returns whether the errno `reason` means that the path does not exist or that this user may not access it.
bool shows_nothing(int reason) {
  return reason == ENOENT || reason == ENOTDIR || reason == EACCES || reason == ELOOP || reason == ENAMETOOLONG;
}

std::optional<std::string> text_in(FileReading reading, const fs::path& file, std::uintmax_t most_bytes) {
  if (reading) return std::move(reading.text);
  const int reason = reading.reason.value();
  if (reading.kind == FileReading::Kind::absent && reason == ENOENT) return std::nullopt;
  // Other errors, such as too few descriptors or too little memory, do not mean that the file is missing.
  const bool fails = reason != 0 && !shows_nothing(reason);
  if (reason != 0 && !fails && !is_there(file)) return std::nullopt;
  const auto [words, remedy] = words_of(reading, most_bytes);
  throw Error(file.string(), words, remedy, fails ? Error::Kind::run : Error::Kind::usage);
}

/// Returns the position of the last line end in `text`.
std::size_t last_line_end(std::string_view text) {
  const void* const found = ::memrchr(text.data(), '\n', text.size());
  return found == nullptr ? std::string_view::npos : static_cast<const char*>(found) - text.data();
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& file) : file_(file) {
  remove_temporaries_once(folder_of(file));
  for (int trial = 0; trial < kTrials; ++trial) {
    std::uint64_t unforeseen = 0;
    if (::getrandom(&unforeseen, sizeof unforeseen, 0) != sizeof unforeseen)
      fail(file, "cannot get a random name for a temporary file");
    const fs::path path = file.string() + fmt::format(".{:016x}{}", unforeseen, kTemporary);
    descriptor_ = open_file(path, O_RDWR | O_CREAT | O_EXCL);
    if (!descriptor_ && errno == EEXIST) continue;
    if (!descriptor_) fail(file, "cannot be made");
    path_ = path;
    // Another process may have removed the temporary file before it was locked. If the file system has no locks, no
    // process removes the file.
    const bool taken = ::fcntl(descriptor_.number(), F_OFD_SETLK, &kWholeFile) != 0 && errno == EAGAIN;
    struct stat what {};
    if (!taken && ::fstat(descriptor_.number(), &what) != 0) fail(file, "cannot be made");
    if (!taken && what.st_nlink > 0) return;
    ::unlink(path.c_str());
  }
  throw Error(file.string(), "temporary files beside it disappear", "put --runs on another file system",
              Error::Kind::run);
}

TemporaryFile::~TemporaryFile() {
  if (!path_.empty()) ::unlink(path_.c_str());
}

void TemporaryFile::write(std::string_view text) const {
  if (!write_all(descriptor_, text)) fail(file_, "cannot be written");
}

void TemporaryFile::publish(bool sync) {
  if (sync && ::fsync(descriptor_.number()) != 0) fail(file_, "cannot be synced");
  if (!flush_file(descriptor_)) fail(file_, "cannot be written");
  if (::rename(path_.c_str(), file_.c_str()) != 0) {
    const int reason = errno;
    // If the reply of an NFS server is lost, the client repeats the request, which then fails because the old name is
    // gone.
    struct stat own {
    }, named{};
    const bool renamed = reason == ENOENT && ::fstat(descriptor_.number(), &own) == 0 &&
                         ::lstat(file_.c_str(), &named) == 0 && own.st_dev == named.st_dev &&
                         own.st_ino == named.st_ino;
    errno = reason;
    if (!renamed) fail(file_, "cannot be renamed to");
  }
  path_.clear();
  if (sync) sync_folder(folder_of(file_));
}

void write_file(const fs::path& file, const std::string& text, bool sync) {
  TemporaryFile temporary(file);
  temporary.write(text);
  temporary.publish(sync);
}

ScratchFolder::ScratchFolder() {
  std::error_code none;
  std::string name = (fs::temp_directory_path(none) / "palpate-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr)
    throw Error(name, std::string("cannot be made: ") + std::strerror(errno), "set TMPDIR to another folder",
                Error::Kind::run);
  path_ = name;
}

ScratchFolder::~ScratchFolder() {
  std::error_code none;
  fs::remove_all(path_, none);
}

void remove_temporaries(const fs::path& folder) {
  std::error_code none;
  for (const fs::path& file : list_folder(folder)) {
    if (!is_temporary(file.filename().string())) continue;
    const FileDescriptor left = open_file(file, O_RDWR | O_NOFOLLOW);
    if (left && ::fcntl(left.number(), F_OFD_SETLK, &kWholeFile) == 0) fs::remove(file, none);
  }
}

void sync_names(const fs::path& folder) {
  for (fs::path at = fs::absolute(folder); at != at.root_path(); at = at.parent_path()) sync_folder(at);
}

bool is_there(const fs::path& path) { return size_if_there(path.c_str()).has_value(); }

std::optional<std::uintmax_t> size_if_there(const char* path) {
  struct stat what {};
  if (::stat(path, &what) == 0) return static_cast<std::uintmax_t>(what.st_size);
  if (shows_nothing(errno)) return std::nullopt;
  fail(path, "cannot be accessed");
}

void refuse_link(const fs::path& path) {
  std::error_code none;
  if (!fs::is_symlink(path, none)) return;
  throw Error(path.string(), "is a symbolic link, and links in a record are not followed", "remove it",
              Error::Kind::run);
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

std::optional<std::string> read_if_there(const fs::path& file, std::uintmax_t most_bytes, FileOrigin origin) {
  return text_in(read_bounded(file, most_bytes, origin), file, most_bytes);
}

std::optional<std::string> first_line_if_there(const fs::path& file) {
  // 16 KiB hold the manifest of nearly every record.
  for (std::uintmax_t bytes = 16384;; bytes *= 16) {
    auto begin = text_in(read_begin_bounded(file, bytes, FileOrigin::record), file, kMostLogBytes);
    if (!begin) return std::nullopt;
    const std::size_t end = begin->find('\n');
    if (end != std::string::npos) return begin->erase(end), begin;
    if (begin->size() < bytes) return std::nullopt;
  }
}

std::optional<LastLine> last_line_if_there(const fs::path& file) {
  // 4 KiB hold the last line of nearly every record.
  for (std::uintmax_t bytes = 4096;; bytes *= 16) {
    FileReading reading = read_end_bounded(file, bytes, FileOrigin::record);
    const std::uintmax_t skipped = reading.begin;
    const auto end = text_in(std::move(reading), file, kMostLogBytes);
    if (!end) return std::nullopt;
    const std::size_t last = last_line_end(*end);
    const std::size_t before = last == std::string::npos ? last : last_line_end(std::string_view(*end).substr(0, last));
    if (skipped > 0 && before == std::string::npos) continue;
    LastLine out;
    out.bytes = skipped + end->size();
    if (last == std::string::npos) return out;
    out.whole = skipped + last + 1;
    const std::size_t begin = before == std::string::npos ? 0 : before + 1;
    out.text = end->substr(begin, last - begin);
    return out;
  }
}

AppendFile::AppendFile(const fs::path& file) : AppendFile(file, open_to_write(file, O_WRONLY | O_CREAT | O_APPEND)) {}

AppendFile::AppendFile(fs::path file, FileDescriptor descriptor)
    : file_(std::move(file)), descriptor_(std::move(descriptor)) {}

void AppendFile::append(const std::string& text, bool sync) {
  if (failure_) throw Error(*failure_);
  struct stat before {};
  if (::fstat(descriptor_.number(), &before) != 0) fail(file_, "cannot be written");
  if (!write_all(descriptor_, text)) {
    const Error trouble = failed(file_, "cannot be written");
    if (::ftruncate(descriptor_.number(), before.st_size) != 0) failure_ = trouble;
    throw Error(trouble);
  }
  if (!sync || ::fdatasync(descriptor_.number()) == 0) return;
  failure_ = failed(file_, "its last line may not be on the disk, because it cannot be synced");
  throw Error(*failure_);
}

void AppendFile::cut(std::uintmax_t bytes) const {
  if (::ftruncate(descriptor_.number(), static_cast<off_t>(bytes)) != 0) fail(file_, "cannot be cut");
}

void AppendFile::flush() {
  if (failure_) throw Error(*failure_);
  if (flush_file(descriptor_)) return;
  failure_ = failed(file_, "its last lines may not be in the file, because it cannot be closed");
  throw Error(*failure_);
}

FileLock::FileLock(const fs::path& file, int command)
    : file_(file), descriptor_(open_lock(file)), folder_(open_file(folder_of(file), O_PATH | O_DIRECTORY)) {
  if (!folder_) fail(folder_of(file), "cannot be opened");
  owner_ = ::getpid();
  while (::fcntl(descriptor_.number(), command, &kWholeFile) != 0) {
    if (errno == EINTR) continue;
    const bool busy = command == F_OFD_SETLK && (errno == EAGAIN || errno == EACCES);
    if (!busy) fail(file, "cannot be locked");
    throw Error(file.parent_path().string(), "another process holds this run", "wait for it, or stop it",
                Error::Kind::busy);
  }
}

FileLock::FileLock(const fs::path& file) : FileLock(file, F_OFD_SETLK) {}

FileLock FileLock::wait_for(const fs::path& file) { return FileLock(file, F_OFD_SETLKW); }

FileLock& FileLock::operator=(FileLock&& other) noexcept {
  file_.swap(other.file_);
  descriptor_ = std::move(other.descriptor_);  // swaps the descriptors
  folder_ = std::move(other.folder_);
  std::swap(owner_, other.owner_);
  return *this;
}

FileLock::~FileLock() {
  if (!descriptor_ || owner_ != ::getpid()) return;
  struct flock whole = kWholeFile;
  whole.l_type = F_UNLCK;
  ::fcntl(descriptor_.number(), F_OFD_SETLK, &whole);
}

void FileLock::check() const {
  if (owner_ != ::getpid())
    throw Error(file_.parent_path().string(), "is held by the parent of this forked process",
                "open it in the child after the parent has closed it", Error::Kind::run);
  struct stat held {
  }, named{};
  if (::fstat(descriptor_.number(), &held) != 0) fail(file_, "cannot be accessed");
  const int there = ::fstatat(folder_.number(), file_.filename().c_str(), &named, AT_SYMLINK_NOFOLLOW);
  if (there == 0 && held.st_dev == named.st_dev && held.st_ino == named.st_ino) return;
  if (there != 0 && errno != ENOENT) fail(file_, "cannot be accessed");
  throw Error(file_.string(),
              "was moved or removed while a run was writing to it: another process may start the same run",
              "move it back, then run 'palpate resume'", Error::Kind::run);
}

void FileLock::check_in_place() const {
  check();
  struct stat held {
  }, named{};
  if (::fstat(descriptor_.number(), &held) == 0 && ::stat(file_.c_str(), &named) == 0 && held.st_dev == named.st_dev &&
      held.st_ino == named.st_ino)
    return;
  throw Error(folder_of(file_).string(), "was moved or removed while a run was writing there",
              "run 'palpate resume' on its new path", Error::Kind::run);
}

AppendFile FileLock::append_file() const {
  FileDescriptor copy(::fcntl(descriptor_.number(), F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
  if (!copy) fail(file_, "cannot be opened");
  return {file_, std::move(copy)};
}

bool FileLock::is_held(const fs::path& file) {
  // Only regular files are locked, and opening a device may have side effects.
  struct stat what {};
  if (::lstat(file.c_str(), &what) != 0 && !shows_nothing(errno)) fail(file, "cannot be accessed");
  if (!S_ISREG(what.st_mode)) return false;
  const FileDescriptor in = open_file(file, O_RDONLY | O_NOFOLLOW);
  if (!in && shows_nothing(errno)) return false;
  struct flock other = kWholeFile;
  if (in && ::fcntl(in.number(), F_OFD_GETLK, &other) == 0) return other.l_type != F_UNLCK;
  // If the file system has no locks, no process holds a lock.
  const bool keeps_none = in && (errno == ENOLCK || errno == ENOSYS || errno == EINVAL || errno == EOPNOTSUPP);
  if (!keeps_none) fail(file, "cannot be accessed");
  return false;
}

void check_locks(const fs::path& folder) {
  const fs::path file = folder / "lock";
  const FileLock first = FileLock::wait_for(file);
  if (FileLock::is_held(file)) return;
  throw Error(folder.string(), "its file system has no file locks, so two processes could do the same work",
              "put --runs on another file system; Lustre has locks when mounted with 'flock'");
}

}  // namespace palpate
