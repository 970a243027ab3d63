// SPDX-License-Identifier: MIT
#include "process/recorded.hpp"

#include <palpate/error.hpp>

#include <cerrno>
#include <cstring>

#include <fcntl.h>

namespace palpate::process {

Descriptor open_recorded(const std::string& file, int flags) {
  const int number = ::open(file.c_str(), flags | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (number < 0 && errno == ELOOP)
    throw Error(file, "is a link, and nothing is written through one", "remove it", Error::Kind::run);
  Descriptor out = above_standard(number);
  if (!out)
    throw Error("command", std::string("cannot open a pipe or file: ") + std::strerror(errno), {}, Error::Kind::run);
  return out;
}

}  // namespace palpate::process
