// SPDX-License-Identifier: MIT
// The part `scene:` of a config: the area, the desk and the objects on it.
#pragma once

#include "scene/effect_options.hpp"

#include <palpate/options.hpp>
#include <palpate/scene.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace palpate {

struct AreaOptions : Options {
  double width = 0.23;
  double depth = 0.23;
  void list(Fields& fields) override;
};

/// A block whose top is a wave along its length: the paper's object I.
struct WaveOptions : Options {
  double length = 0.16;
  double width = 0.06;
  double height = 0.09;
  double amplitude = 0.02;
  double period = 0.08;
  void list(Fields& fields) override;
};

/// A block whose top rises along its length: the paper's object II.
struct SlopeOptions : Options {
  double length = 0.17;
  double width = 0.06;
  double low = 0.02;
  double high = 0.08;
  void list(Fields& fields) override;
};

/// One object: a shape and where it stands.
struct ObjectOptions : Options {
  enum class Type { wave, slope };
  Type type = Type::wave;
  WaveOptions wave;
  SlopeOptions slope;
  double at[2] = {0.115, 0.115};
  double rotation = 0.0;
  void list(Fields& fields) override;
};

struct SceneOptions : Options {
  enum class Placement { fixed, random };
  AreaOptions area;
  double desk = 0.0;
  double on_surface_above = 0.01;
  Placement placement = Placement::fixed;
  std::vector<ObjectOptions> objects;
  EffectOptions effects;
  void list(Fields& fields) override;
};

/// Builds the world. With random placement `seed` decides where each object stands and how it is turned; throws Error
/// when an object does not fit into the area; its `where` is the object's path in the config.
std::unique_ptr<const Scene> build_scene(const SceneOptions& options, std::uint64_t seed);

}  // namespace palpate
