// SPDX-License-Identifier: MIT
// The part `scene:` of a config: the area, the desk and the objects on it.
#pragma once

#include "scene/effect_options.hpp"

#include <palpate/options.hpp>
#include <palpate/scene.hpp>

#include <array>
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

struct BlockOptions : Options {
  double length = 0.12;
  double width = 0.08;
  double height = 0.05;
  void list(Fields& fields) override;
};

/// The cap of a ball, at most half of it.
struct DomeOptions : Options {
  double diameter = 0.12;
  double height = 0.04;
  void list(Fields& fields) override;
};

struct CylinderOptions : Options {
  double diameter = 0.08;
  double height = 0.06;
  void list(Fields& fields) override;
};

struct ConeOptions : Options {
  double diameter = 0.12;
  double height = 0.08;
  void list(Fields& fields) override;
};

/// Whole, resting on the desk.
struct EllipsoidOptions : Options {
  double length = 0.14;
  double width = 0.09;
  double height = 0.06;
  void list(Fields& fields) override;
};

/// Two bars: an L or a T.
struct BarsOptions : Options {
  double length = 0.14;
  double width = 0.1;
  double thickness = 0.04;
  double height = 0.05;
  void list(Fields& fields) override;
};

/// Its walls are round.
struct RingOptions : Options {
  double outer = 0.14;
  double inner = 0.06;
  double height = 0.05;
  void list(Fields& fields) override;
};

/// Corners in their order, either way round; the last edge leads back to the first corner.
using Outline = std::vector<std::array<double, 2>>;

struct PolygonOptions : Options {
  Outline outline;
  Outline hole;
  double height = 0.05;
  void list(Fields& fields) override;
};

/// One object: a shape and where it stands.
struct ObjectOptions : Options {
  enum class Type { wave, slope, block, dome, cylinder, cone, ellipsoid, l, t, ring, polygon, mesh, plugin };
  Type type = Type::wave;
  WaveOptions wave;
  SlopeOptions slope;
  BlockOptions block;
  DomeOptions dome;
  CylinderOptions cylinder;
  ConeOptions cone;
  EllipsoidOptions ellipsoid;
  BarsOptions bars;
  RingOptions ring;
  PolygonOptions polygon;
  PluginChoice mesh{"shape", "mesh", nullptr};
  PluginChoice plugin{"shape", {}, nullptr};
  double at[2] = {0.115, 0.115};
  double rotation = 0.0;
  double tilt = 0.0;
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
/// when the objects do not fit into the area; its `where` is the path in the config. `factory` makes the shapes that
/// are plugins, and must outlive the scene; what it throws passes through.
std::unique_ptr<const Scene> build_scene(const SceneOptions& options, std::uint64_t seed, const PluginFactory& factory);

}  // namespace palpate
