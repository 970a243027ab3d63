// SPDX-License-Identifier: MIT
#include "experiment/chooser.hpp"

#include <palpate/error.hpp>

#include <algorithm>

namespace palpate {

Chooser::Chooser(const ExperimentOptions& options, const Candidates& candidates, const Context& context)
    : options_(options),
      candidates_(candidates),
      acquisition_(context.create<Acquisition>(options.acquisition)),
      initial_(initial_design(options.initial, candidates, context.scene.area(), context.seed)),
      allowed_(Allowed::Constant(candidates.size(), true)) {
  if (!acquisition_->from_above()) {
    throw Error("acquisition", options.acquisition.type + " only scores approaches from any side",
                "choose another acquisition, or a scene with touch: any");
  }
  if (options.initial.searches())
    search_.emplace(options.initial.smallest, candidates, context.scene.area(), Random(context.seed, "initial"));
  if (auto motions = context.factory.motions(options.backend, context.scene))
    pace_.emplace(std::move(motions), context.scene.desk());
}

bool Chooser::starting(const TapBelief& belief) const {
  if (!search_) return taps_ < initial_.size();
  if (belief.log().prior_objects() > 0) return false;  // what is looked for has been seen
  if (taps_ >= static_cast<std::size_t>(allowed_.size())) return false;
  constexpr double kBelieved = 0.5;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (belief.touches()[i].on && belief.outlier_probability(i) < kBelieved) return false;
  }
  return true;
}

std::optional<int> Chooser::second_look(const TapBelief& belief) const {
  constexpr double kSure = 0.95;
  for (std::size_t i = 0; search_ && i < contacts_.size(); ++i) {
    const int place = contacts_[i];
    if (!belief.touches()[i].on || belief.outlier_probability(i) > kSure || !allowed_(place)) continue;
    if (std::count(contacts_.begin(), contacts_.end(), place) == 1) return place;
  }
  return std::nullopt;
}

void Chooser::allow(const TapBelief& belief) {
  allowed_.setConstant(true);
  for (const int place : failed_) allowed_(place) = false;
  if (options_.repeat == ExperimentOptions::Repeat::allow) return;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    if (belief.outlier_probability(i) < OutlierModel::kRetapThreshold && !belief.moved(i))
      allowed_(contacts_[i]) = false;
  }
}

bool Chooser::choose(TapBelief& belief, TapRecord& tap, const std::optional<Target>& previous, const Wish* wish) {
  if (!choose_place(belief, tap, wish)) return false;
  if (!pace_) return true;
  const Pace::Choice choice = pace_->choose(belief, tap.candidate, candidates_.target(tap.candidate), previous);
  tap.motion = choice.motion;
  tap.expected_seconds = choice.seconds;
  return true;
}

bool Chooser::choose_place(TapBelief& belief, TapRecord& tap, const Wish* wish) {
  allow(belief);
  if (wish == nullptr && starting(belief)) {
    tap.source = Source::initial;
    const std::optional<int> again = second_look(belief);
    tap.candidate = again ? *again : search_ ? search_->next(allowed_) : initial_[taps_];
    return true;
  }
  if (wish != nullptr && wish->choice) {
    tap = *wish->choice;
    if (tap.source == Source::fallback) belief.ask(kFallbackReads);
    return true;
  }
  tap.source = wish != nullptr ? Source::caller : Source::acquisition;
  const auto pick = [&](const Eigen::VectorXd& of, double scale) {
    return pick_best(of, allowed_, scale, options_.tie_tolerance);
  };
  // Of scores from outside nobody says how large they are before the first tap.
  Pick picked = wish != nullptr ? pick(wish->scores, 0.0) : pick(scores(belief), acquisition_->prior_scale());
  if (picked.flat && may_fall_back()) {
    tap.source = Source::fallback;
    tap.why = (wish != nullptr ? kOfCaller : "") + *picked.flat;
    belief.ask(kFallbackReads);
    picked = pick(belief.uncertainty(), 1.0);
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
  throw Error("acquisition/" + options_.acquisition.type, "returned a score that is not a finite number", {},
              Error::Kind::run);
}

void Chooser::observe(const PastTap& tap, int candidate, const std::optional<Target>& previous,
                      const TapBelief& belief) {
  ++taps_;
  if (pace_) {
    pace_->observe(tap, previous);
    pace_->see_desk(belief.touches(), belief.log().motions());
  }
  // A tap that was broken off says nothing of what is there.
  const Outcome outcome = tap.contact.outcome;
  const bool looked = outcome == Outcome::contact || outcome == Outcome::no_contact || outcome == Outcome::unreachable;
  if (search_ && looked) search_->look(tap.target);
  (outcome == Outcome::contact ? contacts_ : failed_).push_back(candidate);
}

}  // namespace palpate
