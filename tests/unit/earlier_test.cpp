// SPDX-License-Identifier: MIT
// What a run had come to after fewer taps is what a run with that budget comes to.
#include "record/run_replay.hpp"

#include "record/fields.hpp"
#include "record/recorded_run.hpp"
#include "record/run.hpp"
#include "support/parts.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

/// Runs of configs/default.yaml with overrides, in one folder.
class Earlier : public InFolder, public testing::WithParamInterface<std::vector<std::string>> {
 protected:
  RunConclusion run(int taps) {
    std::vector<std::string> words = GetParam();
    words.push_back("taps=" + std::to_string(taps));
    const fs::path directory = folder_.path() / std::to_string(taps);
    return start_run(environment_, shipped_config("default.yaml", words), directory, {});
  }

  std::vector<Row> summaries_after(const RecordedRun& recorded, const std::vector<int>& taps) {
    const std::vector<Row> all = earlier_summaries(environment_, recorded);
    EXPECT_EQ(all.size() + 1, recorded.rows.size());
    std::vector<Row> out;
    for (const int count : taps) out.push_back(all.at(static_cast<std::size_t>(count - 1)));
    return out;
  }

  Installation installation_;
  RunEnvironment environment_{test::shared_host(), installation_, {}, nullptr};
};

std::string cell(const Row& row, const std::string& name) {
  const Scalar* value = row.find(name);
  return value != nullptr ? csv_cell(*value) : "absent";
}

/// Of an engine that was chosen for as many taps as the budget has.
bool tells_the_budget(const std::string& name) { return name.find("engine_reason") != std::string::npos; }

double number(const Row& row, const std::string& name) { return row.number(name).value(); }

TEST_P(Earlier, EqualsTheRunThatHadThisBudget) {
  const RunConclusion whole = run(14);
  const RecordedRun recorded = read_recorded_run(test::shared_host(), whole.directory);
  const std::vector<Row> earlier = summaries_after(recorded, {5, 9});
  ASSERT_EQ(earlier.size(), 2U);
  for (const int taps : {5, 9}) {
    const Row& row = earlier[taps == 5 ? 0 : 1];
    const RunConclusion shorter = run(taps);
    for (const Row* fields : {&row, &shorter.summary}) {
      for (const auto& [name, value] : fields->fields) {
        if (name == "id" || depends_on_machine(name) || tells_the_budget(name)) continue;
        EXPECT_EQ(cell(row, name), cell(shorter.summary, name)) << name << " after " << taps << " taps";
      }
    }
    EXPECT_EQ(cell(row, "id"), cell(whole.summary, "id")) << "of the run that it was";
  }
  EXPECT_EQ(earlier[1].find("nlpd") != nullptr, true);
}

TEST_P(Earlier, HasItsShareOfTheTimes) {
  const RunConclusion whole = run(14);
  const std::vector<Row> earlier = summaries_after(read_recorded_run(test::shared_host(), whole.directory), {5, 9});
  for (const char* name : {"wall_seconds", "compute_seconds", "robot_seconds"}) {
    EXPECT_GT(number(earlier[0], name), 0.0) << name;
    EXPECT_LT(number(earlier[0], name), number(earlier[1], name)) << name;
    EXPECT_LT(number(earlier[1], name), number(whole.summary, name)) << name;
  }
  double before = 0.0;
  double all = 0.0;
  for (const char* phase : kPhaseNames) {
    before += number(earlier[1], std::string("compute.") + phase);
    all += number(whole.summary, std::string("compute.") + phase);
  }
  EXPECT_NEAR(number(earlier[1], "compute_seconds"), number(whole.summary, "compute_seconds") * before / all, 1e-9);
  EXPECT_EQ(cell(earlier[1], "peak_rss_bytes"), "") << "nobody measured it then";
  // Without its times a run is as good as before, but for those.
  write_part(whole.directory, "timing", "");
  const Row untimed = summaries_after(read_recorded_run(test::shared_host(), whole.directory), {9}).front();
  EXPECT_EQ(cell(untimed, "rmse_m"), cell(earlier[1], "rmse_m"));
  EXPECT_EQ(cell(untimed, "compute_seconds"), "");
  EXPECT_EQ(cell(untimed, "compute.infer"), "");
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryKind, Earlier,
    ::testing::Values(std::vector<std::string>{"scene.placement=random"},
                      std::vector<std::string>{"scene=ring", "scene.effects=standard", "seed=3"},
                      std::vector<std::string>{"strategy=weighted", "seed=4"},
                      std::vector<std::string>{"strategy=weighted_two_part", "fitting=ceres", "fitting.every=4"},
                      std::vector<std::string>{"strategy=random", "belief.footprint=gp_classifier"}));

}  // namespace
}  // namespace palpate::test
