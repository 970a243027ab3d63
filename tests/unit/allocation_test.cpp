// SPDX-License-Identifier: MIT
// What a tap costs in memory: nothing, once the first have made room. Counts every call of malloc in this process.
#include "experiment/experiment.hpp"
#include "support/grids.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <atomic>

namespace {
std::atomic<long> allocations{0};
std::atomic<std::size_t> largest{0};

[[maybe_unused]] void note(std::size_t size) {
  ++allocations;
  if (size > largest) largest = size;
}
}  // namespace

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

// These stand before those of the C library, for it and for every other library too.
void* malloc(std::size_t size) {
  note(size);
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note(count * size);
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  note(size);
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note(size);
  return __libc_memalign(alignment, size);
}
}
#endif

namespace palpate {
namespace {

TEST(Allocation, NoTapOfAnyEngineAllocatesInTheSteadyState) {
  if (test::kSanitized) GTEST_SKIP() << "under a sanitizer the allocator cannot be counted";
  const CandidateGrid candidates = test::grid_by_count({0.23, 0.23}, 60);
  for (const auto kind : {EngineSettings::Kind::dense, EngineSettings::Kind::grid, EngineSettings::Kind::lowrank}) {
    EngineSettings settings;
    settings.engine = kind;
    settings.taps = 80;
    GaussianProcess process(test::make<Kernel>(test::shared_host(), "rbf"),
                            std::vector<GpSettings>(2, {1.0, 1e-2, 0.0, 0.0}), candidates, settings);
    process.show(2);
    Eigen::VectorXd map(candidates.size());
    Random random(1, "allocation_test");
    long before = 0;
    for (int tap = 0; tap < 80; ++tap) {
      if (tap == 2) before = allocations;
      const Target place = candidates.target(static_cast<int>(random.index(3600)));
      process.add(place, Eigen::Vector2d(0.1 * random.uniform(), 1.0));
      process.update_maps();
      process.read_mean(0, map);
      process.read_relative_variance(map);
    }
    EXPECT_EQ(allocations - before, 0) << process.engine().name;
  }
}

/// Looks at the allocations between two taps of the loop.
class Watcher final : public Observer {
 public:
  void announce(const TapRecord&) override {}
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override {
    if (tap.number() > 5) worst_ = std::max(worst_, largest.load());
    largest = 0;
  }
  std::size_t worst() const { return worst_; }

 private:
  std::size_t worst_ = 0;
};

TEST(Allocation, NoTapOfTheLoopAllocatesAMap) {
  if (test::kSanitized) GTEST_SKIP() << "under a sanitizer the allocator cannot be counted";
  for (const char* acquisition : {"acquisition=weighted", "acquisition=uncertainty", "acquisition=random"}) {
    // So many that a truth value for each takes more than the record of a tap.
    test::Prepared prepared("paper/object_i.yaml", {acquisition, "candidates.count=100"});
    Watcher watcher;
    prepared.experiment.run(watcher);
    EXPECT_GT(watcher.worst(), 0U) << "what a tap leaves behind needs some memory";
    EXPECT_LT(watcher.worst(), static_cast<std::size_t>(prepared.grid().size())) << acquisition << ": in bytes";
  }
}

}  // namespace
}  // namespace palpate
