// SPDX-License-Identifier: MIT
// Fixture and steps for tests of a sweep's page.
#pragma once

#include "report/browser.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace palpate::test {

/// Returns the sorted numbers of a column, times `factor`, over the rows that satisfy `wanted`.
inline std::vector<double> column(const std::vector<Cells>& rows, const std::string& name, double factor,
                                  const std::function<bool(const Cells&)>& wanted) {
  std::vector<double> out;
  for (const Cells& row : rows) {
    if (wanted(row) && !row.at(name).empty()) out.push_back(std::stod(row.at(name)) * factor);
  }
  std::sort(out.begin(), out.end());
  return out;
}

inline std::vector<double> sorted(const json& numbers) {
  auto out = numbers.get<std::vector<double>>();
  std::sort(out.begin(), out.end());
  return out;
}

inline void expect_near(const std::vector<double>& seen, const std::vector<double>& expected) {
  ASSERT_EQ(seen.size(), expected.size());
  for (std::size_t i = 0; i < seen.size(); ++i)
    EXPECT_NEAR(seen[i], expected[i], 1e-12 * (1.0 + std::abs(expected[i])));
}

/// Returns a step that chooses a value of a control.
inline std::string choose(const std::string& id, const std::string& value) {
  return fmt::format(
      "const s = document.getElementById('{}'); s.value = '{}'; s.dispatchEvent(new Event('change')); return s.value;",
      id, value);
}

inline std::string data_of(const std::string& id, const std::string& expression) {
  return fmt::format("const e = document.getElementById('{}'); const d = e.data; const l = e.layout; return {};", id,
                     expression);
}

inline const std::string kCells =
    "const c = (id) => document.getElementById(id); const m = c('cells_mean'); return {x: m.layout.xaxis.ticktext, y: "
    "m.layout.yaxis.ticktext, mean: m.data[0].z, spread: c('cells_spread').data[0].z, hover: m.data[0].customdata, "
    "title: m.data[0].colorbar.title.text}";

class SweepPages : public ReportsInBoth {
 protected:
  /// Runs a sweep and returns its directory.
  fs::path swept(std::vector<std::string> words, const std::vector<std::string>& environment = {}) const {
    words.insert(words.begin(), "sweep");
    words.insert(words.end(), {"--quiet", "--runs", "runs", "-j", "2"});
    const Ended ended = test::palpate(words, folder_.path(), environment);
    EXPECT_TRUE(ended.status == 0 || ended.status == 1) << ended.err;
    return test::only_run(folder_.path() / "runs");
  }
};

}  // namespace palpate::test

namespace palpate {

using test::choose;
using test::column;
using test::data_of;
using test::expect_near;
using test::kCells;
using test::sorted;
using ::testing::AllOf;
using ::testing::HasSubstr;

}  // namespace palpate
