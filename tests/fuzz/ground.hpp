// SPDX-License-Identifier: MIT
// What all doors stand on: a folder of this process, the plugins of this build, the shipped configs.
#pragma once

#include "host/plugin_host.hpp"

#include <filesystem>
#include <string>

namespace palpate::fuzz {

/// A folder of this process alone, in memory where there is such a place, gone when the process ends well.
class Ground {
 public:
  Ground();
  ~Ground();
  Ground(const Ground&) = delete;
  Ground& operator=(const Ground&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Takes the place of what was there; makes folders on the way.
  std::filesystem::path write(const std::string& name, const std::string& bytes) const;

 private:
  std::filesystem::path path_;
};

Ground& ground();
const PluginHost& host();
std::filesystem::path shipped_configs();

}  // namespace palpate::fuzz
