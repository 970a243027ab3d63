// SPDX-License-Identifier: MIT
// What this process does where the disk is full or descriptors are used up: limits of its own act as both do.
#pragma once

#include "support/testing.hpp"

#include <csignal>
#include <string>

#include <sys/resource.h>

namespace palpate::test {

/// What error_of() returns where no file may be longer than `bytes`: a limit of this process acts as a full disk does.
template <class Call>
std::string with_little_room(rlim_t bytes, const Call& call) {
  rlimit before{};
  EXPECT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto heard = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit little{bytes, before.rlim_max};
  EXPECT_EQ(::setrlimit(RLIMIT_FSIZE, &little), 0);
  std::string out = error_of(call);
  ::setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, heard);
  return out;
}

/// What error_of() returns where this process can open no further file.
template <class Call>
std::string without_descriptors(const Call& call) {
  rlimit before{};
  EXPECT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none{0, before.rlim_max};
  EXPECT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  std::string out = error_of(call, Error::Kind::run);
  ::setrlimit(RLIMIT_NOFILE, &before);
  return out;
}

}  // namespace palpate::test
