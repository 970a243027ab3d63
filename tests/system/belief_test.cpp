// SPDX-License-Identifier: MIT
// Beliefs as plugins: another one than the default runs, compares, resumes and replays, and a name is enough to choose
// it.
#include "system/shell.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class Beliefs : public Shell {
 protected:
  const Words nearest_{"belief=nearest_neighbour", "strategy=uncertainty"};
};

TEST_F(Beliefs, OneThatIsNoGaussianProcessRunsAndComparesOnTwelveObjects) {
  const fs::path sweep =
      swept({"belief=height_map,nearest_neighbour", "acquisition=uncertainty", "taps=9", "name=beliefs",
             "scene=object_i,object_ii,dome,l,ring,cylinder,two_blocks,rod,cube,tall_cone,tilted_block,large_block"});
  EXPECT_EQ(jobs_of(sweep).size(), 24U);
  const Ended compared = palpate({"compare", sweep, "--by", "belief", "--metric", "rmse_m"});
  EXPECT_EQ(compared.status, 0) << compared.err;
  EXPECT_THAT(compared.out, AllOf(HasSubstr("height_map"), HasSubstr("nearest_neighbour")));
}

TEST_F(Beliefs, OneThatIsNoGaussianProcessResumesAndReplaysToTheSameNumbersAndHasAPage) {
  const fs::path run = ran(nearest_ + "taps=9");
  const std::string taps = part_of(run, "tap");
  EXPECT_THAT(taps, AllOf(HasSubstr("rmse_m"), HasSubstr(R"("nearest": {"mean_uncertainty": )")))
      << "a field of its own";
  const Ended replayed = palpate({"replay", run});
  EXPECT_EQ(replayed.status, 0) << replayed.out << replayed.err;
  break_off(run);
  ASSERT_EQ(resume(run).status, 0);
  EXPECT_EQ(part_of(run, "tap"), taps);
  const Ended reported = palpate({"report", run});
  EXPECT_EQ(reported.status, 0) << reported.err;
}

TEST_F(Beliefs, AStartWithoutAContactIsCountedForEachBelief) {
  std::map<std::string, std::string> shares;
  for (const char* const belief : {"height_map", "nearest_neighbour"}) {
    const std::string table = palpate({"sweep", paper(), "acquisition=uncertainty", "scene=cube", "initial.count=1",
                                       "taps=4", std::string("belief=") + belief, "seed=range(1,7)"})
                                  .out;
    shares[belief] = table.substr(table.find("all jobs"), 30);
  }
  EXPECT_EQ(shares.at("height_map"), shares.at("nearest_neighbour"));
  EXPECT_THAT(shares.at("height_map"), Not(HasSubstr(" 0.0%"))) << "no start without a contact";
}

TEST_F(Beliefs, AMapOfTheNearestContactsHasTheirHeights) {
  const fs::path run = ran(nearest_ + "taps=5 candidates.count=3 scene=block");
  std::map<std::pair<double, double>, double> tapped;
  for (const Row& row : rows_of(run, "tap"))
    tapped[{row.number("x").value(), row.number("y").value()}] = row.number("height").value();
  int same = 0;
  for (const test::Cells& cells : test::csv_rows(text_of(run / "surface.csv"))) {
    const auto found = tapped.find({std::stod(cells.at("x")), std::stod(cells.at("y"))});
    if (found == tapped.end()) continue;
    EXPECT_EQ(std::stod(cells.at("reconstructed_height")), found->second);
    ++same;
  }
  EXPECT_EQ(same, static_cast<int>(tapped.size()));
}

TEST_F(Beliefs, WhatOneDoesNotOfferIsRefusedWithBothNames) {
  EXPECT_THAT(refused({"run", paper(), "belief=nearest_neighbour", "acquisition=weighted"}),
              HasSubstr("weighted reads label_mean, which the belief nearest_neighbour does not offer"));
  EXPECT_THAT(
      refused({"run", paper(), "belief=nearest_neighbour", "acquisition=uncertainty", "stop.expected_rmse=1cm"}),
      HasSubstr("stop.expected_rmse reads expected_rmse, which the belief nearest_neighbour does not offer"));
  EXPECT_THAT(refused({"run", paper(), "belief=nearest_neighbor"}), HasSubstr("did you mean 'nearest_neighbour'?"));
}

TEST_F(Beliefs, ADryRunNamesTheModelsAndWhoReadsThem) {
  EXPECT_THAT(palpate({"run", paper(), "--dry-run"}).out,
              AllOf(HasSubstr("models for the choice of taps, and the parts that read them:\n"),
                    HasSubstr("  label GP: acquisition weighted\n")));
  EXPECT_THAT(palpate({"run", paper(), "--dry-run", "acquisition=random", "choice.fallback=none"}).out,
              AllOf(HasSubstr("models for the choice of taps: none\n"), Not(HasSubstr("label GP"))));
  EXPECT_THAT(
      palpate({"run", test::config("default.yaml"), "--dry-run", "acquisition=random", "choice.fallback=none"}).out,
      HasSubstr(": motion per_tap\n"));
}

TEST_F(Beliefs, AnOptionOfTheFormerLayoutIsRefusedWithItsNewPlace) {
  EXPECT_THAT(refused({"run", paper(), "height.noise=1mm"}), HasSubstr("belief.height"));
  EXPECT_THAT(refused({"run", paper(), "fallback=none"}), HasSubstr("choice.fallback"));
}

}  // namespace
}  // namespace palpate
