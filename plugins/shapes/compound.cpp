// SPDX-License-Identifier: MIT
// One rigid object that consists of several shapes, for example a mug of ring, bottom and handle.
#include "solid.hpp"

#include <palpate/math.hpp>

#include <memory>
#include <vector>

namespace palpate::shapes {

struct PartOptions : Options {
  PluginChoice shape{"shape", {}, nullptr};
  double at[2] = {0.0, 0.0};
  double rotation = 0.0;

  void list(Fields& fields) override {
    fields.adopt(shape, Field("type", "shape of the part").needed());
    fields.reals(at, 2,
                 Field("at",
                       "x, y of the part's centre. The centre is the middle of the rectangle around the part's outline "
                       "before the part is rotated. The rectangle around all parts is centred at the object's `at`")
                     .in(Unit::metre));
    fields.real(
        rotation,
        Field("rotation", "counter-clockwise rotation of the part about the vertical axis through the part's `at`")
            .in(Unit::radian));
  }
};

struct CompoundOptions : Options {
  std::vector<PartOptions> parts;

  void list(Fields& fields) override {
    fields.sections(parts, Field("parts",
                                 "list of parts, each {type: ..., at: [...], rotation: ...}. Where parts overlap, the "
                                 "highest part is the surface")
                               .needed());
    fields.require(!parts.empty(), "parts", "needs at least one part");
  }
};

class Compound final : public Shape {
 public:
  using Options = CompoundOptions;
  Compound(const Options& options, const Context& context) {
    for (const PartOptions& one : options.parts)
      parts_.push_back({context.create<const Shape>(one.shape),
                        {one.at[0], one.at[1], 0.0},
                        math::cos(one.rotation),
                        math::sin(one.rotation)});
    const Vector3d centre{(support({1, 0, 0}) - support({-1, 0, 0})) / 2,
                          (support({0, 1, 0}) - support({0, -1, 0})) / 2, 0.0};
    for (Part& part : parts_) part.at -= centre;
  }

  double first_intersection(const Line& line) const override {
    double first = kInfinity;
    for (const Part& part : parts_)
      first = std::min(
          first, part.shape->first_intersection({part.turned(line.origin - part.at), part.turned(line.direction)}));
    return first;
  }

  std::vector<LineInterval> intervals(const Line& line) const override {
    std::vector<LineInterval> all;
    for (const Part& part : parts_) {
      const std::vector<LineInterval> one =
          part.shape->intervals({part.turned(line.origin - part.at), part.turned(line.direction)});
      all.insert(all.end(), one.begin(), one.end());
    }
    return joined(std::move(all));
  }

  double support(const Vector3d& direction) const override {
    double most = -kInfinity;
    for (const Part& part : parts_)
      most = std::max(most, direction.dot(part.at) + part.shape->support(part.turned(direction)));
    return most;
  }

  double top(double s, double t) const override {
    double highest = -kInfinity;
    for (const Part& part : parts_) {
      const Vector3d place = part.turned({s - part.at.x(), t - part.at.y(), 0.0});
      highest = std::max(highest, part.shape->top(place.x(), place.y()));
    }
    return highest;
  }

 private:
  struct Part {
    std::shared_ptr<const Shape> shape;
    Vector3d at;
    double cosine, sine;

    /// Converts a vector from the frame of the object to the frame of the part.
    Vector3d turned(const Vector3d& v) const {
      return {cosine * v.x() + sine * v.y(), cosine * v.y() - sine * v.x(), v.z()};
    }
  };

  std::vector<Part> parts_;
};

PALPATE_PLUGIN(Shape, Compound, "compound", "several shapes that form one object")

}  // namespace palpate::shapes
