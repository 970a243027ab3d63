// SPDX-License-Identifier: MIT
// What Slurm prints, without Slurm.
#include "launch/slurm.hpp"

#include "support/testing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(SlurmLimits, AreReadFromTheConfigOfTheController) {
  EXPECT_EQ(slurm::parse_most_tasks("Configuration data\nMaxArraySize            = 1001\nMaxJobCount = 10000\n"), 1001);
  EXPECT_EQ(slurm::parse_most_tasks("MaxArraySize            = 100001\n"
                                    "SchedulerParameters     = bf_interval=1,max_array_tasks=500,defer\n"),
            500);
  EXPECT_EQ(slurm::parse_most_tasks("max_array_tasks=5000\nMaxArraySize=100"), 100);
}

TEST(SlurmLimits, RefuseWhatSaysNothingOfThem) {
  for (const char* text : {"", "\n\n", "MaxArraySize", "MaxArraySize =", "MaxArraySize = many", "MaxArraySize = -1",
                           "MaxArraySize = 99999999999999", "MaxArraySize: 5"}) {
    EXPECT_THROW(slurm::parse_most_tasks(text), Error) << text;
  }
  for (const char* text : {"MaxArraySize = 0", "MaxArraySize = 1"}) {
    EXPECT_THAT(test::error_of([&] { slurm::parse_most_tasks(text); }),
                HasSubstr("this cluster accepts no job arrays"));
  }
}

TEST(SlurmNodes, AreReadByPartitionAndGarbageIsSkipped) {
  const char* const lines = "CLUSTER: far\nsweep*|8\nsweep*|64\nsweep*|9\nlong|128\n\n|4\nodd|8+\nodd|-2\na|b|3\n";
  EXPECT_EQ(slurm::parse_most_cpus(lines, ""), 64);
  EXPECT_EQ(slurm::parse_most_cpus(lines, "sweep"), 64);
  EXPECT_EQ(slurm::parse_most_cpus(lines, "long"), 128);
  for (const char* unknown : {"odd", "a", "sweep*", "nowhere"})
    EXPECT_EQ(slurm::parse_most_cpus(lines, unknown), 0) << unknown;
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
  EXPECT_EQ(slurm::words_of("\n  \n"), "failed without a message");
  EXPECT_EQ(slurm::words_of("slurm_load_jobs error: Invalid user\n"), "slurm_load_jobs error: Invalid user");
}

}  // namespace
}  // namespace palpate
