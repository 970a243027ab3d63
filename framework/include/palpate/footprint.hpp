// SPDX-License-Identifier: MIT
// Plugin kind `footprint`: probability of an object at each position of the desk.
#pragma once

#include <palpate/options.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A number about a footprint for the record. Four names are diagnostics of factorisations: "jitter" (present variance
/// on the diagonal in addition to the noise), "jitter_raised" (increases of the jitter), "pivoted" (factorisations of
/// independent rows only) and "redundant_taps" (touches that are left out at present). The framework adds them to the
/// diagnostics of the Gaussian processes.
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

  /// Returns whether the probability is the mean of the label GP, clipped to [0, 1]. The framework has this mean, and
  /// then calls none of the methods below.
  virtual bool is_weight() const { return false; }

  /// Adds the next touch. Never throws for numerical reasons.
  virtual void add(const Touch& touch) = 0;

  /// Computes the probability of an object at each of `places`, M x 2 metres: M values in [0, 1]. A footprint may cache
  /// data about the places for the next call.
  virtual void probability(const PointsView& places, VectorOut out) = 0;

  /// Samples outlines from the posterior, at `places`, M x 2 metres. The samples lack objects without a contact that
  /// overlap no known object. Leaves `out` empty if the footprint has no samples.
  virtual void sample(const PointsView& /*places*/, HypothesisSample& out) const { out = {}; }

  /// Computes the probability of a wrong label for each touch so far, in [0, 1], in their order. 0 for a footprint
  /// without a model of label errors.
  virtual void doubt(VectorOut out) const { out.setZero(); }

  /// Changes the positions of the touches so far, one row per touch in their order, metres, to their present positions.
  /// A footprint that models pushes moves touches with the object that was pushed afterwards.
  virtual void current_positions(Points& /*places*/) const {}

  /// Returns the probability of an object of 3 cm or more without a touch; nullopt without a model of such objects. A
  /// stopping rule waits until it is small.
  virtual std::optional<double> undiscovered_probability() const { return std::nullopt; }

  /// Returns numbers for the record, with the same names after every touch.
  virtual std::vector<FootprintNumber> numbers() const { return {}; }

  /// Returns a note for readers of the record, one line; "" for none.
  virtual std::string remark() const { return {}; }
};

}  // namespace palpate
