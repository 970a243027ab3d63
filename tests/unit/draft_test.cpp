// SPDX-License-Identifier: MIT
#include "sweep/draft.hpp"

#include "config/yaml.hpp"

#include "support/runs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

namespace palpate {
namespace {

using test::source_folder;
using test::TemporaryFolder;
using test::text_of;

namespace fs = std::filesystem;

std::vector<std::string> names_in(const fs::path& folder) {
  std::vector<std::string> out;
  for (const auto& entry : fs::directory_iterator(folder)) out.push_back(entry.path().filename().string());
  return out;
}

class Draft : public testing::Test {
 protected:
  /// Plans three seeds of the paper's experiment into `draft`.
  SweepPlan plan(SweepDraft& draft) {
    return plan_sweep(composer_, test::shared_host(), source_folder() / "configs/paper/object_i.yaml",
                      {"seed=range(0,3)", "kernel=rbf,matern52"}, runs_,
                      [&](const Job& job, const ResolvedConfig& config) { draft.add(job, config); });
  }

  TemporaryFolder folder_;
  fs::path runs_ = folder_.path() / "runs";
  Composer composer_{source_folder() / "configs"};
};

TEST_F(Draft, AppearsUnderItsNameAtOnceAndWhole) {
  std::optional<SweepDraft> draft(runs_);
  const SweepPlan planned = plan(*draft);
  EXPECT_FALSE(fs::exists(planned.sweep.directory));
  EXPECT_TRUE(draft->publish(planned));
  draft.reset();
  EXPECT_THAT(names_in(runs_), testing::ElementsAre("object_i"));
  const Sweep sweep = read_sweep(planned.sweep.directory);
  ASSERT_EQ(sweep.jobs.size(), 6U);
  EXPECT_EQ(sweep.keys, planned.sweep.keys);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(sweep.jobs[i].id, planned.sweep.jobs[i].id);
    EXPECT_EQ(sweep.jobs[i].values, planned.sweep.jobs[i].values);
    // Written key by key, it is what the config would be written as in one piece.
    EXPECT_EQ(text_of(job_directory(sweep, sweep.jobs[i]) / "config.yaml"),
              to_yaml(planned_config(planned, composer_, test::shared_host(), i).tree));
  }
}

TEST_F(Draft, ASweepThatExistsIsLeftAlone) {
  for (const bool is_new : {true, false}) {
    SweepDraft draft(runs_);
    const SweepPlan planned = plan(draft);
    EXPECT_EQ(draft.publish(planned), is_new);
    if (is_new) folder_.write(fs::relative(planned.sweep.directory / "mine.txt", folder_.path()).string(), "kept");
    EXPECT_EQ(text_of(planned.sweep.directory / "mine.txt"), "kept");
  }
  EXPECT_THAT(names_in(runs_), testing::ElementsAre("object_i"));
}

TEST_F(Draft, WhatIsNotPublishedVanishesWithTheFolderThatWasMadeForIt) {
  { const SweepDraft draft(runs_); }
  EXPECT_FALSE(fs::exists(runs_));
  fs::create_directory(runs_);
  { const SweepDraft draft(runs_); }
  EXPECT_TRUE(fs::is_empty(runs_));
}

TEST_F(Draft, ThoseOfKilledProcessesAreRemovedAndThoseOfLivingOnesAreNot) {
  const auto old = fs::file_time_type::clock::now() - std::chrono::hours(1);
  const SweepDraft living(runs_);
  const std::string of_living = names_in(runs_).front();
  fs::last_write_time(runs_ / of_living / "lock", old);
  fs::last_write_time(folder_.write("runs/.sweep-killed/lock", ""), old);
  folder_.write("runs/.sweep-young/lock", "");
  folder_.write("runs/sweep-mine/lock", "");
  { const SweepDraft other(runs_); }
  EXPECT_THAT(names_in(runs_), testing::UnorderedElementsAre(of_living, ".sweep-young", "sweep-mine"));
}

}  // namespace
}  // namespace palpate
