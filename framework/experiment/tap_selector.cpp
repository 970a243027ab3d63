// SPDX-License-Identifier: MIT
#include "experiment/tap_selector.hpp"

#include "belief/outlier_model.hpp"
#include "experiment/initial_design.hpp"
#include "gp/finite.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

TapSelector::TapSelector(const ExperimentOptions& options, const Belief& belief, const Context& context)
    : options_(options), area_(context.scene.area()), acquisition_(context.create<Acquisition>(options.acquisition)) {
  if (!belief.candidates().fixed) return;
  grid_ = grid_of(belief.candidates());
  if (!options.initial.searches() && options.initial.count > grid_.size())
    throw Error("initial.count",
                fmt::format("{} taps, but there are only {} candidates", options.initial.count, grid_.size()),
                "use fewer initial taps or more candidates");
  initial_ = initial_design(options.initial, grid_, area_, context.seed);
  if (options.initial.searches())
    search_.emplace(options.initial.smallest, grid_, area_, Random(context.seed, "initial"));
}

void TapSelector::add_readers(ReadPlan& plan) const {
  plan.readers.push_back(
      {"acquisition " + options_.acquisition.type, acquisition_->reads(), Stage::first_acquisition_tap});
  if (options_.choice.fallback == ChoiceOptions::Fallback::uncertainty)
    plan.readers.push_back(
        {"fallback uncertainty, from its first use on", {quantity::kUncertainty}, Stage::first_fallback});
  if (options_.initial.design != InitialOptions::Design::random)
    plan.readers.push_back({"initial.design", {quantity::kDeskPosition}, Stage::first_tap});
  if (options_.choice.repeat == ChoiceOptions::Repeat::allow)
    plan.readers.push_back({"choice.repeat", {quantity::kDeskPosition}, Stage::first_tap});
}

bool TapSelector::is_starting(const Belief& belief) const {
  const bool is_seen = belief.scalar(quantity::kObjectSeen) == 1.0;
  if (!belief.candidates().fixed)
    return !is_seen && (static_cast<std::int64_t>(taps_.size()) < options_.initial.count || !belief.is_ready());
  if (!search_) return taps_.size() < initial_.size();
  if (is_seen || static_cast<int>(taps_.size()) >= grid_.size()) return false;
  constexpr double kProbablyNone = 0.5;
  return std::none_of(belief.taps().readings.begin(), belief.taps().readings.end(),
                      [](const TapReading& one) { return one.on_object && one.outlier_probability < kProbablyNone; });
}

std::optional<int> TapSelector::second_look(const Belief& belief) const {
  constexpr double kSurelyOutlier = 0.95;
  if (!search_) return std::nullopt;
  for (const TapReading& one : belief.taps().readings) {
    const int candidate = taps_[static_cast<std::size_t>(one.tap - 1)].candidate;
    if (!one.on_object || one.outlier_probability > kSurelyOutlier || !allowed_(candidate)) continue;
    const auto contacts = std::count_if(taps_.begin(), taps_.end(), [&](const TappedCandidate& tap) {
      return tap.is_contact && tap.candidate == candidate;
    });
    if (contacts == 1) return candidate;
  }
  return std::nullopt;
}

void TapSelector::allow(const Belief& belief) {
  allowed_ = Allowed::Constant(belief.candidates().size(), true);
  if (!belief.candidates().fixed) return;
  for (const TappedCandidate& tap : taps_) {
    if (!tap.is_contact) allowed_(tap.candidate) = false;
  }
  if (options_.choice.repeat == ChoiceOptions::Repeat::allow) return;
  for (const TapReading& one : belief.taps().readings) {
    if (one.outlier_probability < OutlierModel::kRetapThreshold && !one.moved)
      allowed_(taps_[static_cast<std::size_t>(one.tap - 1)].candidate) = false;
  }
}

bool TapSelector::choose_initial(const Belief& belief, TapRecord& tap) {
  tap.request.source = Source::initial;
  tap.candidate = 0;  // if lines are drawn, the first line is tapped
  if (belief.candidates().fixed) {
    const std::optional<int> again = second_look(belief);
    tap.candidate = again ? *again : search_ ? search_->next(allowed_) : initial_[taps_.size()];
  }
  tap.request.line = belief.candidates().line(tap.candidate);
  return true;
}

void TapSelector::begin_fallback(Belief& belief) {
  belief.begin(Stage::first_fallback);
  belief.update();
  belief.infer();
}

bool TapSelector::choose(Belief& belief, TapRecord& tap, const TapOverride* override) {
  allow(belief);
  const Candidates& candidates = belief.candidates();
  if (next_source(belief, override) == Source::initial) return choose_initial(belief, tap);
  if (override != nullptr && override->choice) {
    const TapRecord& choice = *override->choice;
    tap.candidate = find(candidates, choice.request.line);
    tap.request.line = candidates.line(tap.candidate);
    tap.request.source = choice.request.source;
    tap.why = choice.why;
    tap.score = choice.score;
    tap.ties = choice.ties;
    tap.runner_up = choice.runner_up;
    tap.runner_up_score = choice.runner_up_score;
    if (choice.request.source == Source::fallback) begin_fallback(belief);
    return true;
  }
  tap.request.source = override != nullptr ? Source::caller : Source::acquisition;
  const auto pick = [&](const Eigen::VectorXd& of, double scale) {
    return pick_best(of, allowed_, scale, options_.choice.tie_tolerance);
  };
  // The typical size of a caller's scores is not known, so the scale is 0.
  Pick picked = override != nullptr ? pick(override->scores, 0.0) : pick(scores(belief), acquisition_->prior_scale());
  if (picked.flat && options_.choice.fallback == ChoiceOptions::Fallback::uncertainty) {
    tap.request.source = Source::fallback;
    tap.why = (override != nullptr ? kOfCaller : "") + *picked.flat;
    begin_fallback(belief);
    picked = pick(belief.values(quantity::kUncertainty), 1.0);
  }
  if (picked.candidate < 0) return false;
  tap.candidate = picked.candidate;
  tap.request.line = candidates.line(tap.candidate);
  tap.score = picked.score;
  tap.ties = picked.ties;
  if (picked.runner_up < 0) return true;
  if (candidates.from_above) tap.runner_up = candidates.line(picked.runner_up).target();
  tap.runner_up_score = picked.runner_up_score;
  return true;
}

const Eigen::VectorXd& TapSelector::scores(const BeliefView& belief) {
  scores_.resize(belief.candidates().size());
  acquisition_->score(belief, scores_);
  if (all_finite(scores_)) return scores_;
  throw Error("acquisition/" + options_.acquisition.type, "returned a score that is not a finite number", {},
              Error::Kind::run);
}

int TapSelector::find(const Candidates& candidates, const TapLine& line) const {
  if (candidates.fixed) return grid_.nearest(line.start.x(), line.start.y(), area_);
  for (Eigen::Index i = 0; i < candidates.size(); ++i) {
    const TapLine one = candidates.line(i);
    if (one.start == line.start && one.direction == line.direction) return static_cast<int>(i);
  }
  return 0;
}

void TapSelector::take_in(const TapRecord& tap, const Belief& belief) {
  const int candidate = belief.candidates().fixed ? find(belief.candidates(), tap.request.line) : 0;
  taps_.push_back({candidate, tap.is_contact()});
  // An aborted tap has no information about the scene.
  const Outcome outcome = tap.result.outcome;
  const bool has_looked =
      outcome == Outcome::contact || outcome == Outcome::no_contact || outcome == Outcome::unreachable;
  if (search_ && has_looked) search_->look(tap.target());
}

}  // namespace palpate
