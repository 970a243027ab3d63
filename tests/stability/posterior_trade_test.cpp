// SPDX-License-Identifier: MIT
// The recorded table of what engines, spacing and refits cost and are worth.
#include "support/testing.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <set>

namespace palpate::test {
namespace {

TEST(PosteriorTrade, StandsInItsPageAsItWasRecorded) {
  const std::string page = test::text_of(test::source_folder() / "framework/docs/numerics.md");
  int shown = 0;
  for (const test::Cells& row :
       test::csv_rows(test::text_of(test::source_folder() / "runs/reference/posterior_trade.csv"))) {
    if (row.at("spacing_mm") == "2") continue;  // left out there
    ++shown;
    const std::string line =
        fmt::format("| {} | {} | {} | {} | {}, {} | {} | {} | {} |\n", row.at("engine"), row.at("spacing_mm"),
                    row.at("refit_every"), row.at("seconds"), row.at("mean_error_m"), row.at("variance_error"),
                    row.at("rmse_m"), row.at("rmse_change_m"), row.at("taps_as_dense"));
    EXPECT_NE(page.find(line), std::string::npos) << line;
  }
  EXPECT_EQ(shown, 12);
}

TEST(PosteriorTrade, NoEngineChangesATapOrLosesMoreThanTheAccuracy) {
  std::set<std::string> engines;
  for (const test::Cells& row :
       test::csv_rows(test::text_of(test::source_folder() / "runs/reference/posterior_trade.csv"))) {
    const auto number = [&](const char* column) { return std::strtod(row.at(column).c_str(), nullptr); };
    const std::string name = row.at("engine");
    engines.insert(name);
    const std::string same = row.at("taps_as_dense");
    EXPECT_EQ(same.substr(0, same.find(' ')), same.substr(same.rfind(' ') + 1)) << name << ' ' << row.at("spacing_mm");
    EXPECT_LE(number("mean_error_m"), 1e-9) << name;
    EXPECT_LE(number("variance_error"), 1e-12) << name;
  }
  EXPECT_EQ(engines, (std::set<std::string>{"dense", "grid", "lowrank"}));
}

}  // namespace
}  // namespace palpate::test
