// SPDX-License-Identifier: MIT
// The part `scene:` of a config: the area, the desk and the objects on it.
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

/// One object: a shape and where it stands.
struct ObjectOptions : Options {
  PluginChoice shape{"shape", {}, nullptr};  ///< chosen by `type`, its options beside those below
  double at[2] = {0.115, 0.115};
  double rotation = 0.0;
  double tilt = 0.0;
  void list(Fields& fields) override;
};

/// One group for each member of Effects, absent by default.
struct EffectOptions : Options {
  Effects values;
  void list(Fields& fields) override;
};

struct SceneOptions : Options {
  enum class Placement { fixed, random };
  enum class Touch { top, any };
  AreaOptions area;
  double desk = 0.0;
  double min_object_height = 0.01;
  Touch touch = Touch::top;
  Placement placement = Placement::fixed;
  std::vector<ObjectOptions> objects;
  EffectOptions effects;
  void list(Fields& fields) override;
};

/// Builds the world. With random placement `seed` decides where each object stands and how it is turned; throws Error
/// when the objects do not fit into the area; its `where` is the path in the config. `factory` makes the
/// shapes, and must outlive the scene; what it throws passes through.
std::unique_ptr<const Scene> build_scene(const SceneOptions& options, std::uint64_t seed, const PluginFactory& factory);

}  // namespace palpate
