// SPDX-License-Identifier: MIT
#include "sweep/plan.hpp"

#include "config/yaml.hpp"
#include "record/session.hpp"

#include "support/field_table.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using test::source_folder;
using test::TemporaryFolder;
using test::text_of;

namespace fs = std::filesystem;

class SweepDirectory : public testing::Test {
 protected:
  /// Plans three seeds of the paper's experiment with two kernels.
  SweepPlan plan() {
    texts_.clear();
    return plan_sweep(composer_, test::shared_host(), source_folder() / "configs/paper/object_i.yaml",
                      {"seed=range(0,3)", "kernel=rbf,matern52"}, runs_, [&](const Job&, const ResolvedConfig& config) {
                        texts_.push_back(to_yaml_with_places(config.tree));
                      });
  }

  std::vector<std::string> texts_;  ///< of the configs of all jobs that were planned
  TemporaryFolder folder_;
  fs::path runs_ = folder_.path() / "runs";
  Composer composer_{source_folder() / "configs", config_keys()};
};

TEST(JobFields, AreWhatTheTableOfTheFormatSays) {
  EXPECT_THAT(text_of(source_folder() / "runs/README.md"), testing::HasSubstr(test::table_of(job_list())));
}

TEST_F(SweepDirectory, HasTheConfigOfEachJobBeforeAnyOfThemRuns) {
  const SweepPlan planned = plan();
  EXPECT_FALSE(fs::exists(runs_)) << "planning leaves nothing";
  EXPECT_TRUE(write_sweep(planned, texts_));
  const Sweep sweep = read_sweep(planned.sweep.directory);
  ASSERT_EQ(sweep.jobs.size(), 6U);
  EXPECT_EQ(sweep.keys, planned.sweep.keys);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(sweep.jobs[i].id, planned.sweep.jobs[i].id);
    EXPECT_EQ(sweep.jobs[i].values, planned.sweep.jobs[i].values);
    // With the origin of each value, before any of them has run.
    EXPECT_EQ(text_of(job_directory(sweep, sweep.jobs[i]) / "config.yaml"), texts_[i]);
    EXPECT_THAT(texts_[i], testing::HasSubstr("configs/scene/object_i.yaml:"));
  }
}

/// Why a sweep is not read; "accepted" if it is.
std::string refusal(const fs::path& directory) {
  return test::error_of([&] { read_sweep(directory); });
}

class WrittenSweep : public SweepDirectory {
 protected:
  WrittenSweep() {
    const SweepPlan planned = plan();
    write_sweep(planned, texts_);
    directory_ = planned.sweep.directory;
    manifest_ = text_of(directory_ / "manifest.jsonl");
  }
  void write(const std::string& manifest) const { write_file(directory_ / "manifest.jsonl", manifest); }

  fs::path directory_;
  std::string manifest_;
};

TEST_F(WrittenSweep, IsRefusedOnceAnyBitOfItsManifestHasChanged) {
  ASSERT_EQ(refusal(directory_), "accepted");
  for (std::size_t at = 0; at < manifest_.size(); ++at) {
    std::string changed = manifest_;
    changed[at] = static_cast<char>(static_cast<unsigned char>(changed[at]) ^ (1U << (at % 7)));
    write(changed);
    EXPECT_NE(refusal(directory_), "accepted") << "byte " << at;
  }
}

TEST_F(WrittenSweep, IsRefusedWithoutOneOfItsLinesOrInAnotherOrder) {
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

TEST_F(WrittenSweep, HasNoJobWhoseFolderIsElsewhereThoughTheIdsAreMadeToFit) {
  for (const char* id : {"../../victim", "..", "", "0123456789a", "0123456789abc", "0123456789AB"}) {
    Sweep sweep{directory_, {"seed"}, {{0, id, {"0"}}}};
    write(manifest_text(sweep, sweep_id(read_run_config(directory_), sweep)));
    EXPECT_THAT(refusal(directory_), testing::HasSubstr("manifest.jsonl:1: is not a job of this sweep")) << id;
  }
}

TEST_F(WrittenSweep, IsLeftAloneByTheNextButForLostConfigs) {
  folder_.write(fs::relative(directory_ / "mine.txt", folder_.path()).string(), "kept");
  const SweepPlan planned = plan();
  const fs::path config = job_directory(planned.sweep, planned.sweep.jobs[2]) / "config.yaml";
  fs::remove(config);
  const auto stamp = fs::last_write_time(directory_ / "manifest.jsonl");
  EXPECT_FALSE(write_sweep(planned, texts_));
  EXPECT_EQ(text_of(directory_ / "mine.txt"), "kept");
  EXPECT_EQ(text_of(config), texts_[2]);
  EXPECT_EQ(fs::last_write_time(directory_ / "manifest.jsonl"), stamp);
}

TEST_F(WrittenSweep, IsCompletedAfterAKillBeforeItsManifest) {
  fs::remove(directory_ / "manifest.jsonl");
  fs::remove(directory_ / "config.yaml");
  EXPECT_THAT(refusal(directory_), testing::HasSubstr("is not the directory of a sweep"));
  EXPECT_TRUE(write_sweep(plan(), texts_));
  EXPECT_EQ(refusal(directory_), "accepted");
}

TEST_F(WrittenSweep, IsNotWrittenThroughALink) {
  fs::remove_all(directory_ / "jobs");
  fs::create_directory(folder_.path() / "elsewhere");
  fs::create_directory_symlink(folder_.path() / "elsewhere", directory_ / "jobs");
  EXPECT_THAT(test::error_of([&] { write_sweep(plan(), texts_); }), testing::HasSubstr("is a symbolic link"));
  EXPECT_TRUE(fs::is_empty(folder_.path() / "elsewhere"));
}

}  // namespace
}  // namespace palpate
