// SPDX-License-Identifier: MIT
// A page in a real browser: headless Chromium, driven by tests/report/browse.py.
#pragma once

#include <nlohmann/json.hpp>

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

/// Opens `page` and does the steps, each as browse.py describes it.
Browsed browse(const std::filesystem::path& page, const std::vector<std::string>& steps, bool webgl);

/// Why nothing is tested with a browser here, "" if it is.
std::string browser_missing();

}  // namespace palpate::test
