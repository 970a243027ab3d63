// SPDX-License-Identifier: MIT
// The table of launchers: one entry per name in palpate_sweep.cmake.
#include "launch/launcher.hpp"

#include <algorithm>
#include <stdexcept>

namespace palpate {

#define PALPATE_LAUNCHER(name, is_cluster) extern const LauncherType name##_launcher;
#include "launch/launcher_table.inc"
#undef PALPATE_LAUNCHER

const LauncherType& launcher_type(const std::string& name) {
  static constexpr std::array kTypes{
#define PALPATE_LAUNCHER(name, is_cluster) &name##_launcher,
#include "launch/launcher_table.inc"
#undef PALPATE_LAUNCHER
  };
  const auto found = std::find(kLaunchers.begin(), kLaunchers.end(), name);
  if (found == kLaunchers.end()) throw std::logic_error("there is no launcher '" + name + "'");
  return *kTypes[static_cast<std::size_t>(found - kLaunchers.begin())];
}

}  // namespace palpate
