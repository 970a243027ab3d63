// SPDX-License-Identifier: MIT
// The stages of a run at which the readers of the belief begin to read.
#pragma once

#include <palpate/belief.hpp>

#include <set>
#include <string>
#include <utility>

namespace palpate {

/// The plan of a run, and which of its stages have begun.
class ReadStages {
 public:
  explicit ReadStages(ReadPlan plan) : plan_(std::move(plan)) {}

  const ReadPlan& plan() const { return plan_; }

  /// Begins a stage of `belief`, unless it has begun.
  void begin(Belief& belief, Stage stage) {
    if (begun_.insert(stage).second) belief.begin(stage);
  }
  /// Begins the stages of a tap by this source.
  void begin(Belief& belief, Source source) {
    begin(belief, Stage::first_tap);
    if (source == Source::initial) return;
    begin(belief, Stage::first_scored_tap);
    if (source == Source::caller) return;
    begin(belief, Stage::first_acquisition_tap);
    if (source == Source::fallback) begin(belief, Stage::first_fallback);
  }

  /// Returns what is read in arrays by the stages that have begun.
  QuantitySet reads() const {
    QuantitySet out;
    for (const Stage stage : begun_) out = out | plan_.reads(stage);
    return out;
  }

 private:
  ReadPlan plan_;
  std::set<Stage> begun_;
};

/// Throws Error for a reader of a quantity that `belief`, by its `name`, does not offer.
void require_offered(const ReadPlan& plan, const Belief& belief, const std::string& name);

}  // namespace palpate
