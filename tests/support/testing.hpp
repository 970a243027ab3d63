// SPDX-License-Identifier: MIT
// What a test begins with: GoogleTest and the standard headers below, the places and the plugins of this build, a
// folder that vanishes, and what wrong input is told.
#pragma once

#include "support/plugins.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate::test {

namespace fs = std::filesystem;

/// The line that a user reads when `call` throws an Error; "accepted" if it throws none. Fails the test where the error
/// is of another kind than `kind`.
template <class Call>
std::string error_of(const Call& call, std::optional<Error::Kind> kind = {}) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), kind.value_or(error.kind())) << error.what();
    return error.what();
  }
  return "accepted";
}

/// Tests that need a folder each.
class InFolder : public testing::Test {
 protected:
  TemporaryFolder folder_;
};

}  // namespace palpate::test
