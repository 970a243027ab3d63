// SPDX-License-Identifier: MIT
// The choice of the next tap: the initial design or the search, then the acquisition's scores, ties, and the fallback
// where the scores do not tell candidates apart.
#pragma once

#include "experiment/check_quantities.hpp"
#include "experiment/policy.hpp"
#include "experiment/search_design.hpp"
#include "experiment/tap_record.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

class TapSelector {
 public:
  /// `options` must outlive it. Throws Error for an acquisition that cannot be made.
  TapSelector(const ExperimentOptions& options, const Belief& belief, const Context& context);

  /// Adds the acquisition and the fallback to the readers.
  void add_readers(ReadPlan& plan) const;

  /// Whether the initial design chooses the next tap. A search ends with a contact on an object that is probably no
  /// outlier, or after all candidates; it taps a doubtful contact once more before it goes on.
  bool is_starting(const Belief& belief) const;
  /// Returns who would choose the next tap, but for a fallback.
  Source next_source(const Belief& belief, const TapOverride* override) const {
    if (override != nullptr)
      return override->choice && !override->choice->is_of_caller() ? Source::acquisition : Source::caller;
    return is_starting(belief) ? Source::initial : Source::acquisition;
  }

  /// Chooses a candidate, and notes in `tap` line, source and all about the score. The belief is up to date for
  /// next_source(); a fallback begins its stage. Returns false if no candidate is left. `override` (may be null) stands
  /// in for the acquisition.
  bool choose(Belief& belief, TapRecord& tap, const TapOverride* override);

  /// Returns the acquisition's scores, M values. Throws Error for a score that is not finite.
  const Eigen::VectorXd& scores(const BeliefView& belief);

  /// Takes in a tap, which `belief` has.
  void take_in(const TapRecord& tap, const Belief& belief);

 private:
  /// Returns the candidate of a recorded line; 0 if there is none.
  int find(const Candidates& candidates, const TapLine& line) const;
  static void begin_fallback(Belief& belief);
  bool choose_initial(const Belief& belief, TapRecord& tap);
  /// Returns a candidate, among those allowed, with a contact that may be an outlier and was tapped once.
  std::optional<int> second_look(const Belief& belief) const;
  /// Allows the candidates without a tap, and those whose contacts may all be outliers or have moved.
  void allow(const Belief& belief);

  const ExperimentOptions& options_;
  Area area_;
  CandidateGrid grid_;  ///< of fixed candidates
  std::shared_ptr<Acquisition> acquisition_;
  std::vector<int> initial_;            ///< candidates of a design that counts its taps
  std::optional<SearchDesign> search_;  ///< the other design
  Eigen::VectorXd scores_;
  struct Tapped {
    int candidate;
    bool is_contact;
  };
  std::vector<Tapped> taps_;
  Allowed allowed_;
};

}  // namespace palpate
