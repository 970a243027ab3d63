// SPDX-License-Identifier: MIT
#include "sweep/draft.hpp"

#include "config/yaml.hpp"
#include "record/run.hpp"

#include "support/field_table.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

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
                      [&](const Job& job, const ResolvedConfig& config) {
                        draft.add(job, config);
                        texts_.push_back(to_yaml_with_places(config.tree));
                      });
  }

  std::vector<std::string> texts_;  ///< configs of all planned jobs
  TemporaryFolder folder_;
  fs::path runs_ = folder_.path() / "runs";
  Composer composer_{source_folder() / "configs", config_keys()};
};

TEST(JobFields, AreWhatTheTableOfTheFormatSays) {
  EXPECT_THAT(text_of(source_folder() / "runs/README.md"), testing::HasSubstr(test::table_of(job_list())));
}

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
    // The config has the origin of each value before a job runs.
    EXPECT_EQ(text_of(job_directory(sweep, sweep.jobs[i]) / "config.yaml"), texts_[i]);
    EXPECT_THAT(texts_[i], testing::HasSubstr("configs/scene/object_i.yaml:"));
  }
}

/// Returns the error of reading a sweep; "accepted" if there is none.
std::string refusal(const fs::path& directory) {
  return test::error_of([&] { read_sweep(directory); });
}

class PublishedDraft : public Draft {
 protected:
  PublishedDraft() {
    SweepDraft draft(runs_);
    const SweepPlan planned = plan(draft);
    draft.publish(planned);
    directory_ = planned.sweep.directory;
    manifest_ = text_of(directory_ / "manifest.jsonl");
  }
  void write(const std::string& manifest) const { write_file(directory_ / "manifest.jsonl", manifest); }

  fs::path directory_;
  std::string manifest_;
};

TEST_F(PublishedDraft, IsRefusedOnceAnyBitOfItsManifestHasChanged) {
  ASSERT_EQ(refusal(directory_), "accepted");
  for (std::size_t at = 0; at < manifest_.size(); ++at) {
    std::string changed = manifest_;
    changed[at] = static_cast<char>(static_cast<unsigned char>(changed[at]) ^ (1U << (at % 7)));
    write(changed);
    EXPECT_NE(refusal(directory_), "accepted") << "byte " << at;
  }
}

TEST_F(PublishedDraft, IsRefusedWithoutOneOfItsLinesOrInAnotherOrder) {
  const std::size_t first = manifest_.find('\n') + 1;
  const std::size_t second = manifest_.find('\n', first) + 1;
  write(manifest_.substr(0, manifest_.rfind('\n', manifest_.size() - 2) + 1));
  EXPECT_THAT(refusal(directory_), testing::HasSubstr("was changed after this sweep started"));
  write(manifest_.substr(first));
  EXPECT_THAT(refusal(directory_),
              testing::HasSubstr("manifest.jsonl:1: is not a job of this sweep, the file is damaged"));
  write(manifest_.substr(first, second - first) + manifest_.substr(0, first) + manifest_.substr(second));
  EXPECT_THAT(refusal(directory_),
              testing::HasSubstr("manifest.jsonl:1: is not a job of this sweep, the file is damaged"));
}

TEST_F(PublishedDraft, HasNoJobWhoseFolderIsElsewhereThoughTheIdsAreMadeToFit) {
  for (const char* id : {"../../victim", "..", "", "0123456789a", "0123456789abc", "0123456789AB"}) {
    Sweep sweep{directory_, {"seed"}, {{0, id, {"0"}}}};
    write(manifest_text(sweep, sweep_id(read_run_config(directory_), sweep)));
    EXPECT_THAT(refusal(directory_), testing::HasSubstr("manifest.jsonl:1: is not a job of this sweep")) << id;
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
