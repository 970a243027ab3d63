// SPDX-License-Identifier: MIT
// The options of `scene:` in a config: the area, the desk, the objects and the effects.
#pragma once

#include <palpate/effects.hpp>
#include <palpate/options.hpp>
#include <palpate/scene.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace palpate {

class PluginFactory;

struct AreaOptions : Options {
  double width = 0.23;
  double depth = 0.23;
  void list(Fields& fields) override;
};

/// The shape of an object and its pose.
struct ObjectOptions : Options {
  /// The plugin that `type` names. Its options are on the same level as `at`, `rotation` and `tilt`.
  PluginChoice shape{"shape", {}, nullptr};
  double at[2] = {0.115, 0.115};
  double rotation = 0.0;
  double tilt = 0.0;
  void list(Fields& fields) override;
};

/// The options of `scene.effects:`, with one optional group per member of Effects.
struct EffectOptions : Options {
  Effects values;
  void list(Fields& fields) override;
};

struct SceneOptions : Options {
  enum class Placement { fixed, random };
  AreaOptions area;
  double desk = 0.0;
  double min_object_height = 0.01;
  Placement placement = Placement::fixed;
  std::vector<ObjectOptions> objects;
  EffectOptions effects;
  void list(Fields& fields) override;
};

/// Builds the scene. With random placement, `seed` decides position and rotation of each object. `factory` creates the
/// shapes and must outlive the scene; its exceptions are passed on. Throws Error if the objects do not fit into the
/// area; its place is the path in the config.
std::unique_ptr<const Scene> build_scene(const SceneOptions& options, std::uint64_t seed, const PluginFactory& factory);

}  // namespace palpate
