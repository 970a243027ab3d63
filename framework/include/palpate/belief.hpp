// SPDX-License-Identifier: MIT
// What the taps so far say, as plugins see it.
#pragma once

#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <vector>

namespace palpate {

/// What there is to read of a belief beside places and counts.
enum class Quantity : unsigned {
  uncertainty = 1,  ///< u
  weight = 2,       ///< w
  probability = 4,  ///< p
  height = 8,       ///< mean and variance
  doubt = 16,       ///< which contacts are believed; nothing that a plugin reads
  outlines = 32,    ///< some of the outlines that p is the mean of
  // From any side, of a SurfaceBelief:
  expected_discovery = 64,  ///< expected_discovery
  deviation = 128,          ///< deviation and incidence_cosine
  std_reduction = 256       ///< std_reduction
};

/// A set of quantities: `Quantity::uncertainty | Quantity::weight`, or {} for none.
class Quantities {
 public:
  constexpr Quantities() = default;
  constexpr Quantities(Quantity one) : bits_(static_cast<unsigned>(one)) {}  // NOLINT: one of them is a set of one
  constexpr bool has(Quantity one) const { return (bits_ & static_cast<unsigned>(one)) != 0; }
  friend constexpr Quantities operator|(Quantities a, Quantities b) {
    a.bits_ |= b.bits_;
    return a;
  }
  friend constexpr bool operator==(Quantities a, Quantities b) { return a.bits_ == b.bits_; }
  friend constexpr bool operator!=(Quantities a, Quantities b) { return a.bits_ != b.bits_; }

 private:
  unsigned bits_ = 0;
};
constexpr Quantities operator|(Quantity a, Quantity b) { return Quantities(a) | Quantities(b); }

/// What is believed after the taps so far, over the candidates. The models behind it are built for those who say that
/// they read them: a plugin may read the quantities of its reads(), and any other throws Error, which names both.
/// References stay valid until the next tap. M is the number of candidates.
class Belief {
 public:
  virtual ~Belief() = default;

  /// M x 2, metres. Fixed for the whole run; ties are broken by the lowest row.
  virtual const Points& candidates() const = 0;
  virtual Area area() const = 0;

  /// Taps made so far, failed ones included, and how many of them the initial design chose.
  virtual int taps() const = 0;
  virtual int initial_taps() const = 0;

  /// Where all taps so far were sent, failed ones included, in their order.
  virtual const std::vector<Target>& targets() const = 0;
  /// Those that made contact, in their order, as they read now: a height may be corrected by what later taps tell.
  virtual const std::vector<Touch>& touches() const = 0;
  /// Over which place the arm stands; none before the first tap.
  std::optional<Target> arm() const {
    return targets().empty() ? std::nullopt : std::optional<Target>(targets().back());
  }

  /// u: variance of the height GP relative to its prior, noise excluded; M values in [0, 1].
  virtual const Eigen::VectorXd& uncertainty() const = 0;
  /// w: mean of the label GP, or that mean clipped to [0, 1] if the config says `label: {clip: true}`.
  /// Unclipped it leaves [0, 1] in nearly every run.
  virtual const Eigen::VectorXd& weight() const = 0;
  /// p: the probability that a candidate is on an object, by the config's footprint; M values in [0, 1].
  virtual const Eigen::VectorXd& probability() const = 0;
  /// Outlines that p is the mean of, some of them: what p alone does not tell, that places are on an object together.
  /// Empty where the footprint has none.
  virtual const OutlineSample& outlines() const = 0;
  /// Mean of the height GP, metres.
  virtual const Eigen::VectorXd& height_mean() const = 0;
  /// Variance of the height GP, noise excluded, square metres.
  virtual const Eigen::VectorXd& height_variance() const = 0;
};

}  // namespace palpate
