// SPDX-License-Identifier: MIT
#include "process/hold.hpp"

#include <palpate/error.hpp>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

namespace palpate::process {

std::optional<Hold> Hold::take(const std::string& file, const Patience& patience) {
  Descriptor lock = open_recorded(file, O_RDWR);
  // Asked again and again: a wait in the kernel could not be broken off.
  while (::flock(lock.number(), LOCK_EX | LOCK_NB) != 0) {
    if (errno != EWOULDBLOCK && errno != EINTR) {
      throw Error(file, std::string("cannot be locked: ") + std::strerror(errno), {}, Error::Kind::run);
    }
    if (patience.broken_off() || std::chrono::steady_clock::now() >= patience.until) return std::nullopt;
    std::this_thread::sleep_for(kGlance);
  }
  return Hold(std::move(lock));
}

void Hold::note(pid_t holder) const {
  const std::string line = std::to_string(holder) + '\n';
  if (::ftruncate(lock_.number(), 0) != 0) return;
  // A note that cannot be written costs the next one a number in a message, no more.
  [[maybe_unused]] const ssize_t wrote = ::pwrite(lock_.number(), line.data(), line.size(), 0);
}

std::string Hold::noted(const std::string& file) {
  std::ifstream in(file);
  std::string holder;
  return std::getline(in, holder) ? holder : "?";
}

}  // namespace palpate::process
