// SPDX-License-Identifier: MIT
// Plugin kind `footprint`: probability of an object at each position of the desk.
#pragma once

#include <palpate/options.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A number about a footprint for the record. Four names are diagnostics of factorisations:
///     "jitter"          variance that is currently added to the diagonal besides the noise
///     "jitter_raised"   number of increases of the jitter
///     "pivoted"         number of factorisations of independent rows only
///     "redundant_taps"  number of touches that are currently left out
/// The framework adds these four numbers to the diagnostics of the Gaussian processes.
struct FootprintNumber {
  std::string name;  ///< such as "label_errors", or one of the four names above
  double value = 0.0;
};

/// Posterior of the objects' outlines given some touches.
///
/// Laws, checked by the contract tests for every footprint found: probabilities are finite and in [0, 1] for any
/// touches (none, all equal, contradictory ones at one position, a thousand). The same touches in the same order give
/// the same bytes, also if probabilities were computed in between. Random numbers come from the context's streams.
class Footprint {
 public:
  static constexpr const char* kKind = "footprint";

  virtual ~Footprint() = default;

  /// Returns whether the probability is the mean of the label GP, clipped to [0, 1]. If so, the framework uses this
  /// mean itself and calls none of the methods below.
  virtual bool is_weight() const { return false; }

  /// Adds the next touch. Never throws for numerical reasons.
  virtual void add(const Touch& touch) = 0;

  /// Computes the probability of an object at each of the positions `places` (M x 2, metres): M values in [0, 1]. A
  /// footprint may cache data about the positions for the next call.
  virtual void probability(const PointsView& places, VectorOut out) = 0;

  /// Samples hypotheses of the outlines from the posterior, at the positions `places` (M x 2, metres). An object that
  /// no tap has touched is part of a sample only if it overlaps a known object. Leaves `out` empty if the footprint has
  /// no samples.
  virtual void sample(const PointsView& /*places*/, HypothesisSample& out) const { out = {}; }

  /// Computes for each touch so far, in the order of the touches, the probability in [0, 1] that its label is wrong.
  /// All values are 0 for a footprint without a model of label errors.
  virtual void doubt(VectorOut out) const { out.setZero(); }

  /// Sets `places` to the present positions of the touches: one row per touch, in the order of the touches, metres. On
  /// entry, `places` contains the original positions. If an object was pushed after a touch, a footprint that models
  /// pushes moves the touch with the object.
  virtual void current_positions(Points& /*places*/) const {}

  /// Returns the probability that there is an object of 3 cm or more that no tap has touched; nullopt without a model
  /// of such objects. The stop rule `expected_rmse` requires a small probability.
  virtual std::optional<double> undiscovered_probability() const { return std::nullopt; }

  /// Returns numbers for the record, with the same names after every touch.
  virtual std::vector<FootprintNumber> numbers() const { return {}; }

  /// Returns a note for readers of the record, one line; "" for none.
  virtual std::string remark() const { return {}; }
};

}  // namespace palpate
