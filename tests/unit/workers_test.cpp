// SPDX-License-Identifier: MIT
#include "gp/workers.hpp"

#include "support/testing.hpp"

#include <palpate/error.hpp>

#include <atomic>
#include <chrono>
#include <thread>

namespace palpate::test {
namespace {

TEST(Workers, DoEveryPieceOfEveryJobOnceBeforeTheyReturn) {
  for (const int threads : {1, 2, 3}) {
    Workers workers(threads);
    ASSERT_EQ(workers.threads(), threads);
    for (int job = 0; job < 300; ++job) {
      const int pieces = job % 40;
      std::vector<int> done(static_cast<std::size_t>(pieces), 0);  // not atomic: each piece belongs to one worker
      std::atomic<int> strangers{0};
      workers.for_each(pieces, [&](int piece, int worker) {
        ++done[static_cast<std::size_t>(piece)];
        if (worker < 0 || worker >= threads) ++strangers;
      });
      EXPECT_EQ(done, std::vector<int>(done.size(), 1)) << "job " << job;
      EXPECT_EQ(strangers, 0);
      // Helpers that have gone to sleep come back.
      if (job % 100 == 99) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  }
}

TEST(Workers, HelpersDoTakePieces) {
  Workers workers(2);
  std::atomic<bool> helped{false};
  // The first piece waits until somebody else has one.
  for (int attempt = 0; attempt < 1000 && !helped; ++attempt) {
    workers.for_each(2, [&](int, int worker) {
      if (worker > 0) helped = true;
      for (int i = 0; i < 100 && !helped; ++i) std::this_thread::yield();
    });
  }
  EXPECT_TRUE(helped);
}

TEST(Workers, HandOnWhatAJobThrowsInAnyThreadAndGoOnAfterwards) {
  for (const int threads : {1, 2, 4}) {
    Workers workers(threads);
    for (int job = 0; job < 100; ++job) {
      EXPECT_EQ(error_of([&] {
                  workers.for_each(20, [&](int piece, int) {
                    if (piece >= job % 20) throw Error("kernel/mine", "it broke", {}, Error::Kind::run);
                  });
                }),
                "kernel/mine: it broke");
    }
    std::atomic<int> done{0};
    workers.for_each(20, [&](int, int) { ++done; });
    EXPECT_EQ(done, 20);
  }
}

TEST(Workers, MayNeverBeGivenAnything) { const Workers workers(4); }

}  // namespace
}  // namespace palpate::test
