// SPDX-License-Identifier: MIT
#include "programs/record_files.hpp"

#include "reading/read_file.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <fmt/printf.h>

namespace palpate::programs {
namespace {

constexpr const char* kNote = "\n[here %15lld bytes are left out]\n";

std::string note_of(long long bytes) { return fmt::sprintf(kNote, bytes); }

const auto kNoteLength = static_cast<off_t>(note_of(0).size());

FileDescriptor open_recorded(const std::string& file, int flags) {
  const int number = ::open(file.c_str(), flags | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (number < 0 && errno == ELOOP)
    throw Error(file, "is a symbolic link, and links in a record are not followed", "remove it", Error::Kind::run);
  FileDescriptor out = above_standard(number);
  if (!out) fail("command", "cannot open a pipe or file");
  return out;
}

}  // namespace

void fail(const std::string& where, const std::string& what) {
  throw Error(where, what + ": " + std::strerror(errno), {}, Error::Kind::run);
}

void keep_copy(const std::string& file, const std::string& text) {
  if (!write_all(open_recorded(file, O_WRONLY | O_TRUNC), text)) fail(file, "cannot be written");
}

// With an empty name, the object behaves like an empty file, which has nothing to remove.
StderrLog::StderrLog(const std::string& file)
    : file_(open_recorded(file.empty() ? "/dev/null" : file, O_RDWR | O_APPEND)) {
  begin_ = size();
  const std::string note = read(kFirst, kFirst + kNoteLength);
  long long before = 0;
  if (std::sscanf(note.c_str(), kNote, &before) == 1 && note == note_of(before)) left_out_ = before;
}

void StderrLog::trim() {
  const off_t end = size();
  const off_t noted = kFirst + (left_out_ > 0 ? kNoteLength : 0);
  if (end <= noted + 2 * kLast) return;
  const std::string last = read(end - kLast, end);
  left_out_ += end - kLast - noted;
  // Output that arrives during this call is lost, or appears before the note.
  left_out_ += std::max<off_t>(0, size() - end);
  if (::ftruncate(file_.number(), kFirst) != 0) return;
  write_all(file_, note_of(left_out_) + last);  // If the disk is full, only output of the program is lost.
  begin_ = std::min(begin_, kFirst);
}

std::string StderrLog::last_words() const {
  constexpr off_t kEnough = 1024;
  const off_t end = size();
  std::string text = read(std::max(begin_, end - kEnough), end);
  text.erase(text.find_last_not_of(" \r\n") + 1);
  return text.substr(text.find_last_of('\n') + 1);
}

off_t StderrLog::size() const { return ::lseek(file_.number(), 0, SEEK_END); }

std::string StderrLog::read(off_t begin, off_t end) const {
  std::string out(static_cast<std::size_t>(std::max<off_t>(0, end - begin)), '\0');
  const ssize_t got = ::pread(file_.number(), out.data(), out.size(), begin);
  out.resize(static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
  return out;
}

FileDescriptor lock_file(const std::string& file, const WaitLimit& limit) {
  FileDescriptor lock = open_recorded(file, O_RDWR);
  // The lock is requested repeatedly, because a blocking wait could not be interrupted.
  while (::flock(lock.number(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) fail(file, "cannot be locked");
    if (limit.stopped() || std::chrono::steady_clock::now() >= limit.until) return {};
    std::this_thread::sleep_for(kPollInterval);
  }
  return lock;
}

void write_holder(const FileDescriptor& lock, pid_t holder) {
  // If this fails, a later message lacks the process id, and nothing else is affected.
  if (::ftruncate(lock.number(), 0) == 0) write_all(lock, std::to_string(holder) + '\n');
}

std::string read_holder(const std::string& file) {
  constexpr std::uintmax_t kMostBytes = 64;
  const std::string text = read_bounded(file, kMostBytes, FileOrigin::record).text;
  const std::string holder = text.substr(0, text.find('\n'));
  return holder.empty() ? "?" : holder;
}

}  // namespace palpate::programs
