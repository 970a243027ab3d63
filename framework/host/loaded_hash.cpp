// SPDX-License-Identifier: MIT
#include "host/loaded_hash.hpp"

#include "config/hash.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include <link.h>

namespace palpate {

std::string hash_of_loaded(std::string_view library) {
  ElfW(Ehdr) header{};
  std::memcpy(&header, library.data(), sizeof header);
  std::vector<ElfW(Phdr)> segments(header.e_phnum);
  std::memcpy(segments.data(), library.data() + header.e_phoff, segments.size() * sizeof(ElfW(Phdr)));
  std::string loaded;
  loaded.reserve(library.size());
  for (const ElfW(Phdr) & segment : segments) {
    if (segment.p_type != PT_LOAD) continue;
    // Skip the header of the file, with which the first segment begins. It contains the position of the section table,
    // which changes when a package strips the file.
    const auto begin = std::max<std::uint64_t>(segment.p_offset, sizeof header);
    const auto end = std::max(begin, std::uint64_t{segment.p_offset} + segment.p_filesz);
    loaded += std::to_string(segment.p_vaddr) + ":" + std::to_string(segment.p_flags) + ":";
    loaded += library.substr(begin, end - begin);
  }
  return hash_of(loaded);
}

}  // namespace palpate
