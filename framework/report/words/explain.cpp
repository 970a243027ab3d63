// SPDX-License-Identifier: MIT
#include "report/words/explain.hpp"

#include "belief/outlier_model.hpp"
#include "config/display_units.hpp"
#include "gp/candidate_grid.hpp"
#include "record/fields.hpp"
#include "report/words/explanation.hpp"
#include "report/words/models.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace palpate {
namespace {

/// Adds the values of the maps at the tap's position: u and, depending on the record, either w and e or the probability
/// p. `footprint`: type of the footprint.
void explain_place(TextSections& sections, const Row& row, const std::string& footprint) {
  std::vector<std::string> said;
  const auto say = [&](const char* name, const std::string& before, const std::string& meaning) {
    if (row.number(name)) said.push_back(fmt::format("{}{} ({})", before, number_words(row, name), meaning));
  };
  say("u", "u = ", "variance of the height relative to its prior: 0 known, 1 unknown");
  say("p", "p = ", "probability of an object there, by footprint/" + footprint);
  say("w", "w = ", "mean of the label GP: 0 desk, 1 object");
  if (row.number("w") && row.number("e")) said.push_back("e = u w = " + number_words(row, "e"));
  if (!said.empty()) sections.add(fmt::format("There {}.", fmt::join(said, ", ")));
}

class FromAboveExplanation final : public Explanation {
 public:
  using Explanation::Explanation;

 private:
  void explain() override {
    experiment_.look();
    text_.heading(heading(place_words(tap_.target().x, tap_.target().y)));
    text_.heading("Why there");
    explain_choice();
    text_.heading(fmt::format("The models used for the choice, from {}, {} of them on an object",
                              counted(hits_before() + before().desk_taps, "contact"), hits_before()));
    if (!has_models()) text_.add("This choice used no model.");
    explain_models(text_, row_, options_, height_map_options(options_, environment_.host), context_);
    text_.heading("Expected and found");
    explain_expectation();
    explain_outcome();
    text_.heading("Effect of the tap");
    // The errors after this tap are in the record of the next tap, or in the summary.
    const bool last = number_ == static_cast<int>(recording_.rows.size());
    explain_errors(row_,
                   !last ? recording_.rows[static_cast<std::size_t>(number_)] : recording_.summary.value_or(Row{}));
    explain_doubt();
  }

  /// Returns whether the record of the tap has the state of any model.
  bool has_models() const {
    const auto has = [&](const char* field) { return row_.number(field).has_value(); };
    return has("height_gp.signal") || has("label_gp.signal") || has("surface_gp.signal") || has("p");
  }
  const RunResult& before() { return experiment_.counts(); }
  int hits_before() { return before().object_taps; }

  /// Returns the candidate of a tap.
  int candidate_of(const TapRecord& tap) {
    return grid_.nearest(tap.target().x, tap.target().y, experiment_.scene().area());
  }

  // The following functions explain the choice.

  void explain_choice() {
    switch (tap_.request.source) {
      case Source::initial:
        explain_design();
        break;
      case Source::acquisition:
        text_.add(fmt::format("The acquisition chose it: {}.", acquisition_words()));
        explain_score(context_.create<Acquisition>(options_.acquisition)->prior_scale());
        break;
      case Source::fallback:
        explain_fallback();
        explain_score(1.0);  // the score of the fallback is u, which is 1 before any tap
        break;
      case Source::caller:
        text_.add("The caller chose it, by scores of its own.");
        explain_score(0.0);
        break;
    }
    explain_place(text_, row_, belief_option(options_, "footprint.type"));
    explain_repeats();
    if (const std::optional<double> seconds = row_.number("expected_seconds"))
      text_.add(
          fmt::format("It was made by motion {} of motion.of, which was expected to give the most information per "
                      "second here, in {}.",
                      tap_.request.motion, seconds_words(*seconds)));
  }

  void explain_design() {
    if (options_.initial.searches()) {
      text_.add(
          fmt::format("It is tap {} of the search for an object, which uses no model: it taps where an object could "
                      "hide in most of the unexplored area, or in the middle of the widest gap (seed {}).",
                      number_, options_.seed));
      return;
    }
    // in the order of InitialOptions::Design
    constexpr const char* kHow[] = {"random: drawn from the candidates by the seed alone",
                                    "sobol: a sequence that spreads evenly, shifted by the seed",
                                    "grid: a lattice over the area"};
    text_.add(fmt::format("It is initial tap {} of {}, placed by the initial design without a model ({}, seed {}).",
                          number_, options_.initial.count, kHow[static_cast<std::size_t>(options_.initial.design)],
                          options_.seed));
  }

  void explain_fallback() {
    std::string why = row_.text("why");
    const bool of_caller = why.rfind(kOfCaller, 0) == 0;
    if (of_caller) why.erase(0, std::string(kOfCaller).size());
    text_.add(
        fmt::format("{} gave no usable scores: {}.",
                    of_caller ? "The scores of the caller" : fmt::format("The acquisition, {},", acquisition_words()),
                    why.empty() ? "its scores do not distinguish the candidates" : why));
    const double greatest = row_.number("max_weight").value_or(1.0);
    if (hits_before() == 0)
      text_.add("No tap has hit an object yet" +
                (greatest > 0.0 ? "."
                                : fmt::format(": every label is 0, and so the weight w is nowhere above {}.",
                                              plain_words(greatest))));
    text_.add(
        "So the fallback chose it (fallback: uncertainty), which taps where the height is least certain: its score is "
        "u.");
  }

  /// Returns the number of candidates that were excluded from the choice because they must not be tapped again.
  int left_out() {
    std::set<int> out;
    for (int i = 0; i < number_ - 1; ++i) {
      const TapRecord& tap = recording_.taps[static_cast<std::size_t>(i)];
      const bool failed = !tap.is_contact();
      if (failed || options_.choice.repeat == ChoiceOptions::Repeat::forbid) out.insert(candidate_of(tap));
    }
    return static_cast<int>(out.size());
  }

  void explain_score(double scale) {
    const auto score = row_.number("score");
    if (!score) return text_.add("The record holds no score.");
    const int out = left_out();
    const int allowed = grid_.size() - out;
    const double ties = row_.number("ties").value_or(1.0);
    const auto second = row_.number("runner_up.score");
    const double best = second ? std::max(*score, *second) : *score;
    const double bound = options_.choice.tie_tolerance * (std::abs(best) + scale);
    std::string text = fmt::format("Its score there is {}", plain_words(*score));
    if (allowed == 1) {
      text += "; no other candidate is left.";
    } else if (ties <= 1) {
      text += fmt::format(", the best of {}; no other is within {:.2g} of it (tie_tolerance).",
                          counted(allowed, "candidate"), bound);
    } else {
      text += fmt::format(
          ". {} of {} are tied: within {:.2g} of the best (tie_tolerance), so that rounding does not decide. The one "
          "with the lowest index is taken (candidates are counted along x, row by row).",
          ties == allowed ? "All" : fmt::format("{}", ties), counted(allowed, "candidate"), bound);
    }
    text_.add(text);
    if (tap_.request.source == Source::acquisition) explain_flatness(best, bound, ties > 1 && ties == allowed);
    const char* why = options_.choice.repeat == ChoiceOptions::Repeat::forbid
                          ? "because tapped before (repeat: forbid)"
                          : "because a tap failed there; others may be tapped again (repeat: allow)";
    text_.add(out == 0 ? std::string("No candidate is left out.")
                       : fmt::format("{} {} left out, {}.", counted(out, "candidate"), out == 1 ? "is" : "are", why));
    explain_second(*score);
  }

  /// If the scores hardly distinguish the candidates, explains why the acquisition still chose the tap.
  void explain_flatness(double best, double bound, bool equal) {
    if (options_.choice.fallback == ChoiceOptions::Fallback::none) {
      if (best > 0.0 && !equal) return;
      text_.add(fmt::format(
          "{}: such scores do not distinguish candidates, but the config uses no fallback (fallback: none).",
          best > 0.0 ? "Every score is equal" : "No score is positive"));
    } else if (best > 0.0 && best <= bound) {
      text_.add(fmt::format("The best score, {}, is nearly 0 but positive, so the fallback was not used.",
                            plain_words(best)));
    }
  }

  void explain_second(double score) {
    const auto x = row_.number("runner_up.x");
    const auto y = row_.number("runner_up.y");
    const auto second = row_.number("runner_up.score");
    if (!x || !y || !second) return text_.add("There is no runner-up.");
    explain_runner_up(place_words(*x, *y), score, *second);
  }

  void explain_repeats() {
    std::vector<int> earlier;
    for (int i = 1; i < number_; ++i) {
      if (candidate_of(recording_.taps[static_cast<std::size_t>(i - 1)]) == candidate_of(tap_)) earlier.push_back(i);
    }
    if (!earlier.empty())
      text_.add(fmt::format("This place was tapped before: {} {}.", earlier.size() == 1 ? "tap" : "taps",
                            fmt::join(earlier, ", ")));
  }

  // The following functions explain the tap.

  void explain_expectation() {
    const bool two_part = belief_option(options_, "surface") == "two_part";
    if (two_part && hits_before() == 0) return text_.add("Expected: nothing, no tap has been on an object yet.");
    const int candidate = candidate_of(tap_);
    const double height = belief_.values(quantity::kHeightMean)(candidate);
    text_.add(fmt::format("Expected, by the taps before: a height of {} with a standard deviation of {}{}.",
                          length_words(height), length_words(belief_.values(quantity::kHeightStd)(candidate)),
                          two_part ? ", if an object is there (the surface GP)" : ""));
    if (!two_part || on_object()) expected_ = height;
  }

  void explain_outcome() {
    const TapResult& contact = tap_.result;
    if (!contact.is_contact()) {
      text_.add(
          fmt::format("Found: nothing, the tap failed: {}{}. It took {} of robot time. No model uses it, and its "
                      "position is excluded afterwards.",
                      outcome_name(contact.outcome), contact.reason.empty() ? "" : ", " + contact.reason,
                      seconds_words(contact.seconds)));
    } else {
      explain_contact(contact, on_object());
      explain_label();
    }
    explain_failure();
  }

  bool on_object() const { return row_.flag("on_object").value_or(false); }

  void explain_contact(const TapResult& contact, bool on) {
    std::string text =
        fmt::format("Found: contact at {}, {}", length_words(contact.height()), on ? "on an object" : "on the desk");
    const double height = row_.number("corrected_height").value_or(contact.height());
    if (height != contact.height())
      text += fmt::format(", {} after correction for the estimated offset of motion and arm", length_words(height));
    if (const double more = height - expected_.value_or(height); more != 0.0)
      text += fmt::format(", {} {} than expected", length_words(std::abs(more)), more > 0.0 ? "higher" : "lower");
    text += fmt::format("; greatest force {}, {} of robot time.", readable(contact.force, Unit::newton),
                        seconds_words(contact.seconds));
    if (row_.flag("true_on_object").value_or(on) != on)
      text += fmt::format(" In truth {} is there: the label is wrong.", on ? "the desk" : "an object");
    text_.add(text);
  }

  /// Adds remarks on whether the tap was a suspected outlier right after it was made, and whether it is one after all
  /// taps.
  void explain_doubt() {
    if (belief_option(options_, "height.outlier_probability").empty() || !tap_.is_contact()) return;
    text_.heading("Is it an outlier?");
    const auto said = [&](int taps) {
      playback_.advance_to(taps);
      experiment_.look();
      for (const TapReading& one : belief_.taps().readings) {
        if (one.tap == number_ && one.outlier_probability >= OutlierModel::kRetapThreshold)
          return "may be an outlier: " + doubt_words(one);
      }
      return std::string("is not suspected");
    };
    const auto all = static_cast<int>(recording_.rows.size());
    text_.add(fmt::format("Right after the tap, it {}.", said(number_)));
    if (all > number_) text_.add(fmt::format("After all {} taps, it {}.", all, said(all)));
  }

  const CandidateGrid grid_ = grid_of(belief_.candidates());
  const Context context_{environment_.host, experiment_.scene(), static_cast<std::uint64_t>(options_.seed), nullptr};
  std::optional<double> expected_;  ///< expected height; nullopt for a desk tap with a two-part surface
};

}  // namespace

std::string explain_tap(const RunEnvironment& environment, const RecordedRun& recording, int tap) {
  const auto taps = static_cast<int>(recording.rows.size());
  if (tap < 1 || tap > taps)
    throw Error(fmt::format("tap {}", tap), fmt::format("the run has {}", counted(taps, "tap")),
                taps == 1 ? "choose tap 1" : fmt::format("choose one of 1 to {}", taps));
  if (recording.is_any_side()) return explain_approach(environment, recording, tap);
  return FromAboveExplanation(environment, recording, tap).text();
}

}  // namespace palpate
