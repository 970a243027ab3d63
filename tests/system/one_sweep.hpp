// SPDX-License-Identifier: MIT
// A folder with one sweep in it, which is looked at, damaged and carried on.
#pragma once

#include "record/json.hpp"
#include "system/shipped.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

class OneSweep : public testing::Test {
 protected:
  std::filesystem::path directory() const { return only_run(folder_.path() / "runs"); }
  std::filesystem::path job(int index) const {
    const std::vector<Row> rows = read_json_lines(directory() / "manifest.jsonl").rows;
    return directory() / "jobs" / std::get<std::string>(*rows.at(static_cast<std::size_t>(index)).find("id"));
  }
  Ended palpate(const std::vector<std::string>& words) const {
    return test::palpate(words, folder_.path(), environment_);
  }
  Ended resume(const std::vector<std::string>& more = {}) const {
    return palpate(test::plus({"resume", directory().string(), "--quiet"}, more));
  }
  std::string status() const { return palpate({"status", directory().string()}).out; }

  TemporaryFolder folder_;
  std::vector<std::string> environment_;  ///< of palpate, NAME=VALUE
};

}  // namespace palpate::test
