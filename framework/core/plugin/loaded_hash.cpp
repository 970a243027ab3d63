// SPDX-License-Identifier: MIT
#include "plugin/loaded_hash.hpp"

#include "config/hash.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

#include <link.h>

namespace palpate {

std::string hash_of_loaded(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  std::string bytes(in ? static_cast<std::size_t>(in.tellg()) : 0, '\0');
  in.seekg(0);
  if (!in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) throw Error(file.string(), "cannot be read");
  const auto part = [&](std::uint64_t offset, std::uint64_t size) {
    if (offset > bytes.size() || size > bytes.size() - offset)
      throw Error(file.string(), "is not a complete shared library", "build or copy it again");
    return std::string_view(bytes).substr(offset, size);
  };
  ElfW(Ehdr) header{};
  std::memcpy(&header, part(0, sizeof header).data(), sizeof header);
  std::vector<ElfW(Phdr)> segments(header.e_phnum);
  std::memcpy(segments.data(), part(header.e_phoff, segments.size() * sizeof(ElfW(Phdr))).data(),
              segments.size() * sizeof(ElfW(Phdr)));
  std::string loaded;
  loaded.reserve(bytes.size());
  for (const ElfW(Phdr) & segment : segments) {
    if (segment.p_type != PT_LOAD) continue;
    // The file's header, which the first segment begins with, says where the section table is.
    const auto begin = std::max<std::uint64_t>(segment.p_offset, sizeof header);
    const auto end = std::max(begin, std::uint64_t{segment.p_offset} + segment.p_filesz);
    loaded += std::to_string(segment.p_vaddr) + ":" + std::to_string(segment.p_flags) + ":";
    loaded += part(begin, end - begin);
  }
  return hash_of(loaded);
}

}  // namespace palpate
