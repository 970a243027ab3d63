// SPDX-License-Identifier: MIT
#include "children/arm_lock.hpp"

#include <palpate/error.hpp>

#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& what, const std::string& why, const std::string& remedy) {
  throw Error(what.string(), why, remedy, Error::Kind::run);
}

std::string file_name(const std::string& arm) {
  constexpr std::size_t kLongest = 240;  // of 255; longer names are cut, and then two arms may wait for each other
  std::string out;
  for (const char c : arm) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x80 && (std::isalnum(byte) != 0 || std::strchr("._-", c) != nullptr)) {
      out += c;
    } else {
      std::array<char, 4> code{};
      std::snprintf(code.data(), code.size(), "%%%02X", byte);
      out += code.data();
    }
  }
  return out.substr(0, kLongest) + ".lock";
}

/// Makes the folder if need be. A stranger who may write there, or whose link it is, could have the lock removed.
void make_own(const fs::path& folder) {
  struct stat there {};
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    fail(folder, std::string("cannot be made: ") + std::strerror(errno), "locks of arms lie there");
  if (::lstat(folder.c_str(), &there) != 0) fail(folder, std::strerror(errno), "locks of arms lie there");
  if (S_ISDIR(there.st_mode) && there.st_uid == ::geteuid() && (there.st_mode & 077) == 0) return;
  fail(folder, "is not a folder of this user alone", "remove it, or set its mode to 0700: locks of arms lie there");
}

std::string holder_of(const Descriptor& file) {
  std::array<char, 4096> text{};
  const ssize_t got = ::pread(file.number(), text.data(), text.size(), 0);
  std::string out(text.data(), static_cast<std::size_t>(got > 0 ? got : 0));
  return out.substr(0, out.find('\n'));
}

}  // namespace

fs::path arm_lock_folder() {
  const char* runtime = std::getenv("XDG_RUNTIME_DIR");
  if (runtime != nullptr && *runtime == '/') return fs::path(runtime) / "palpate";
  return fs::temp_directory_path() / ("palpate-" + std::to_string(::geteuid()));
}

ArmLock::ArmLock(const std::string& where, const std::string& arm, const std::string& owner) {
  const fs::path folder = arm_lock_folder();
  make_own(folder);
  const fs::path path = folder / file_name(arm);
  Descriptor file = above_standard(::open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0600));
  if (!file) fail(path, std::string("cannot be opened: ") + std::strerror(errno), "the lock of an arm is there");
  while (::flock(file.number(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    if (errno != EWOULDBLOCK) fail(path, std::string("cannot be locked: ") + std::strerror(errno), "");
    const std::string holder = holder_of(file);
    throw Error(where, "the arm " + arm + " is in the hands of " + (holder.empty() ? "another process" : holder),
                "wait until that has ended, or end it", Error::Kind::busy);
  }
  const std::string note = "process " + std::to_string(::getpid()) + (owner.empty() ? "" : ", " + owner) + '\n';
  // One that cannot be written costs others a number, no more.
  if (::ftruncate(file.number(), 0) == 0) write_all(file, note);
  file_ = std::move(file);
}

}  // namespace palpate
