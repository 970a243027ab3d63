// SPDX-License-Identifier: MIT
// One door for libFuzzer.
#include "fuzz/harness.hpp"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  palpate::fuzz::PALPATE_DOOR({reinterpret_cast<const char*>(bytes), size});
  return 0;
}
