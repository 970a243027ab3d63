// SPDX-License-Identifier: MIT
// Expected reduction of the total variance of the footprint by one tap. The entropy of a position measures only the
// uncertainty at this position. The sampled outlines also show how much a tap at this position determines other
// positions.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "acquisitions/variance_reduction.cpp"
#include "math/highway.hpp"

// The loop is compiled for each instruction set. It spends most of its time on bit counting, for which some instruction
// sets have an instruction.
HWY_BEFORE_NAMESPACE();
namespace palpate::acquisitions::HWY_NAMESPACE {
namespace {

/// Computes the number of common bits of `here` and each of `count` other rows. A row has `words` words.
void count_common(const std::uint64_t* here, std::ptrdiff_t words, const std::uint64_t* others, std::ptrdiff_t count,
                  int* out) {
  for (std::ptrdiff_t i = 0; i < count; ++i, others += words) {
    int sum = 0;
    for (std::ptrdiff_t word = 0; word < words; ++word) sum += __builtin_popcountll(here[word] & others[word]);
    out[i] = sum;
  }
}

}  // namespace
}  // namespace palpate::acquisitions::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace palpate::acquisitions {

namespace {

/// Bits for pairs of an outline and a position: 1 if the outline covers the position. There is one column per position.
using Words = Eigen::Matrix<std::uint64_t, Eigen::Dynamic, Eigen::Dynamic>;
using Counts = Eigen::Array<int, Eigen::Dynamic, 1>;

/// Returns for each position how many of the outlines whose bit is set in `here` cover it.
Counts common(const std::uint64_t* here, const Words& holds) {
  Counts out(holds.cols());
  PALPATE_DISPATCH(count_common)(here, holds.rows(), holds.data(), holds.cols(), out.data());
  return out;
}

/// Returns at most `most` elements of `all`, evenly spaced.
std::vector<int> sample_of(const std::vector<int>& all, std::size_t most) {
  const std::size_t step = (all.size() + most - 1) / most;
  std::vector<int> out;
  for (std::size_t i = step / 2; i < all.size(); i += step) out.push_back(all[i]);
  return out;
}

}  // namespace

/// Let S outlines be sampled, of which n_c cover a position c. If the prediction at c is n_c / S, its expected squared
/// error is n_c * (S - n_c) / S^2. Let n_x outlines cover a position x, and n_xc outlines both positions. A tap at x
/// shows whether x is covered. On average it reduces the squared error at c by
///     (n_xc - n_x * n_c / S)^2 / (n_x * (S - n_x))     (the reduction of a variance by a covariance).
/// The sum over all positions is an area, like the expected area of new objects. The score is the sum of both, divided
/// by the largest such sum, so that its maximum is 1.
///
/// On desks larger than kUsualSide, more objects are possible, and the weight of new objects grows with the side
/// length. Otherwise the last objects would be found late or never, while known outlines are refined to the millimetre.
/// On such desks the largest score may exceed 1 by up to the same factor, so that this acquisition keeps its weight in
/// sums with other acquisitions. Benefits and costs: framework/docs/clutter.md.
struct VarianceReductionOptions : Options {
  double new_object_weight = 1.5;
  void list(Fields& fields) override {
    fields.real(new_object_weight,
                Field("new_object_weight",
                      "weight of the discovery of new objects, for an area of 23 cm x 23 cm. For other areas, the "
                      "weight is scaled with the side length. The refinement of known outlines has the weight 1")
                    .at_least(0));
  }
};

class VarianceReduction final : public Acquisition {
 public:
  using Options = VarianceReductionOptions;
  VarianceReduction(const Options& options, const Context& context)
      : options_(options), area_(context.scene.area().width * context.scene.area().depth) {}

  QuantitySet reads() const override { return {quantity::kObjectProbability, quantity::kHypotheses}; }

  void score(const BeliefView& belief, VectorOut out) const override {
    const HypothesisSample& sample = belief.hypotheses();
    if (sample.count == 0) {
      // Without hypotheses, a tap informs only about its own position.
      const Eigen::ArrayXd p = belief.values(quantity::kObjectProbability).array();
      out = p * (1.0 - p);
      return divide_by(out.maxCoeff(), out);
    }
    const double larger = std::max(1.0, std::sqrt(area_) / kUsualSide);
    out = options_.new_object_weight * larger * sample.expected_discovery_area;
    const double settled = add_reductions(sample, area_ / static_cast<double>(out.size()), out);
    divide_by(settled > 0.0 ? std::max(settled, out.maxCoeff() / larger) : out.maxCoeff(), out);
  }

  double prior_scale() const override { return 1.0; }

 private:
  static constexpr double kUsualSide = 0.23;  // side of the area for which `new_object_weight` is stated, metres

  static void divide_by(double most, VectorOut out) {
    if (most > 0.0) out /= most;
  }

  /// Adds the variance reductions for known objects to `out`, and returns the largest of them.
  static double add_reductions(const HypothesisSample& sample, double extent_of_place, VectorOut out) {
    const std::vector<std::uint64_t> all(static_cast<std::size_t>(sample.holds.rows()), ~std::uint64_t{0});
    const Counts held = common(all.data(), sample.holds);
    std::vector<int> open;  // positions that some outlines cover and others do not
    for (int i = 0; i < held.size(); ++i) {
      if (held(i) > 0 && held(i) < sample.count) open.push_back(i);
    }
    // On a fine grid, a subset of the positions and of the taps suffices.
    constexpr std::size_t kPlaces = 128;
    constexpr std::size_t kTaps = 512;
    const std::vector<int> places = sample_of(open, kPlaces);
    if (places.empty()) return 0.0;
    const double each = extent_of_place * static_cast<double>(open.size()) / static_cast<double>(places.size());
    const Words others = sample.holds(Eigen::all, places);
    const Eigen::ArrayXd held_by = held(places).cast<double>();
    double most = 0.0;
    for (const int x : sample_of(open, kTaps)) {
      const double of_x = held(x);
      const Eigen::ArrayXd covariances =
          common(sample.holds.col(x).data(), others).cast<double>() - of_x / sample.count * held_by;
      const double settled = each * covariances.square().sum() / (of_x * (sample.count - of_x));
      most = std::max(most, settled);
      out(x) += settled;
    }
    return most;
  }

  Options options_;
  double area_;  ///< area of the desk, square metres
};

PALPATE_PLUGIN(Acquisition, VarianceReduction, "variance_reduction",
               "expected reduction of the footprint's variance by one tap, plus discovery of new objects")

}  // namespace palpate::acquisitions
#endif
