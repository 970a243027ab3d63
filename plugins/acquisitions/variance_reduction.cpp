// SPDX-License-Identifier: MIT
// A look ahead: how much less uncertain the outline is expected to be after a tap there, in all places together. The
// entropy of a place says how little is known of it; what that place tells of the others is in the outlines alone.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace palpate::acquisitions {

#if defined(__x86_64__) && !defined(__SANITIZE_THREAD__)  // which has not begun when one is chosen
// Bits are counted by as many at a time as the machine can: nothing else is as much of the work.
#define PALPATE_COUNTS_BITS __attribute__((target_clones("avx2", "default")))
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

/// Some places, of which the same word of many lies side by side: covariances with several are computed at once.
struct Others {
  static constexpr int kAtOnce = 4;

  Others(const Words& holds, const std::vector<int>& held, const std::vector<int>& places)
      : words(static_cast<int>(holds.rows())),
        length((static_cast<int>(places.size()) + kAtOnce - 1) / kAtOnce * kAtOnce),
        bits(static_cast<std::size_t>(words * length), 0),
        held_by(static_cast<std::size_t>(length), 0.0) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      held_by[i] = held[static_cast<std::size_t>(places[i])];
      for (int word = 0; word < words; ++word)
        bits[static_cast<std::size_t>(word * length) + i] = holds(word, places[i]);
    }
  }

  int words;
  int length;                       ///< whole multiples of kAtOnce; places that no outline holds fill it up
  std::vector<std::uint64_t> bits;  ///< words x length
  std::vector<double> held_by;      ///< outlines
};

/// See squares(). Of so many words: a number that the compiler knows is a loop less.
template <class Count>
__attribute__((always_inline)) inline double squares_of(const std::uint64_t* here, double share, const Others& others,
                                                        Count words) {
  using Bits = std::uint64_t __attribute__((vector_size(8 * Others::kAtOnce)));
  using Reals = double __attribute__((vector_size(8 * Others::kAtOnce)));
  constexpr int kWords = 16;  // of so many the bits of a byte are counted within a byte
  Reals sum{};
  for (int from = 0; from < others.length; from += Others::kAtOnce) {
    Bits both{};
    for (int first = 0; first < words; first += kWords) {
      Bits bytes{};
      for (int word = first; word < std::min<int>(first + kWords, words); ++word) {
        Bits bits;
        std::memcpy(&bits, others.bits.data() + static_cast<std::ptrdiff_t>(word) * others.length + from, sizeof(bits));
        bits &= here[word];
        bits -= (bits >> 1) & 0x5555555555555555U;
        bits = (bits & 0x3333333333333333U) + ((bits >> 2) & 0x3333333333333333U);
        bytes += (bits + (bits >> 4)) & 0x0F0F0F0F0F0F0F0FU;
      }
      bytes = (bytes & 0x00FF00FF00FF00FFU) + ((bytes >> 8) & 0x00FF00FF00FF00FFU);
      bytes += bytes >> 16;
      both += (bytes + (bytes >> 32)) & 0xFFFFU;
    }
    // As fractions of 2^52, of which whole numbers are the last bits.
    both |= 0x4330000000000000U;
    Reals covariance;
    Reals of_others;
    std::memcpy(&covariance, &both, sizeof(covariance));
    std::memcpy(&of_others, &others.held_by[static_cast<std::size_t>(from)], sizeof(of_others));
    covariance = covariance - 0x1.0p52 - share * of_others;
    sum += covariance * covariance;
  }
  return sum[0] + sum[1] + (sum[2] + sum[3]);
}

/// The sum of the squares of the covariances of one place with others, times the number of outlines.
PALPATE_COUNTS_BITS double squares(const std::uint64_t* here, int held, int outlines, const Others& others) {
  const double share = static_cast<double>(held) / outlines;
  constexpr int kUsual = 4;  // words
  if (others.words == kUsual) return squares_of(here, share, others, std::integral_constant<int, kUsual>());
  return squares_of(here, share, others, others.words);
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
    const std::vector<int> held = count(sample.holds);
    std::vector<int> open;  // places that are not settled
    for (std::size_t i = 0; i < held.size(); ++i) {
      if (held[i] > 0 && held[i] < sample.count) open.push_back(static_cast<int>(i));
    }
    // On a fine grid a part of the places tells as well as all, and one in some is tapped as well as all.
    constexpr std::size_t kPlaces = 128;
    constexpr std::size_t kTaps = 512;
    const std::vector<int> places = some_of(open, kPlaces);
    if (places.empty()) return 0.0;
    const double each = extent_of_place * static_cast<double>(open.size()) / static_cast<double>(places.size());
    const Others others(sample.holds, held, places);
    double most = 0.0;
    for (const int x : some_of(open, kTaps)) {
      const int of_x = held[static_cast<std::size_t>(x)];
      const double settled = each * squares(sample.holds.col(x).data(), of_x, sample.count, others) /
                             (static_cast<double>(of_x) * (sample.count - of_x));
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
