// SPDX-License-Identifier: MIT
#include "experiment/chooser.hpp"

#include <palpate/error.hpp>

namespace palpate {

Chooser::Chooser(const ExperimentOptions& options, const Candidates& candidates, const Context& context)
    : options_(options),
      candidates_(candidates),
      acquisition_(context.create<Acquisition>(options.acquisition)),
      initial_(initial_design(options.initial, candidates, context.scene.area(), context.seed)),
      allowed_(static_cast<std::size_t>(candidates.size()), true) {
  if (options.initial.searches())
    search_.emplace(options.initial.smallest, candidates, context.scene.area(), Random(context.seed, "initial"));
}

bool Chooser::starting() const { return search_ ? !hit_ && taps_ < allowed_.size() : taps_ < initial_.size(); }

bool Chooser::choose(TapBelief& belief, TapRecord& tap) {
  if (starting()) {
    tap.source = Source::initial;
    tap.candidate = search_ ? search_->next(allowed_) : initial_[taps_];
    return true;
  }
  tap.source = Source::acquisition;
  Pick picked = pick_best(scores(belief), allowed_, acquisition_->prior_scale(), options_.tie_tolerance);
  if (picked.flat && may_fall_back()) {
    tap.source = Source::fallback;
    tap.why = *picked.flat;
    belief.ask(kFallbackReads);
    picked = pick_best(belief.uncertainty(), allowed_, 1.0, options_.tie_tolerance);
  }
  if (picked.candidate < 0) return false;
  tap.candidate = picked.candidate;
  tap.score = picked.score;
  tap.ties = picked.ties;
  if (picked.runner_up >= 0) {
    tap.runner_up = candidates_.target(picked.runner_up);
    tap.runner_up_score = picked.runner_up_score;
  }
  return true;
}

const Eigen::VectorXd& Chooser::scores(const TapBelief& belief) {
  scores_.resize(candidates_.size());
  acquisition_->score(belief, scores_);
  if (all_finite(scores_)) return scores_;
  throw Error("acquisition/" + options_.acquisition.type, "gave a score that is not a finite number", {},
              Error::Kind::run);
}

void Chooser::observe(const PastTap& tap, int candidate, bool hit) {
  ++taps_;
  hit_ = hit_ || hit;
  if (search_) search_->look(tap.target);
  const bool is_done = options_.repeat == ExperimentOptions::Repeat::forbid;
  if (is_done || tap.contact.outcome != Outcome::contact) allowed_[static_cast<std::size_t>(candidate)] = false;
}

}  // namespace palpate
