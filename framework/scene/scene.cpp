// SPDX-License-Identifier: MIT
// Objects on a desk as functions of x and y: exact, no meshes, nothing computed but the height that is asked for.
#include "scene/scene_options.hpp"

#include <palpate/error.hpp>
#include <palpate/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Heights of the tops above the desk, s along the length from the centre.
double top(const WaveOptions& wave, double s) {
  return wave.height + wave.amplitude * std::cos(2.0 * kPi * s / wave.period);
}
double top(const SlopeOptions& slope, double s) {
  return slope.low + (slope.high - slope.low) * (s / slope.length + 0.5);
}
double highest(const WaveOptions& wave) { return wave.height + wave.amplitude; }
double highest(const SlopeOptions& slope) { return std::max(slope.low, slope.high); }

using Shape = std::variant<WaveOptions, SlopeOptions>;

Shape shape_of(const ObjectOptions& object) {
  if (object.type == ObjectOptions::Type::wave) return object.wave;
  return object.slope;
}

/// A shape with a rectangular outline, somewhere on the desk.
struct Body {
  Shape shape;
  double half_length;
  double half_width;
  double x, y;  ///< centre
  double cosine, sine;

  void turn(double rotation) {
    cosine = std::cos(rotation);
    sine = std::sin(rotation);
  }

  /// Height above the desk at (px, py): 0 beside the body; its outline belongs to it.
  double height(double px, double py) const {
    const double s = cosine * (px - x) + sine * (py - y);
    const double t = cosine * (py - y) - sine * (px - x);
    if (std::abs(s) > half_length || std::abs(t) > half_width) return 0.0;
    return std::visit([s](const auto& one) { return top(one, s); }, shape);
  }

  /// Half the extents of the outline's bounding box.
  double reach_x() const { return std::abs(cosine) * half_length + std::abs(sine) * half_width; }
  double reach_y() const { return std::abs(sine) * half_length + std::abs(cosine) * half_width; }
};

/// Draws rotation and position until the body lies wholly inside the area: uniform over all such poses.
void place_at_random(Body& body, const Area& area, Random& random, std::size_t number) {
  constexpr int kTries = 100'000;
  for (int i = 0; i < kTries; ++i) {
    body.turn(2.0 * kPi * random.uniform());
    body.x = area.width * random.uniform();
    body.y = area.depth * random.uniform();
    const bool inside = body.x >= body.reach_x() && body.x <= area.width - body.reach_x() && body.y >= body.reach_y() &&
                        body.y <= area.depth - body.reach_y();
    if (inside) return;
  }
  throw Error(fmt::format("scene.objects.{}", number), "does not fit into the area",
              "make the object smaller or the area larger");
}

class Desk final : public Scene {
 public:
  Desk(const SceneOptions& options, std::uint64_t seed)
      : area_{options.area.width, options.area.depth},
        desk_(options.desk),
        margin_(options.on_surface_above),
        effects_(options.effects.values()) {
    for (std::size_t i = 0; i < options.objects.size(); ++i) {
      const ObjectOptions& object = options.objects[i];
      Shape shape = shape_of(object);
      const auto [length, width] = std::visit([](const auto& s) { return std::pair(s.length, s.width); }, shape);
      Body body{std::move(shape), length / 2, width / 2, object.at[0], object.at[1], 1.0, 0.0};
      body.turn(object.rotation);
      if (options.placement == SceneOptions::Placement::random) {
        Random random(seed, "scene/placement", i);
        place_at_random(body, area_, random, i);
      }
      bodies_.push_back(std::move(body));
    }
  }

  Area area() const override { return area_; }
  double desk() const override { return desk_; }

  double height(double x, double y) const override {
    double above = 0.0;
    for (const Body& body : bodies_) above = std::max(above, body.height(x, y));
    return desk_ + above;
  }

  double highest() const override {
    double above = 0.0;
    for (const Body& body : bodies_) {
      above = std::max(above, std::visit([](const auto& s) { return palpate::highest(s); }, body.shape));
    }
    return desk_ + above;
  }

  const Effects& effects() const override { return effects_; }

  bool on_surface(double height) const override { return height > desk_ + margin_; }

 private:
  Area area_;
  double desk_;
  double margin_;
  Effects effects_;
  std::vector<Body> bodies_;
};

}  // namespace

std::unique_ptr<const Scene> build_scene(const SceneOptions& options, std::uint64_t seed) {
  return std::make_unique<Desk>(options, seed);
}

}  // namespace palpate
