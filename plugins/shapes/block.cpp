// SPDX-License-Identifier: MIT
#include "solid.hpp"

namespace palpate::shapes {

struct BlockOptions : ExtentOptions {
  BlockOptions() : ExtentOptions(0.12, 0.08, 0.05) {}
};

class Block final : public Shape {
 public:
  using Options = BlockOptions;
  Block(const Options& o, const Context&) : half_length_(o.length / 2), half_width_(o.width / 2), height_(o.height) {}

  double first_intersection(const Line& line) const override {
    Interval inside;
    inside.clip(line.origin.z(), line.direction.z(), 0.0, height_);
    inside.clip(line.origin.x(), line.direction.x(), -half_length_, half_length_);
    inside.clip(line.origin.y(), line.direction.y(), -half_width_, half_width_);
    return inside.first();
  }

  double support(const Eigen::Vector3d& direction) const override {
    return std::abs(direction.x()) * half_length_ + std::abs(direction.y()) * half_width_ +
           std::max(0.0, direction.z() * height_);
  }

 private:
  double half_length_, half_width_, height_;
};

PALPATE_PLUGIN(Shape, Block, "block", "box with a flat top")

}  // namespace palpate::shapes
