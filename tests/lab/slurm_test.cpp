// SPDX-License-Identifier: MIT
// What Slurm prints and how arrays are described, without Slurm.
#include "launch/slurm.hpp"

#include <palpate/error.hpp>
#include <palpate/random.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace palpate {
namespace {

using slurm::Limits;
using slurm::Part;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The indices in a list, read as the manual of sbatch says.
std::vector<int> listed(const std::string& list) {
  std::vector<int> out;
  std::istringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    const std::size_t dash = part.find('-');
    const int first = std::stoi(part);
    const int last = dash == std::string::npos ? first : std::stoi(part.substr(dash + 1));
    for (int index = first; index <= last; ++index) out.push_back(index);
  }
  return out;
}

TEST(SlurmIndexList, WritesRunsOfIndicesAsRanges) {
  EXPECT_EQ(slurm::index_list({}), "");
  EXPECT_EQ(slurm::index_list({5}), "5");
  EXPECT_EQ(slurm::index_list({0, 1}), "0-1");
  EXPECT_EQ(slurm::index_list({0, 1, 2, 3, 7, 9, 10, 11, 12}), "0-3,7,9-12");
}

TEST(SlurmIndexList, ReadsBackAsWhatItWasMadeOf) {
  Random random(1, "test/slurm");
  for (int round = 0; round < 200; ++round) {
    std::vector<int> indices;
    const double share = random.uniform();
    for (int index = 0; index < 300; ++index) {
      if (random.uniform() < share) indices.push_back(index);
    }
    EXPECT_EQ(listed(slurm::index_list(indices)), indices);
  }
}

TEST(SlurmSplit, GivesEveryTaskOnceWithinTheLimits) {
  Random random(2, "test/slurm");
  for (const Limits limits : {Limits{2, 2}, Limits{7, 3}, Limits{1001, 1001}, Limits{4000001, 50}}) {
    for (int round = 0; round < 50; ++round) {
      std::vector<int> tasks;
      for (int task = 0; task < 3000; ++task) {
        if (random.uniform() < 0.3) tasks.push_back(task);
      }
      std::vector<int> given;
      for (const Part& part : slurm::split(tasks, limits)) {
        ASSERT_FALSE(part.indices.empty());
        EXPECT_LE(static_cast<int>(part.indices.size()), limits.tasks);
        for (const int index : part.indices) {
          EXPECT_GE(index, 0);
          EXPECT_LT(index, limits.indices);
          given.push_back(part.offset + index);
        }
      }
      EXPECT_EQ(given, tasks);
    }
  }
}

TEST(SlurmSplit, TakesNoMoreArraysThanItNeeds) {
  EXPECT_THAT(slurm::split({}, {10, 10}), IsEmpty());
  EXPECT_EQ(slurm::split({0, 5, 9}, {10, 10}).size(), 1U);
  EXPECT_EQ(slurm::split({9, 10}, {10, 10}).size(), 2U);
  const std::vector<Part> far = slurm::split({25, 27}, {10, 10});
  ASSERT_EQ(far.size(), 1U);
  EXPECT_EQ(far[0].offset, 20);
  EXPECT_THAT(far[0].indices, ElementsAre(5, 7));
}

TEST(SlurmSplit, KeepsListsShortEnoughForACommandLine) {
  std::vector<int> tasks;
  for (int task = 0; task < 200000; task += 2) tasks.push_back(task);
  std::vector<int> given;
  for (const Part& part : slurm::split(tasks, {4000001, 4000001})) {
    EXPECT_LT(slurm::index_list(part.indices).size(), 20000U);
    for (const int index : part.indices) given.push_back(part.offset + index);
  }
  EXPECT_EQ(given, tasks);
  std::vector<int> run;
  for (int task = 0; task < 200000; ++task) run.push_back(task);
  EXPECT_EQ(slurm::split(run, {4000001, 4000001}).size(), 1U) << "one range, however long";
}

TEST(SlurmLimits, AreReadFromTheConfigOfTheController) {
  const Limits plain = slurm::parse_limits("Configuration data\nMaxArraySize            = 1001\nMaxJobCount = 10000\n");
  EXPECT_EQ(plain.indices, 1001);
  EXPECT_EQ(plain.tasks, 1001);
  const Limits fewer = slurm::parse_limits(
      "MaxArraySize            = 100001\nSchedulerParameters     = bf_interval=1,max_array_tasks=500,defer\n");
  EXPECT_EQ(fewer.indices, 100001);
  EXPECT_EQ(fewer.tasks, 500);
  EXPECT_EQ(slurm::parse_limits("max_array_tasks=5000\nMaxArraySize=100").tasks, 100);
}

TEST(SlurmLimits, RefuseWhatSaysNothingOfThem) {
  for (const char* text : {"", "\n\n", "MaxArraySize", "MaxArraySize =", "MaxArraySize = many", "MaxArraySize = -1",
                           "MaxArraySize = 99999999999999", "MaxArraySize: 5"}) {
    EXPECT_THROW(slurm::parse_limits(text), Error) << text;
  }
  for (const char* text : {"MaxArraySize = 0", "MaxArraySize = 1"}) {
    try {
      slurm::parse_limits(text);
      ADD_FAILURE() << text;
    } catch (const Error& trouble) {
      EXPECT_THAT(trouble.what(), HasSubstr("this cluster takes no arrays"));
    }
  }
}

TEST(SlurmNodes, AreReadByPartitionAndGarbageIsSkipped) {
  const auto nodes = slurm::parse_nodes("CLUSTER: far\nsweep*|8\nsweep*|64\nlong|128\n\n|4\nodd|8+\nodd|-2\na|b|3\n");
  ASSERT_EQ(nodes.size(), 3U);
  EXPECT_EQ(nodes[0].partition, "sweep");
  EXPECT_TRUE(nodes[0].is_default);
  EXPECT_EQ(nodes[1].cpus, 64);
  EXPECT_EQ(nodes[2].partition, "long");
  EXPECT_FALSE(nodes[2].is_default);
}

TEST(SlurmQueue, IsReadByTaskAndGarbageIsSkipped) {
  const auto tasks =
      slurm::parse_queue("CLUSTER: far\n7|0|R\n7|12|PD\n7|13|CG\n8|N/A|R\n\n|||\n7|[14-20]|PD\n7|5\n7|-3|R\nx|1|R\n");
  ASSERT_EQ(tasks.size(), 3U);
  EXPECT_EQ(tasks[0].array, 7);
  EXPECT_EQ(tasks[0].index, 0);
  EXPECT_FALSE(tasks[0].waiting);
  EXPECT_EQ(tasks[1].index, 12);
  EXPECT_TRUE(tasks[1].waiting);
  EXPECT_FALSE(tasks[2].waiting) << "about to end";
  EXPECT_THAT(slurm::parse_queue(std::string("7|1|R\0|", 7) + std::string(100000, '|')), IsEmpty());
}

TEST(SlurmArrayId, IsFoundAmongWhatASiteHasToSay) {
  EXPECT_EQ(slurm::parse_array_id("123\n"), 123);
  EXPECT_EQ(slurm::parse_array_id("123;cluster\n"), 123);
  EXPECT_EQ(slurm::parse_array_id("sbatch: warning: 5 hours will be charged\n123\nsbatch: thank you\n"), 123);
  for (const char* text : {"", "Submitted batch job 5", "12x", "-4", "99999999999999"})
    EXPECT_EQ(slurm::parse_array_id(text), std::nullopt) << text;
}

TEST(SlurmWords, AreOneLine) {
  EXPECT_EQ(slurm::words_of("sbatch: error: invalid partition specified: nope\nsbatch: error: Batch job submission "
                            "failed: Invalid partition name specified\n"),
            "invalid partition specified: nope; Batch job submission failed: Invalid partition name specified");
  EXPECT_EQ(slurm::words_of("\n  \n"), "failed and says nothing");
  EXPECT_EQ(slurm::words_of("slurm_load_jobs error: Invalid user\n"), "slurm_load_jobs error: Invalid user");
}

}  // namespace
}  // namespace palpate
