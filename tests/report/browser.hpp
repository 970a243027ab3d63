// SPDX-License-Identifier: MIT
// Test fixture: a page in headless Chromium, driven by tests/report/browse.py.
#pragma once

#include "report/page/json.hpp"
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

/// Results of the steps on a page.
struct Browsed {
  std::vector<nlohmann::json> values;  ///< one per step with a value
  std::vector<std::string> severe;     ///< messages of the console at level SEVERE
  std::string trouble;                 ///< error of the browser or of a step; "" for none
};

/// Opens `page`, a file or an address, and performs the steps described in browse.py.
Browsed browse(const std::filesystem::path& page, const std::vector<std::string>& steps, bool webgl);

/// Returns a step that waits until the page has drawn this tap of a run, or this often for a sweep.
std::string drawn(int what);

/// Tests of pages, which are skipped without a browser.
class Reports : public ::testing::Test {
 protected:
  void SetUp() override;
  /// Writes the page of a run or sweep.
  void report(const std::filesystem::path& directory) const;

  const std::string paper_ = (source_folder() / "configs/paper/object_i.yaml").string();
  const TemporaryFolder folder_;
};

/// Tests with and without WebGL.
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
