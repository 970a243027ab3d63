// SPDX-License-Identifier: MIT
#include "belief/height_map.hpp"
#include "host/builtin.hpp"

namespace palpate {

const std::vector<PluginManifest>& builtin_plugins() {
  static const std::vector<PluginManifest> all{
      manifest_of<Belief, HeightMapBelief>("height_map", "one height per position on the desk, for taps from above")};
  return all;
}

}  // namespace palpate
