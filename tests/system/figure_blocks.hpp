// SPDX-License-Identifier: MIT
// The data that a picture's script holds, and the record that it is compared with.
#pragma once

#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

namespace palpate::test {

using Lines = std::vector<std::vector<double>>;

/// The data blocks of a script by their names; blank lines are left out.
inline std::map<std::string, Lines> blocks_of(const fs::path& script) {
  std::map<std::string, Lines> out;
  Lines* block = nullptr;
  for (const std::string& line : lines_of(text_of(script))) {
    if (block == nullptr && line.rfind('$', 0) == 0 && line.find(" << END") != std::string::npos) {
      block = &out[line.substr(1, line.find(' ') - 1)];
    } else if (line == "END") {
      block = nullptr;
    } else if (block != nullptr && !line.empty()) {
      std::istringstream cells(line);
      block->emplace_back();
      for (std::string cell; cells >> cell;) block->back().push_back(std::stod(cell));
    }
  }
  return out;
}

inline Lines block_or_none(const std::map<std::string, Lines>& blocks, const std::string& name) {
  const auto found = blocks.find(name);
  return found != blocks.end() ? found->second : Lines{};
}

/// A recorded run as its directory tells it.
struct Recorded {
  fs::path directory;
  std::vector<Cells> taps;

  explicit Recorded(const fs::path& where) : directory(where), taps(csv_rows(text_of(where / "taps.csv"))) {}

  int count() const { return static_cast<int>(taps.size()); }
  double at(int tap, const char* field) const { return std::stod(taps[static_cast<std::size_t>(tap - 1)].at(field)); }
  /// Of the taps up to `last` those whose on_object is `on`: as a script has them.
  Lines marks(int last, const std::string& on) const {
    Lines out;
    for (int tap = 1; tap <= last; ++tap) {
      if (taps[static_cast<std::size_t>(tap - 1)].at("on_object") == on)
        out.push_back({100 * at(tap, "x"), 100 * at(tap, "y"), 100 * at(tap, "height"), static_cast<double>(tap)});
    }
    return out;
  }
};

inline void expect_equal(const Lines& plotted, const Lines& recorded, const std::string& what) {
  ASSERT_EQ(plotted.size(), recorded.size()) << what;
  for (std::size_t i = 0; i < plotted.size(); ++i) {
    ASSERT_EQ(plotted[i].size(), recorded[i].size()) << what;
    for (std::size_t j = 0; j < plotted[i].size(); ++j) EXPECT_NEAR(plotted[i][j], recorded[i][j], 1e-7) << what;
  }
}

/// The value of a map at a place given in centimetres, the area being 23 by 23 of them.
inline double value_at(const Lines& matrix, double x, double y) {
  const auto cells = static_cast<double>(matrix.size());
  return matrix.at(static_cast<std::size_t>(y / 23 * cells)).at(static_cast<std::size_t>(x / 23 * cells));
}

}  // namespace palpate::test

namespace palpate {

using test::block_or_none;
using test::blocks_of;
using test::expect_equal;
using test::Lines;
using test::Recorded;
using test::value_at;
using testing::_;
using testing::SizeIs;

}  // namespace palpate
