// SPDX-License-Identifier: MIT
// What a sweep varies, described in a config and on the command line, as a user sees it.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace palpate {
namespace {

class SweepDescription : public Shell {
 protected:
  /// What `--list` prints without job numbers and ids.
  Words listed(const Words& more, const std::string& file) const {
    const Ended ended = sweep(more + "--list", file);
    EXPECT_EQ(ended.status, 0) << ended.err;
    Words out;
    for (const std::string& line : lines_of(ended.out)) {
      const auto id = line.find("  ");
      out.push_back(line.substr(std::min(line.size(), line.find("  ", id + 2) + 2)));
    }
    return out;
  }
};

TEST_F(SweepDescription, RunsEveryBlockOfAConfigAndLeavesCellsEmptyWhereAnOptionIsMissing) {
  write("mine.yaml",
        "name: mine\n"
        "defaults:\n"
        "  - kernel: rbf\n"
        "  - acquisition: weighted\n"
        "  - fitting: fixed\n"
        "  - backend: simulator\n"
        "  - scene: object_i\n"
        "sweep:\n"
        "  zip: {taps: [6, 8], candidates.count: [12, 24]}\n"
        "  list:\n"
        "    - acquisition: random\n"
        "    - {acquisition: grid, acquisition.count: [3, 4]}\n"
        "  sobol: {samples: 2, keys: {kernel.length_scale: 'log_uniform(1cm,10cm)'}}\n"
        "  grid: {seed: [1, 2]}\n"
        "  where: [taps == 8 or not acquisition == grid, seed == 1 or taps < 8]\n");
  // Of 2 x 3 x 2 x 2: with 6 taps random alone, 2 x 2; with 8 all three, with one seed.
  const std::string results = text_of(swept({}, "mine.yaml") / "results.csv");
  const auto rows = csv_rows(results);
  ASSERT_EQ(rows.size(), 4U + 6U);
  for (const Cells& row : rows) {
    EXPECT_EQ(row.at("candidates.count"), row.at("taps") == "6" ? "12" : "24");
    EXPECT_EQ(row.at("acquisition.count").empty(), row.at("acquisition") == "random");
    EXPECT_EQ(row.at("status"), "done");
  }
  EXPECT_THAT(results, HasSubstr("job,id,taps,candidates.count,acquisition,acquisition.count,kernel.length_scale,"
                                 "seed,name"));
}

TEST_F(SweepDescription, NarrowsTheSweepOfAConfigFromTheCommandLine) {
  Words expected;
  for (const char* taps : {"taps=17", "taps=19"}) {
    for (const char* scale : {"2.5 cm", "4 cm"}) {
      expected.push_back(std::string(taps) + "  kernel=rational_quadratic  kernel.length_scale=" + scale +
                         "  kernel.alpha=0.5  seed=3  scene=object_i");
    }
  }
  EXPECT_EQ(listed({"seed=3", "scene=object_i", "sweep.where=kernel.alpha < 1"}, config("sweep/kernels.yaml")),
            expected);
}

TEST_F(SweepDescription, ASingleRunLeavesItAsideAndSaysSo) {
  const Words words{"taps=5", "sweep.grid={seed: [1, 2]}"};
  const Ended ended = run(words);
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err, "command line: sweep: is ignored by 'palpate run'; 'palpate sweep' runs all its jobs\n");
  EXPECT_EQ(run(words + "--quiet").err, "");
  EXPECT_EQ(run("taps=6").err, "");
}

}  // namespace
}  // namespace palpate
