// SPDX-License-Identifier: MIT
// Choice of the next tap. The initial design or the search chooses the first taps. Then the acquisition's scores
// choose, with a rule for ties. If the scores do not distinguish candidates, a fallback chooses.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/pick_best.hpp"
#include "experiment/search_design.hpp"
#include "experiment/tap_record.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace palpate {

class TapSelector {
 public:
  /// `options` must outlive the selector. Throws Error for an invalid acquisition.
  TapSelector(const ExperimentOptions& options, const Belief& belief, const Context& context);

  /// Adds the quantities that the acquisition and the fallback read.
  void add_readers(ReadPlan& plan) const;

  /// Returns whether the initial design chooses the next tap. A search ends with an object contact that is probably not
  /// an outlier, or when all candidates have been tapped. If an object contact is a suspected outlier, the search taps
  /// its candidate again before it continues.
  bool is_starting(const Belief& belief) const;
  /// Returns the source that would choose the next tap, unless a fallback becomes necessary.
  Source next_source(const Belief& belief, const TapOverride* override) const {
    if (override != nullptr)
      return override->choice && !override->choice->is_of_caller() ? Source::acquisition : Source::caller;
    return is_starting(belief) ? Source::initial : Source::acquisition;
  }

  /// Chooses a candidate, and stores its line, source and score in `tap`. Requires that the stages for next_source()
  /// have begun and their arrays are computed; a fallback begins its own stage. Returns false if no candidate is left.
  /// `override` (may be null) replaces the acquisition.
  bool choose(Belief& belief, TapRecord& tap, const TapOverride* override);

  /// Returns the acquisition's scores, M values. Throws Error if a score is not finite.
  const Eigen::VectorXd& scores(const BeliefView& belief);

  /// Adds a tap that `belief` already contains.
  void take_in(const TapRecord& tap, const Belief& belief);

 private:
  /// Returns the candidate of a recorded line; 0 if not found.
  int find(const Candidates& candidates, const TapLine& line) const;
  static void begin_fallback(Belief& belief);
  bool choose_initial(const Belief& belief, TapRecord& tap);
  /// Returns an allowed candidate whose only contact is a suspected outlier on an object; nullopt if there is none.
  /// Only for the search.
  std::optional<int> second_look(const Belief& belief) const;
  /// Sets allowed_. With `repeat: forbid`, it contains candidates without a tap, and candidates whose contacts are all
  /// suspected outliers or have moved. Candidates with a failed tap are never allowed.
  void allow(const Belief& belief);

  const ExperimentOptions& options_;
  Area area_;
  CandidateGrid grid_;  ///< only for fixed candidates
  std::shared_ptr<Acquisition> acquisition_;
  std::vector<int> initial_;            ///< candidates of a design with a fixed count
  std::optional<SearchDesign> search_;  ///< the design `search`
  Eigen::VectorXd scores_;
  struct TappedCandidate {
    int candidate;
    bool is_contact;
  };
  std::vector<TappedCandidate> taps_;
  Allowed allowed_;
};

}  // namespace palpate
