// SPDX-License-Identifier: MIT
#include "process/descriptor.hpp"

#include <palpate/error.hpp>

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <unistd.h>

namespace palpate::process {

void Descriptor::close() {
  if (number_ >= 0) ::close(number_);
  number_ = -1;
}

Descriptor above_standard(int number) {
  if (number < 0)
    throw Error("command", std::string("cannot open a pipe or file: ") + std::strerror(errno), {}, Error::Kind::run);
  Descriptor low(number);
  if (number > STDERR_FILENO) return low;
  return above_standard(::fcntl(number, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
}

Descriptor open_recorded(const std::string& file, int flags) {
  const int number = ::open(file.c_str(), flags | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (number < 0 && errno == ELOOP)
    throw Error(file, "is a link, and nothing is written through one", "remove it", Error::Kind::run);
  return above_standard(number);
}

}  // namespace palpate::process
