// SPDX-License-Identifier: MIT
#include "fuzz/ground.hpp"

#include <fstream>
#include <stdexcept>

#include <unistd.h>

namespace palpate::fuzz {

namespace fs = std::filesystem;

Ground::Ground() {
  std::error_code none;
  const fs::path memory = "/dev/shm";
  std::string name =
      ((fs::is_directory(memory, none) ? memory : fs::temp_directory_path()) / "palpate-fuzz-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  path_ = name;
}

Ground::~Ground() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path Ground::write(const std::string& name, const std::string& bytes) const {
  fs::path file = path_ / name;
  std::error_code there;
  fs::create_directories(file.parent_path(), there);
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
  return file;
}

Ground& ground() {
  static Ground one;
  return one;
}

const PluginHost& host() {
  static const PluginHost one({fs::path(PALPATE_BUILD_FOLDER) / "lib" / "palpate"});
  return one;
}

fs::path shipped_configs() { return fs::path(PALPATE_SOURCE_FOLDER) / "configs"; }

}  // namespace palpate::fuzz
