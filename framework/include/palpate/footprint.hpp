// SPDX-License-Identifier: MIT
// Plugin kind `footprint`: where on the desk the objects are, as a probability at every place.
#pragma once

#include <palpate/options.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A number that a footprint tells of itself, for the record. Four names say what its factorisations needed: "jitter"
/// (variance on the diagonal beside the noise, as it is now), "jitter_raised" (how often that was raised), "pivoted"
/// (how often independent rows were looked for) and "redundant_taps" (touches that do not enter now). The framework
/// adds them to those of the Gaussian processes.
struct FootprintNumber {
  std::string name;  ///< "label_errors", "acceptance_rate", ... or one of the four
  double value = 0.0;
};

/// What is believed of the outlines after some touches.
///
/// Laws, checked by the contract tests for every footprint found: probabilities are finite and in [0, 1] whatever the
/// touches (none, all alike, contradictory ones at one place, a thousand); the same touches in the same order give the
/// same bytes, however often and where the probability was asked for in between. Anything drawn at random comes from
/// the context's streams.
class Footprint {
 public:
  static constexpr const char* kKind = "footprint";

  virtual ~Footprint() = default;

  /// Whether the probability is the mean of the label GP, clipped to [0, 1], which the framework has already:
  /// then none of the methods below is called.
  virtual bool is_weight() const { return false; }

  /// Takes in the next touch. Never throws for numerical reasons.
  virtual void add(const Touch& touch) = 0;

  /// The probability that each of `places`, M x 2 metres, is on an object: M values in [0, 1]. What is set up for one
  /// set of places may be kept for the next call.
  virtual void probability(const PointsView& places, VectorOut out) = 0;

  /// Some of the outlines that the probability is the mean of, over `places`, M x 2 metres. Objects that overlap no
  /// known one are left out. Leaves `out` empty where there are none.
  virtual void sample(const PointsView& /*places*/, OutlineSample& out) const { out = {}; }

  /// The probability that the label of each touch so far is wrong, in [0, 1], in their order; `out` has as many values.
  /// A footprint that knows nothing of that leaves 0.
  virtual void doubt(VectorOut out) const { out.setZero(); }

  /// Where each touch so far would be made now, a row each in their order, metres; `places` holds where they were made.
  /// A footprint that thinks the objects were pushed since moves those made before along with them.
  virtual void current_positions(Points& /*places*/) const {}

  /// The probability that somewhere lies an object of 3 cm or more that no touch was on; none where it thinks of no
  /// such thing. A run that stops when done waits until it is small.
  virtual std::optional<double> undiscovered_probability() const { return std::nullopt; }

  /// What it has come to, in numbers; the same names at every touch.
  virtual std::vector<FootprintNumber> numbers() const { return {}; }

  /// What somebody who reads the record should know of how it came to this, one line; "" for nothing.
  virtual std::string remark() const { return {}; }
};

}  // namespace palpate
