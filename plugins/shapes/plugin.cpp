// SPDX-License-Identifier: MIT
// The older spelling of a shape of one's own, `{type: plugin, shape: {type: torus, ...}}` for `{type: torus, ...}`:
// recorded runs have it.
#include <palpate/plugin.hpp>
#include <palpate/shape.hpp>

namespace palpate::shapes {

struct PluginOptions : Options {
  PluginChoice shape{"shape", {}, nullptr};

  void list(Fields& fields) override { fields.plugin(shape, Field("shape", "of the object").needed()); }
};

class Plugin final : public Shape {
 public:
  using Options = PluginOptions;
  Plugin(const Options& options, const Context& context) : shape_(context.create<const Shape>(options.shape)) {}

  double first_intersection(const Line& line) const override { return shape_->first_intersection(line); }
  std::vector<Stretch> intervals(const Line& line) const override { return shape_->intervals(line); }
  double support(const Eigen::Vector3d& direction) const override { return shape_->support(direction); }
  double top(double s, double t) const override { return shape_->top(s, t); }

 private:
  std::shared_ptr<const Shape> shape_;
};

PALPATE_PLUGIN(Shape, Plugin, "plugin", "another shape, {type: ..., ...}: its type alone says the same, more shortly")

}  // namespace palpate::shapes
