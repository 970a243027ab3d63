// SPDX-License-Identifier: MIT
// Baseline that taps the centres of the cells of a coarse lattice, row by row. Lattices with twice as many points per
// side follow.
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
            .within(1, 1000)
            .from("4 x 4 covers an area within the 14 taps of the paper, nearly"));
  }
};

class GridSearch final : public Acquisition {
 public:
  using Options = GridOptions;
  GridSearch(const Options& options, const Context& context) : count_(options.count), area_(context.scene.area()) {}

  QuantitySet reads() const override { return {quantity::kDeskPosition}; }
  /// Scores a candidate by its distance from the next lattice point. The score is 1 at this point and decreases
  /// linearly with the distance. It would be 0 at a distance of the area's diagonal. The nearest candidate has the
  /// highest score.
  void score(const BeliefView& belief, VectorOut out) const override {
    const auto [x, y] = due(belief.taps().count - belief.taps().initial);
    const Points3& places = belief.candidates().starts;
    const double diagonal = math::hypot(area_.width, area_.depth);
    out = 1.0 - ((places.col(0).array() - x).square() + (places.col(1).array() - y).square()).sqrt() / diagonal;
  }
  double prior_scale() const override { return 1.0; }

 private:
  /// Returns the lattice point of tap `n`, where `n` counts the taps after the initial ones from 0.
  Target due(std::int64_t n) const {
    std::int64_t side = count_;
    while (n >= side * side) {
      n -= side * side;
      side *= 2;
    }
    const auto cell = [side](std::int64_t i, double extent) {
      return (static_cast<double>(i) + 0.5) * extent / static_cast<double>(side);
    };
    return {cell(n % side, area_.width), cell(n / side, area_.depth)};
  }

  std::int64_t count_;
  Area area_;
};

PALPATE_PLUGIN(Acquisition, GridSearch, "grid", "points of a lattice, row by row, as a baseline")

}  // namespace palpate::acquisitions
