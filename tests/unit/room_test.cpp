// SPDX-License-Identifier: MIT
#include "experiment/room.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <memory>
#include <thread>

#include <sys/mman.h>
#include <sys/resource.h>

namespace palpate {
namespace {

bool system_makes_pages_at_once() {
  constexpr std::size_t kPage = 4096;
  void* const page = ::mmap(nullptr, kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  const bool out = ::madvise(page, kPage, MADV_POPULATE_WRITE) == 0;
  ::munmap(page, kPage);
  return out;
}

long faults_of_this_thread() {
  rusage usage{};
  ::getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt;
}

/// Takes half a megabyte in blocks, gives it back, and does so again.
long faults_of_half_a_megabyte_twice() {
  const long before = faults_of_this_thread();
  for (int time = 0; time < 2; ++time) {
    std::vector<std::unique_ptr<char[]>> blocks(128);
    for (std::unique_ptr<char[]>& one : blocks) {
      one = std::make_unique<char[]>(4096);
      EXPECT_EQ(one[4095], 0);
    }
  }
  return faults_of_this_thread() - before;
}

TEST(Room, OfARunIsTakenWithoutAFaultForEachPageAndStays) {
  if (test::kSanitized) GTEST_SKIP() << "a sanitizer has an allocator of its own";
  if (!system_makes_pages_at_once()) GTEST_SKIP() << "this system makes pages when they are touched only";
  long without = 0;
  long with = 0;
  std::thread([&] { without = faults_of_half_a_megabyte_twice(); }).join();
  std::thread([&] {
    make_room();
    with = faults_of_half_a_megabyte_twice();
  }).join();
  if (without < 100) GTEST_SKIP() << "the tests before this one, in the same process, have left enough";
  EXPECT_LT(with, 20);
}

}  // namespace
}  // namespace palpate
