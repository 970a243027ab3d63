// SPDX-License-Identifier: MIT
// The scene: objects on a desk, whose heights are computed on demand.
#include "scene/body.hpp"
#include "scene/placement.hpp"
#include "scene/scene_options.hpp"

#include <palpate/plugin.hpp>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

namespace palpate {
namespace {

class DeskScene final : public Scene {
 public:
  DeskScene(const SceneOptions& options, std::uint64_t seed, const PluginFactory& factory)
      : area_{options.area.width, options.area.depth},
        desk_(options.desk),
        margin_(options.min_object_height),
        effects_(options.effects.values),
        context_{factory, *this, seed, nullptr} {
    // While the shapes are created, the scene to which their context refers has no bodies yet.
    std::vector<Body> bodies;
    for (const ObjectOptions& object : options.objects) {
      bodies.emplace_back(context_.create<const Shape>(object.shape), object.tilt);
      bodies.back().place(object.at[0], object.at[1], object.rotation);
    }
    if (options.placement == SceneOptions::Placement::random) {
      place_at_random(bodies, area_, seed);
    } else {
      check_inside(bodies, area_);
    }
    bodies_ = std::move(bodies);
  }

  Area area() const override { return area_; }
  double desk() const override { return desk_; }

  double height(double x, double y) const override {
    double above = 0.0;
    for (const Body& body : bodies_) above = std::max(above, body.height(x, y));
    return desk_ + above;
  }

  double min_object_height() const override { return margin_; }

  double first_intersection(const Line& line) const override {
    const Line above{line.origin - Eigen::Vector3d(0.0, 0.0, desk_), line.direction};
    double first = std::numeric_limits<double>::infinity();
    for (const Body& body : bodies_) first = std::min(first, body.first_intersection(above));
    return first;
  }

  std::vector<LineInterval> intervals(const Line& line) const override {
    const Line above{line.origin - Eigen::Vector3d(0.0, 0.0, desk_), line.direction};
    std::vector<LineInterval> all;
    for (const Body& body : bodies_) {
      const std::vector<LineInterval> one = body.intervals(above);
      all.insert(all.end(), one.begin(), one.end());
    }
    return joined(std::move(all));
  }

  double highest() const override {
    double above = 0.0;
    for (const Body& body : bodies_) above = std::max(above, body.highest());
    return desk_ + above;
  }

  const Effects& effects() const override { return effects_; }

  bool on_object(double height) const override { return height > desk_ + margin_; }

  int objects() const override { return static_cast<int>(bodies_.size()); }

  int object(double x, double y) const override {
    double above = 0.0;
    int out = kNoObject;
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const double height = bodies_[i].height(x, y);
      if (height <= above) continue;
      above = height;
      out = static_cast<int>(i);
    }
    return out;
  }

  std::unique_ptr<const Scene> after(int taps) const override {
    if (!effects_.push) return nullptr;
    std::vector<Body> bodies = bodies_;
    if (!push_about(bodies, area_, *effects_.push, context_.seed, taps)) return nullptr;
    auto out = std::make_unique<DeskScene>(*this);
    out->bodies_ = std::move(bodies);
    return out;
  }

 private:
  Area area_;
  double desk_;
  double margin_;
  Effects effects_;
  Context context_;  ///< declared before bodies_, because it must outlive the plugins in bodies_
  std::vector<Body> bodies_;
};

}  // namespace

std::unique_ptr<const Scene> build_scene(const SceneOptions& options, std::uint64_t seed,
                                         const PluginFactory& factory) {
  return std::make_unique<DeskScene>(options, seed, factory);
}

}  // namespace palpate
