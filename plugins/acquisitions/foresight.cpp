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

namespace palpate::acquisitions {

#if defined(__x86_64__)
// Bits are counted by the machine where it can: nothing else is as much of the work.
#define PALPATE_COUNTS_BITS __attribute__((target_clones("popcnt", "default")))
#else
#define PALPATE_COUNTS_BITS
#endif

namespace {

using Words = Eigen::Matrix<std::uint64_t, Eigen::Dynamic, Eigen::Dynamic>;

/// How many outlines hold each place.
PALPATE_COUNTS_BITS std::vector<int> count(const Words& holds) {
  std::vector<int> out(static_cast<std::size_t>(holds.cols()), 0);
  for (Eigen::Index i = 0; i < holds.cols(); ++i) {
    for (Eigen::Index word = 0; word < holds.rows(); ++word)
      out[static_cast<std::size_t>(i)] += __builtin_popcountll(holds(word, i));
  }
  return out;
}

/// The sum of the squares of the covariances of one place with others, times the number of outlines.
PALPATE_COUNTS_BITS double squares(const Words& holds, int outlines, const std::vector<int>& held, int one,
                                   const std::vector<int>& others) {
  double sum = 0.0;
  const double share = static_cast<double>(held[static_cast<std::size_t>(one)]) / outlines;
  const std::uint64_t* here = holds.col(one).data();
  for (const int other : others) {
    const std::uint64_t* there = holds.col(other).data();
    int both = 0;
    for (Eigen::Index word = 0; word < holds.rows(); ++word) both += __builtin_popcountll(here[word] & there[word]);
    const double covariance = both - share * held[static_cast<std::size_t>(other)];
    sum += covariance * covariance;
  }
  return sum;
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
struct ForesightOptions : Options {
  double find = 1.5;
  void list(Fields& fields) override {
    fields.real(find, Field("find",
                            "what the extent of something new is worth, beside as much that is settled of what "
                            "is known")
                          .at_least(0));
  }
};

class Foresight final : public Acquisition {
 public:
  using Options = ForesightOptions;
  Foresight(const Options& options, const Context&) : options_(options) {}

  Quantities reads() const override { return Quantity::probability | Quantity::outlines; }

  void score(const Belief& belief, VectorOut out) const override {
    const OutlineSample& sample = belief.outlines();
    if (sample.count == 0) {
      // Nothing is known of how places go together: each tells of itself.
      out = belief.probability().array() * (1.0 - belief.probability().array());
    } else {
      look_ahead(sample, belief.area().width * belief.area().depth / static_cast<double>(out.size()), out);
    }
    const double most = out.maxCoeff();
    if (most > 0.0) out /= most;
  }

  double prior_scale() const override { return 1.0; }

 private:
  void look_ahead(const OutlineSample& sample, double extent_of_place, VectorOut out) const {
    const std::vector<int> held = count(sample.holds);
    std::vector<int> open;  // places that are not settled
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (held[i] > 0 && held[i] < sample.count) open.push_back(static_cast<int>(i));
    }
    // On a fine grid a part of the places tells as well as all, and one in some is tapped as well as all.
    constexpr std::size_t kPlaces = 128;
    constexpr std::size_t kTaps = 512;
    const std::vector<int> places = some_of(open, kPlaces);
    out = options_.find * sample.to_find;
    if (places.empty()) return;
    const double each = extent_of_place * static_cast<double>(open.size()) / static_cast<double>(places.size());
    for (const int x : some_of(open, kTaps)) {
      const double of_x = held[static_cast<std::size_t>(x)];
      out(x) += each * squares(sample.holds, sample.count, held, x, places) / (of_x * (sample.count - of_x));
    }
  }

  Options options_;
};

PALPATE_PLUGIN(Acquisition, Foresight, "foresight", "tap where most is learnt of all outlines together")

}  // namespace palpate::acquisitions
