// SPDX-License-Identifier: MIT
// Work distributed among child processes: each item is done once, and errors are reported.
#include "launch/parallel_children.hpp"
#include "record/files.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

#include <unistd.h>

namespace palpate {
namespace {

TEST(InChildren, DoesEverythingOnceWhateverTheNumberOfWorkers) {
  for (const int workers : {1, 3, 50}) {
    const test::TemporaryFolder folder;
    std::vector<std::size_t> heard;
    const bool all = in_children(
        20, workers,
        [&](std::size_t i) {
          AppendFile(folder.path() / std::to_string(i)).append(std::to_string(::getpid()) + "\n", false);
        },
        nullptr, [&](std::size_t done) { heard.push_back(done); });
    EXPECT_TRUE(all);
    for (int i = 0; i < 20; ++i) {
      const std::string text = read_file(folder.path() / std::to_string(i));
      EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << i;
      EXPECT_NE(text, std::to_string(::getpid()) + "\n") << "not in this process";
    }
    ASSERT_FALSE(heard.empty());
    EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end()));
    EXPECT_EQ(heard.back(), 20U);
  }
}

TEST(InChildren, HasNothingToDoForNothing) {
  EXPECT_TRUE(in_children(
      0, 2, [](std::size_t) { FAIL(); }, nullptr, nullptr));
}

TEST(InChildren, TellsWhatWentWrong) {
  const auto damaged = [](std::size_t i) {
    if (i == 2) throw Error("jobs/x", "is damaged", "remove it");
  };
  const auto share = [&] { in_children(4, 2, damaged, nullptr, nullptr); };
  EXPECT_EQ(test::error_of(share), "jobs/x: is damaged, remove it");
  EXPECT_THAT(share, testing::Throws<Error>(testing::Property(&Error::kind, Error::Kind::run)));
}

TEST(InChildren, NoticesAProcessThatWasKilled) {
  const auto die = [](std::size_t i) {
    if (i == 1) ::raise(SIGKILL);
  };
  EXPECT_THROW(in_children(3, 3, die, nullptr, nullptr), Error);
}

TEST(InChildren, StopsWhenItIsInterrupted) {
  const std::atomic<bool> interrupted{true};
  const auto wait = [](std::size_t) { ::pause(); };
  EXPECT_FALSE(in_children(4, 2, wait, &interrupted, nullptr));
}

}  // namespace
}  // namespace palpate
