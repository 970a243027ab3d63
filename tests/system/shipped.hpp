// SPDX-License-Identifier: MIT
// What the tests of the commands share: shipped configs by name, lines counted, and the short names of what nearly
// every one of them says.
#pragma once

#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

namespace palpate::test {

inline std::string config(const std::string& name) { return (source_folder() / "configs" / name).string(); }

inline std::string paper() { return config("paper/object_i.yaml"); }

inline int lines(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

inline std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

}  // namespace palpate::test

namespace palpate {

namespace fs = std::filesystem;
using test::Cells;
using test::config;
using test::csv_rows;
using test::Ended;
using test::lines;
using test::lines_of;
using test::only_run;
using test::paper;
using test::TemporaryFolder;
using test::text_of;
using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;
using testing::StartsWith;

}  // namespace palpate
