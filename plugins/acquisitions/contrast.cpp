// SPDX-License-Identifier: MIT
// From any side, tap where what is believed falls apart: of each pair of compositions how far their surfaces are apart
// times the probability that the tap tells which of them is wrong; and, along normals, how far from all touches that
// is.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <cmath>

namespace palpate::acquisitions {

struct ContrastOptions : Options {
  double sharpness = 0.004;
  double skin = 1.0;
  void list(Fields& fields) override {
    fields.real(
        sharpness,
        Field("sharpness", "difference of two meetings that a tap tells apart in most cases").in(Unit::metre).above(0));
    fields.real(skin, Field("skin", "what the most uncertain place is worth, where it is poked along its normal")
                          .in(Unit::metre)
                          .at_least(0));
  }
};

class Contrast final : public Acquisition {
 public:
  using Options = ContrastOptions;
  Contrast(const Options& options, const Context&) : options_(options) {}

  bool from_above() const override { return false; }
  bool any_side() const override { return true; }
  Quantities reads() const override { return {}; }
  Quantities reads_of_approaches() const override { return Quantity::meetings | Quantity::deviation; }
  void score(const Belief&, VectorOut out) const override { out.setZero(); }
  double prior_scale() const override { return 0.02; }

  void score_approaches(const SurfaceBelief& belief, VectorOut out) const override {
    const Eigen::MatrixXd& meetings = belief.meetings();
    const Eigen::MatrixXd& differences = belief.differences();
    const Eigen::Index count = meetings.cols();
    const double pairs = 0.5 * static_cast<double>(count * (count - 1));
    const double scale = 0.5 / (options_.sharpness * options_.sharpness);
    const double most = belief.deviation().maxCoeff();
    constexpr double kAlong = 0.999;
    const double weight = most > 0.0 ? options_.skin / most : 0.0;
    out = (belief.squareness().array() > kAlong).select(weight * belief.deviation().array(), 0.0);
    for (Eigen::Index k = 0; k < count; ++k) {
      for (Eigen::Index j = 0; j < k; ++j) {
        const double worth = differences(k, j) / pairs;
        if (worth == 0.0) continue;
        out.array() += worth * (1.0 - (-scale * (meetings.col(k) - meetings.col(j)).array().square()).exp());
      }
    }
  }

 private:
  Options options_;
};

PALPATE_PLUGIN(Acquisition, Contrast, "contrast", "from any side, tap where what is believed falls apart")

}  // namespace palpate::acquisitions
