// SPDX-License-Identifier: MIT
#include "config/hash.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate {

std::string hash_of(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::string hash_of_file(const std::filesystem::path& file) {
  // Mapped, not read: the program hashes itself at every run, and copying its megabytes costs more than hashing them.
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status {};
  if (descriptor < 0 || ::fstat(descriptor, &status) != 0) {
    if (descriptor >= 0) ::close(descriptor);
    throw Error(file.string(), "cannot be read");
  }
  const auto size = static_cast<std::size_t>(status.st_size);
  void* bytes = size == 0 ? nullptr : ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, descriptor, 0);
  ::close(descriptor);
  if (bytes == MAP_FAILED) throw Error(file.string(), "cannot be read");
  std::string hash = hash_of({static_cast<const char*>(bytes), size});
  if (bytes != nullptr) ::munmap(bytes, size);
  return hash;
}

}  // namespace palpate
