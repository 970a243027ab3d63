// SPDX-License-Identifier: MIT
// A look ahead: how much less uncertain the outline is expected to be after a tap there, in all places together. The
// entropy of a place says how little is known of it; what that place tells of the others is in the outlines alone.
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

// Compiled for each set of instructions, since most of the work is the counting of bits, for which some have one.
HWY_BEFORE_NAMESPACE();
namespace palpate::acquisitions::HWY_NAMESPACE {
namespace {

/// How many bits of `here` are set as well in each of some others: `words` words each, one after the other.
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

/// A place a column, an outline a bit: whether the outline holds the place.
using Words = Eigen::Matrix<std::uint64_t, Eigen::Dynamic, Eigen::Dynamic>;
using Counts = Eigen::Array<int, Eigen::Dynamic, 1>;

/// How many outlines hold each of some places, and `here` as well.
Counts common(const std::uint64_t* here, const Words& holds) {
  Counts out(holds.cols());
  PALPATE_DISPATCH(count_common)(here, holds.rows(), holds.data(), holds.cols(), out.data());
  return out;
}

/// At most so many, evenly among all.
std::vector<int> some_of(const std::vector<int>& all, std::size_t most) {
  const std::size_t step = (all.size() + most - 1) / most;
  std::vector<int> out;
  for (std::size_t i = step / 2; i < all.size(); i += step) out.push_back(all[i]);
  return out;
}

}  // namespace

/// With n of S outlines that hold a place c, the square that is expected of the error there, if p is shown, is
/// n (S - n) / S^2. Of these n_x hold x and n_xc both: a tap at x tells whether x is held, and then the square is less
/// by
///     (n_xc - n_x n_c / S)^2 / (n_x (S - n_x))     (what a covariance takes off a variance),
/// whichever it is. Summed up over all places it is an extent, as is what a tap is expected to find that nobody has
/// touched; the score is the sum of both over the largest such sum: 1 where most is learnt.
///
/// On a larger desk, where more things may be, to find them comes first: otherwise the last of them are found late, or
/// never, while each known outline is settled to the millimetre. There something new is worth more by as much as the
/// sides of the desk are longer, and where most is to be found the score goes up to that, so that it is heard beside
/// others that know of outlines alone. What that brings and costs: framework/docs/clutter.md.
struct ForesightOptions : Options {
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
  using Options = ForesightOptions;
  VarianceReduction(const Options& options, const Context&) : options_(options) {}

  Quantities reads() const override { return Quantity::probability | Quantity::outlines; }

  void score(const Belief& belief, VectorOut out) const override {
    const OutlineSample& sample = belief.outlines();
    if (sample.count == 0) {
      // Nothing is known of how places go together: each tells of itself.
      out = belief.probability().array() * (1.0 - belief.probability().array());
      return divide_by(out.maxCoeff(), out);
    }
    const double area = belief.area().width * belief.area().depth;
    const double larger = std::max(1.0, std::sqrt(area) / kUsualSide);
    out = options_.new_object_weight * larger * sample.to_find;
    const double settled = look_ahead(sample, area / static_cast<double>(out.size()), out);
    divide_by(settled > 0.0 ? std::max(settled, out.maxCoeff() / larger) : out.maxCoeff(), out);
  }

  double prior_scale() const override { return 1.0; }

 private:
  static constexpr double kUsualSide = 0.23;  // metres, of the desk that `new_object_weight` is for

  static void divide_by(double most, VectorOut out) {
    if (most > 0.0) out /= most;
  }

  /// Adds what is settled of what is known, and returns the most of it.
  static double look_ahead(const OutlineSample& sample, double extent_of_place, VectorOut out) {
    const std::vector<std::uint64_t> all(static_cast<std::size_t>(sample.holds.rows()), ~std::uint64_t{0});
    const Counts held = common(all.data(), sample.holds);
    std::vector<int> open;  // places that are not settled
    for (int i = 0; i < held.size(); ++i) {
      if (held(i) > 0 && held(i) < sample.count) open.push_back(i);
    }
    // On a fine grid a part of the places tells as well as all, and one in some is tapped as well as all.
    constexpr std::size_t kPlaces = 128;
    constexpr std::size_t kTaps = 512;
    const std::vector<int> places = some_of(open, kPlaces);
    if (places.empty()) return 0.0;
    const double each = extent_of_place * static_cast<double>(open.size()) / static_cast<double>(places.size());
    const Words others = sample.holds(Eigen::all, places);
    const Eigen::ArrayXd held_by = held(places).cast<double>();
    double most = 0.0;
    for (const int x : some_of(open, kTaps)) {
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
};

PALPATE_PLUGIN(Acquisition, VarianceReduction, "variance_reduction",
               "expected reduction of the footprint's variance by one tap, plus discovery of new objects")

}  // namespace palpate::acquisitions
#endif
