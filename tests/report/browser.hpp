// SPDX-License-Identifier: MIT
// A page in a real browser: headless Chromium, driven by tests/report/browse.py.
#pragma once

#include "report/page/json.hpp"
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

/// What a page said to the steps that it was put through.
struct Browsed {
  std::vector<nlohmann::json> values;  ///< one for each step that has a value
  std::vector<std::string> severe;     ///< what the console holds at level SEVERE
  std::string trouble;                 ///< why the browser or a step failed, "" if none did
};

/// Opens `page`, a file or an address, and does the steps, each as browse.py describes it.
Browsed browse(const std::filesystem::path& page, const std::vector<std::string>& steps, bool webgl);

/// Waits until the page says that it has drawn this: the tap of a run, or how often for a sweep.
std::string drawn(int what);

/// Tests of pages, skipped where there is no browser.
class Reports : public ::testing::Test {
 protected:
  void SetUp() override;
  /// Writes the page of a run or a sweep.
  void report(const std::filesystem::path& directory) const;

  const std::string paper_ = (source_folder() / "configs/paper/object_i.yaml").string();
  const TemporaryFolder folder_;
};

/// The same with WebGL and without.
class ReportsInBoth : public Reports, public ::testing::WithParamInterface<bool> {
 protected:
  Browsed browse(const std::filesystem::path& directory, const std::vector<std::string>& steps) const;
};

std::string webgl_name(const ::testing::TestParamInfo<bool>& info);

}  // namespace palpate::test

namespace palpate {

namespace fs = std::filesystem;

using nlohmann::json;
using test::Browsed;
using test::Cells;
using test::csv_rows;
using test::drawn;
using test::text_of;

}  // namespace palpate
