// SPDX-License-Identifier: MIT
// Parallel reading of jobs, with results in the order of the jobs.
#include "sweep/read_jobs.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>

namespace palpate {
namespace {

Sweep sweep_of(int jobs) {
  Sweep out{"folder", {}, {}};
  for (int job = 0; job < jobs; ++job) out.jobs.push_back({job, std::to_string(job), {}});
  return out;
}

int number_of_job(const std::filesystem::path& directory) { return std::stoi(directory.filename().string()); }

TEST(ReadJobs, HandsThemOverInTheirOrderAndEachWithWhatWasRead) {
  for (const int count : {0, 1, 31, 255, 256, 257, 1000}) {
    const Sweep sweep = sweep_of(count);
    std::vector<std::size_t> every_other;
    for (const std::size_t job : all_jobs(sweep)) {
      if (job % 2 == 0) every_other.push_back(job);
    }
    const auto read = [](const std::filesystem::path& directory) {
      const int number = number_of_job(directory);
      if (number % 7 == 0) std::this_thread::yield();  // lets later jobs finish earlier
      return 3 * number;
    };
    std::vector<std::size_t> order;
    read_jobs(sweep, every_other, read, [&](std::size_t job, int result) {
      EXPECT_EQ(result, 3 * static_cast<int>(job));
      order.push_back(job);
    });
    EXPECT_EQ(order, every_other) << count << " jobs";
  }
}

TEST(ReadJobs, ReadsOneWhileAnotherIsWaitedFor) {
  const Sweep sweep = sweep_of(1000);
  std::mutex mutex;
  std::condition_variable second_came;
  int inside = 0;
  bool together = false;
  const auto read = [&](const std::filesystem::path&) {
    std::unique_lock<std::mutex> lock(mutex);
    together = together || ++inside > 1;
    second_came.notify_all();
    // The wait ends at once, unless the jobs are read one after the other.
    const bool came = second_came.wait_for(lock, std::chrono::minutes(1), [&] { return together; });
    --inside;
    if (!came) throw std::runtime_error("the jobs are read one by one");
    return 0;
  };
  read_jobs(sweep, all_jobs(sweep), read, [](std::size_t, int) {});
  EXPECT_TRUE(together);
}

TEST(ReadJobs, ThrowsOfTheFirstThatCannotBeReadAndHandsOverAllBeforeIt) {
  const Sweep sweep = sweep_of(1000);
  const auto read = [](const std::filesystem::path& directory) {
    const int number = number_of_job(directory);
    if (number == 700 || number == 703 || number == 999) throw Error(directory.string(), "cannot be read");
    return number;
  };
  int handed_over = 0;
  const std::string error =
      test::error_of([&] { read_jobs(sweep, all_jobs(sweep), read, [&](std::size_t, int) { ++handed_over; }); });
  EXPECT_EQ(error, "folder/jobs/700: cannot be read");
  EXPECT_EQ(handed_over, 700);
}

}  // namespace
}  // namespace palpate
