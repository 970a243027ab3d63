// SPDX-License-Identifier: MIT
// What chooses: the initial design or the search, then the acquisition's scores, ties, and the fallback where the
// scores say nothing.
#pragma once

#include "experiment/pace.hpp"
#include "experiment/policy.hpp"
#include "experiment/search.hpp"
#include "experiment/tap_belief.hpp"
#include "experiment/tap_record.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace palpate {

/// A choice that is not the strategy's: scores of somebody else, one a candidate, or the choice that scores had led to
/// which cannot be asked for again, and of which the record tells what they would.
struct Wish {
  Eigen::VectorXd scores;           ///< finite; empty if there is a `choice`
  std::optional<TapRecord> choice;  ///< candidate, source, why, and all about its score
};

/// Chooses one tap after the other. It is told where was tapped and reads the rest in the belief: what was hit, too, as
/// it is thought now.
class Chooser {
 public:
  /// All must outlive it. Throws Error for an acquisition that cannot be made, or scores no taps from above.
  Chooser(const ExperimentOptions& options, const Candidates& candidates, const Context& context);

  /// Whether the next tap is the initial design's. A search is over once a hit is believed, or when it has looked
  /// everywhere; at a hit that is doubted it looks again, once, before it goes on.
  bool starting(const TapBelief& belief) const;

  /// What is read for a tap of the acquisition, and what is predicted at the place of any.
  Quantities reads() const { return acquisition_->reads(); }
  Quantities predicts() const { return pace_ ? Pace::kReads : Quantities(); }
  /// What the fallback reads beside that.
  static constexpr Quantities kFallbackReads = Quantity::uncertainty;
  bool may_fall_back() const { return options_.fallback == ExperimentOptions::Fallback::uncertainty; }

  /// Chooses a candidate and, after a tap at `previous`, a motion for it; notes in `tap` which, by whom, and all about
  /// its score. `belief` has been asked for what is read; a fallback asks it for more. False if no candidate is left.
  /// With a `wish` (may be null) the scores are those, under the same rules.
  bool choose(TapBelief& belief, TapRecord& tap, const std::optional<Target>& previous, const Wish* wish = nullptr);

  /// What the acquisition gives each candidate, until it is asked again. Throws Error for what is no finite number.
  const Eigen::VectorXd& scores(const TapBelief& belief);

  /// Notes a tap at `candidate`, of which `belief` knows already.
  void observe(const PastTap& tap, int candidate, const std::optional<Target>& previous, const TapBelief& belief);

  /// What the motion of a tap adds to the noise of its height, metres: 0 where there is but one.
  double roughness(int motion) const { return pace_ ? pace_->roughness(motion) : 0.0; }

 private:
  bool choose_place(TapBelief& belief, TapRecord& tap, const Wish* wish);
  /// Where a hit is doubted, but not for sure a lie, and nobody has looked again: of the allowed.
  std::optional<int> second_look(const TapBelief& belief) const;
  /// Finds the candidates that may be tapped: those that were not, and those whose contacts are all doubted.
  void allow(const TapBelief& belief);

  const ExperimentOptions& options_;
  const Candidates& candidates_;
  std::shared_ptr<Acquisition> acquisition_;
  std::vector<int> initial_;      ///< of a design that counts its taps
  std::optional<Search> search_;  ///< the other one
  std::optional<Pace> pace_;      ///< where the backend has several motions
  Eigen::VectorXd scores_;
  std::vector<int> failed_;    ///< candidates at which a tap came to nothing, in the order of the taps
  std::vector<int> contacts_;  ///< those of all others, likewise
  Allowed allowed_;
  std::size_t taps_ = 0;
};

}  // namespace palpate
