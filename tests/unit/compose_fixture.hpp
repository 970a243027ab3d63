// SPDX-License-Identifier: MIT
// Files in a folder of their own, and what composing them gives or how it is refused.
#pragma once

#include "config/compose.hpp"
#include "config/yaml.hpp"
#include "experiment/experiment_options.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace palpate::test {

class ComposeFixture : public ::testing::Test {
 protected:
  Tree compose(const std::string& text, const std::vector<std::string>& overrides = {}) {
    const auto file = folder_.write("c.yaml", text);
    std::vector<Override> parsed;
    for (const std::string& one : overrides) parsed.push_back(parse_override(one));
    return Composer("/nonexistent", config_keys()).compose(file, parsed);
  }

  /// The error with the folder's name left out.
  std::string refusal(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
      compose(text, overrides);
    } catch (const Error& error) {
      std::string what = error.what();
      const std::string prefix = folder_.path().string() + "/";
      for (auto at = what.find(prefix); at != std::string::npos; at = what.find(prefix)) what.erase(at, prefix.size());
      return what;
    }
    return "accepted";
  }

  TemporaryFolder folder_;
};

}  // namespace palpate::test
