// SPDX-License-Identifier: MIT
#include "experiment/room.hpp"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include <malloc.h>
#include <sys/mman.h>

namespace palpate {

void make_room() {
  constexpr std::size_t kRoom = std::size_t{640} << 10U;
  constexpr std::uintptr_t kPage = 4096;
  // What is given back stays. Both are what the C library comes to by itself where much is taken.
  ::mallopt(M_MMAP_THRESHOLD, 32 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 64 << 20);
  void* const room = std::malloc(kRoom);
  if (room == nullptr) return;
  const std::uintptr_t skipped = -reinterpret_cast<std::uintptr_t>(room) % kPage;
  ::madvise(static_cast<char*>(room) + skipped, kRoom - kPage, MADV_POPULATE_WRITE);
  std::free(room);
}

}  // namespace palpate
