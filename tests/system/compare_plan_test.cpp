// SPDX-License-Identifier: MIT
// Planned comparisons as a user meets them: the block `compare:` in validate, sweep, run, tune, compare and on the
// page.
#include "config/hash.hpp"
#include "config/tree.hpp"
#include "config/yaml.hpp"
#include "record/json.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

const char* const kBlock =
    "compare:\n  metric: [rmse_m, footprint_iou]\n  by: acquisition\n  baseline: uncertainty\n  seeds: 6\n  "
    "difference: 1 "
    "mm\n";
const char* const kSwept = "acquisition=uncertainty,weighted taps=8 candidates.count=16 seed=range(0,6)";

class ComparePlanned : public Shell {
 protected:
  std::string config(const std::string& block = kBlock) const {
    return write("planned.yaml", text_of(paper()) + block);
  }
  /// Returns the line about the plan in the output of `palpate compare`.
  std::string line(const fs::path& directory, const Words& more = {}) const {
    const Ended ended = palpate(Words{"compare", directory} + more);
    EXPECT_EQ(ended.status, 0) << ended.err;
    for (const char* begin : {"planned before", "chosen afterwards"}) {
      const auto at = ended.out.find(std::string("\n") + begin);
      if (at != std::string::npos) return ended.out.substr(at + 1, ended.out.find('\n', at + 1) - at - 1);
    }
    return "none";
  }
};

TEST_F(ComparePlanned, IsMadeByCompareWithoutOptionsAndIsTheSameWithTheOptionsOfThePlan) {
  const fs::path directory = swept(kSwept, config());
  const Tree recorded = read_yaml(directory / "config.yaml");
  const std::string hash = hash_of(recorded.find("compare")->canonical()).substr(0, 12);
  const std::string planned = "planned before the first run (plan " + hash +
                              "): rmse_m by acquisition, baseline uncertainty, 6 seeds, differences from 1 mm matter, "
                              "secondary footprint_iou";
  EXPECT_EQ(line(directory), planned);
  const Ended made = palpate({"compare", directory});
  EXPECT_THAT(made.out, StartsWith("rmse_m [mm] by acquisition; less is better\n"));
  EXPECT_THAT(made.out, HasSubstr("\nfootprint_iou by acquisition; more is better\n"));
  EXPECT_THAT(made.out, HasSubstr("\nverdict: the interval shows "));
  const Words same{"--by", "acquisition", "--metric", "rmse_m,footprint_iou", "--baseline", "uncertainty"};
  EXPECT_EQ(palpate(Words{"compare", directory} + same).out, made.out);
  const std::string other = "chosen afterwards: the plan " + hash + " is another comparison";
  EXPECT_EQ(line(directory, "--by acquisition --metric rmse_m,footprint_iou"), other) << "no baseline";
  EXPECT_EQ(line(directory, "--by acquisition --metric rmse_m --baseline uncertainty"), other);
  EXPECT_EQ(line(directory, "--by acquisition --metric footprint_iou,rmse_m --baseline uncertainty"), other);
  EXPECT_EQ(line(directory, same + Words{"--where", "first_hit_tap <= 3"}), other);
  EXPECT_EQ(line(directory, Words("--baseline weighted")), other);
  EXPECT_EQ(line(directory, Words("--at 6")), other);
  EXPECT_THAT(refused({"compare", directory, "--by", "acquisition"}), StartsWith("--metric is required"));
}

TEST_F(ComparePlanned, IsMarkedInTheRowsOfCsvJsonAndLatex) {
  const fs::path directory = swept(kSwept, config());
  for (const Cells& row : csv_rows(palpate({"compare", directory, "--format", "csv"}).out)) {
    EXPECT_EQ(row.at("planned"), "true");
    EXPECT_EQ(row.at("plan").size(), 12U);
    const bool decides = row.at("kind") == "pair" && row.at("metric") == "rmse_m";
    EXPECT_EQ(row.at("verdict").empty(), !decides);
    if (!decides) continue;
    const double low = std::stod(row.at("low_95"));
    const double high = std::stod(row.at("high_95"));
    const char* expected = low >= 1e-3 || high <= -1e-3 ? "larger"
                           : low > -1e-3 && high < 1e-3 ? "smaller"
                                                        : "not decided";
    EXPECT_EQ(row.at("verdict"), expected);
  }
  const Words other{"--by", "acquisition", "--metric", "taps"};
  const std::string object = "{\"rows\":" + palpate(Words{"compare", directory, "--format", "json"} + other).out + "}";
  const Tree tree = *parse_json(object, "stdout").find("rows");
  ASSERT_EQ(tree.items.size(), 3U);
  EXPECT_EQ(tree.items[2].find("planned")->text, "false");
  EXPECT_EQ(tree.items[2].find("plan")->text.size(), 12U);
  EXPECT_EQ(tree.items[2].find("verdict")->kind, Tree::Kind::null);
  EXPECT_THAT(palpate({"compare", directory, "--format", "latex"}).out,
              StartsWith("% planned before the first run (plan "));
  const fs::path bare = swept(kSwept);
  EXPECT_THAT(palpate(Words{"compare", bare, "--format", "latex"} + other).out, StartsWith("% chosen afterwards\n"));
  EXPECT_EQ(line(bare, other), "chosen afterwards");
  EXPECT_EQ(refused({"compare", bare}), "--by or --importance is required, see palpate compare --help\n");
}

TEST_F(ComparePlanned, BelongsToTheIdOfTheSweepAndNotToTheIdsOfRuns) {
  const fs::path bare = swept(kSwept);
  const fs::path with = swept(kSwept, config());
  const fs::path other = swept(Words(kSwept) + Words("compare.difference=2mm"), config());
  EXPECT_NE(with.filename(), bare.filename());
  EXPECT_NE(with.filename(), other.filename());
  const auto ids = [](const fs::path& sweep) {
    std::set<std::string> out;
    for (const fs::path& job : jobs_of(sweep)) out.insert(job.filename().string());
    return out;
  };
  EXPECT_EQ(ids(with), ids(bare));
  const auto exists = [](const fs::path& sweep) { return HasSubstr(sweep.filename().string() + ", which exists"); };
  EXPECT_THAT(sweep(Words(kSwept) + Words("compare=none"), config()).err, exists(bare));
  EXPECT_THAT(sweep({}, with / "config.yaml").err, exists(with)) << "the recorded config makes the same sweep";
  replace(with / "config.yaml", "difference: 1 mm", "difference: 9 mm");
  EXPECT_THAT(refused({"compare", with}), HasSubstr("was changed after this sweep started"));
}

TEST_F(ComparePlanned, IsCheckedBeforeAnyJobAndInvalidPlansLeaveNothing) {
  const auto refusal = [&](const std::string& part, const std::string& text, const Words& words = kSwept) {
    std::string block = kBlock;
    block.replace(block.find(part), part.size(), text);
    const std::string file = config(block);
    const std::string line = refused(Words{"sweep", file} + words);
    EXPECT_TRUE(left_nothing()) << line;
    EXPECT_THAT(line, StartsWith(file + ":"));
    return line;
  };
  EXPECT_THAT(refusal("metric", "metrics"), HasSubstr("unknown option 'metrics' of compare, did you mean 'metric'?"));
  EXPECT_THAT(refusal("rmse_m", "rsme_m"), HasSubstr("compare.metric: results.csv has no column 'rsme_m'"));
  EXPECT_THAT(refusal("by: acquisition", "by: kernel"), HasSubstr("compare.by: this sweep does not vary 'kernel'"));
  EXPECT_THAT(refusal("uncertainty", "grid"), HasSubstr("compare.baseline: there is no group 'grid'"));
  EXPECT_THAT(refusal("seeds: 6", "seeds: 7"), HasSubstr("group 'uncertainty' has 6 seeds, not 7"));
  EXPECT_THAT(refusal("1 mm", "1 N"), HasSubstr("compare.difference"));
  EXPECT_THAT(refusal("by", "by", "acquisition=uncertainty,weighted seed=1,2"),
              HasSubstr("group 'uncertainty' has 2 seeds, not 6"));
  EXPECT_THAT(refused(Words{"sweep", config()} + Words(kSwept) + Words("compare.seeds=5")),
              StartsWith("command line: compare.seeds: group 'uncertainty' has 6 seeds, not 5"));
  EXPECT_THAT(palpate(Words{"sweep", config(), "--list"} + Words("acquisition=uncertainty,weighted seed=1,2")).status,
              2);
}

TEST_F(ComparePlanned, IsCheckedByValidateAndIgnoredByRunAndTune) {
  const std::string axes = "sweep: {grid: {acquisition: [uncertainty, weighted], seed: 'range(0,6)'}}\n";
  EXPECT_THAT(palpate({"validate", config(axes + kBlock)}).out, HasSubstr("valid, a sweep of 12 jobs"));
  EXPECT_THAT(refused({"validate", config(axes + "compare: {metric: rmse_m, by: acquisition, seeds: 5}\n")}),
              HasSubstr("compare.seeds: group 'uncertainty' has 6 seeds, not 5"));
  EXPECT_THAT(refused({"validate", config("compare: {metric: rsme_m, by: acquisition, seeds: 5}\n")}),
              HasSubstr("compare.metric: results.csv has no column 'rsme_m'"));
  EXPECT_EQ(palpate({"validate", config()}).status, 0) << "the keys may come from the command line";
  const Words small = "taps=4 candidates.count=9";
  const Ended ended = run(small, config());
  EXPECT_THAT(ended.err, HasSubstr("compare: is ignored by 'palpate run'; it plans a comparison of a sweep\n"));
  EXPECT_EQ(directory().filename(), ran(small + Words{"--runs", "other"}).filename());
  EXPECT_EQ(palpate(Words{"tune", config(), "--quiet", "--runs", "race", "--metric", "rmse_m", "--jobs", "20",
                          "--fresh", "0", "acquisition=random,grid"} +
                    small)
                .status,
            0);
  const fs::path race = only_run(here() / "race");
  EXPECT_EQ(read_yaml(race / "config.yaml").find("compare"), nullptr);
  EXPECT_EQ(line(race, "--by acquisition --metric rmse_m"), "chosen afterwards");
}

TEST_F(ComparePlanned, CountsTheSeedsWithoutAValueAndIsOneOfSeveralRecordsOnlyIfAllHaveIt) {
  const fs::path directory = swept(kSwept, config());
  const fs::path copy = here() / "copy" / "planned" / directory.filename();
  fs::create_directories(copy.parent_path());
  fs::copy(directory, copy, fs::copy_options::recursive);
  EXPECT_THAT(line(directory, Words{copy.string()}), StartsWith("planned before the first run"));
  EXPECT_EQ(line(directory, Words{swept(kSwept).string(), "--by", "acquisition", "--metric", "rmse_m"}),
            "chosen afterwards");
  fs::remove_all(job_of(directory, 0));
  EXPECT_THAT(line(directory), testing::EndsWith("; 5 of 6 seeds have values"));
  const Words where{"compare.where=first_hit_tap <= 3"};
  EXPECT_THAT(line(swept(Words(kSwept) + where, config())),
              AllOf(HasSubstr("by acquisition where first_hit_tap <= 3, baseline"),
                    testing::EndsWith(" of 6 seeds satisfy the condition and have values")));
}

}  // namespace
}  // namespace palpate
