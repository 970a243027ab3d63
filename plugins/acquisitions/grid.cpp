// SPDX-License-Identifier: MIT
// Baseline: centres of the cells of a coarse lattice, row by row, then of lattices with twice as many points per side.
#include <palpate/acquisition.hpp>
#include <palpate/math.hpp>
#include <palpate/plugin.hpp>

#include <cmath>

namespace palpate::acquisitions {

struct GridOptions : Options {
  std::int64_t count = 4;

  void list(Fields& fields) override {
    fields.integer(
        count,
        Field("count",
              "number of points per side of the first lattice. Each further lattice has twice as many points per side")
            .at_least(1)
            .at_most(1000)
            .from("4 x 4 covers an area within the 14 taps of the paper, nearly"));
  }
};

class GridSearch final : public Acquisition {
 public:
  using Options = GridOptions;
  GridSearch(const Options& options, const Context&) : count_(options.count) {}

  Quantities reads() const override { return {}; }
  /// Returns 1 at the next point, decreasing to 0 at the area's far corner. The nearest candidate has the highest
  /// score.
  void score(const Belief& belief, VectorOut out) const override {
    const Area area = belief.area();
    const auto [x, y] = due(belief.taps() - belief.initial_taps(), area);
    const Points& places = belief.candidates();
    const double diagonal = math::hypot(area.width, area.depth);
    out = 1.0 - ((places.col(0).array() - x).square() + (places.col(1).array() - y).square()).sqrt() / diagonal;
  }
  double prior_scale() const override { return 1.0; }

 private:
  /// Returns the position of tap `n`, counted from 0 after the initial taps.
  Target due(std::int64_t n, const Area& area) const {
    std::int64_t side = count_;
    while (n >= side * side) {
      n -= side * side;
      side *= 2;
    }
    const auto cell = [side](std::int64_t i, double extent) {
      return (static_cast<double>(i) + 0.5) * extent / static_cast<double>(side);
    };
    return {cell(n % side, area.width), cell(n / side, area.depth)};
  }

  std::int64_t count_;
};

PALPATE_PLUGIN(Acquisition, GridSearch, "grid", "points of a lattice, row by row, as a baseline")

}  // namespace palpate::acquisitions
