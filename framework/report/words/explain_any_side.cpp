// SPDX-License-Identifier: MIT
// Explanation of a tap from any side.
#include "config/display_units.hpp"
#include "record/fields.hpp"
#include "report/words/explanation.hpp"
#include "report/words/words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {
namespace {

using Eigen::Vector3d;

/// Returns "from x 1.00 cm, y 2.00 cm, z 3.00 cm, coming down at 20 degrees".
std::string line_words(const TapLine& line) {
  constexpr double kDegrees = 57.29577951308232;  // degrees per radian
  const double degrees = kDegrees * std::asin(std::clamp(-line.direction.z(), -1.0, 1.0));
  const std::string slope = degrees > 85.0            ? "straight down"
                            : std::abs(degrees) < 3.0 ? "level"
                                                      : fmt::format("coming {} at {:.0f} degrees",
                                                                    degrees > 0.0 ? "down" : "up", std::abs(degrees));
  const Vector3d& from = line.start;
  return fmt::format("from {}, z {}, {}", place_words(from.x(), from.y()), place_words(from.z()), slope);
}

std::string solid_words(const LineFacts::Solid& solid) {
  const std::vector<double> sides(solid.extent.begin(), solid.extent.end());
  const DisplayScale scale = readable_scale(Unit::metre, sides, 2, LengthKind::place);
  std::string out = fmt::format("{} of {} x {} x {}", solid.form, scale.number(sides[0]), scale.number(sides[1]),
                                scale.quantity(sides[2]));
  if (solid.wall > 0.0) out += fmt::format(" with a wall of {}", length_words(solid.wall));
  return out;
}

class AnySideExplanation final : public Explanation {
 public:
  using Explanation::Explanation;

 private:
  void explain() override {
    text_.heading(heading(line_words(line_)));
    text_.heading("Why there");
    explain_choice();
    facts_ = belief_.explain(line_);
    if (!all().empty()) explain_place();
    text_.heading(fmt::format("The belief after {}, {} of them on an object", counted(number_ - 1, "tap"),
                              experiment_.counts().object_taps));
    if (!all().empty()) explain_belief();
    text_.heading("Expected and found");
    if (!all().empty()) explain_expectation();
    explain_outcome();
    text_.heading("Effect of the tap");
    Row before;
    add_errors(before, errors_now());
    playback_.advance_to(number_);
    Row after;
    add_errors(after, errors_now());
    explain_errors(before, after);
  }

  Errors errors_now() {
    experiment_.look();
    return belief_.errors(ErrorsFor::display)->errors;
  }

  void explain_choice() {
    const std::optional<TapRecord> now = playback_.next();
    if (tap_.request.source == Source::initial) {
      text_.add(
          number_ <= options_.initial.count
              ? fmt::format("It is initial tap {} of {}, along a random line through the region (seed {}).", number_,
                            options_.initial.count, options_.seed)
              : fmt::format("No tap had hit an object yet, so this is a random line through the region (seed {}).",
                            options_.seed));
      return;
    }
    text_.add(fmt::format("The acquisition chose it: {}.", acquisition_words()));
    if (recording_.scored_by_program()) return explain_score();
    if (!now || now->request.line.start != line_.start)
      return text_.add(
          "From the same earlier taps, this build would choose another line: the run used another build or instruction "
          "set, so the other scores are unknown.");
    const Eigen::VectorXd scores = experiment_.scores();
    std::string text =
        fmt::format("Its score is {}, the best of {} approaches", plain_words(scores(now->candidate)), scores.size());
    if (now->ties.value_or(1) > 1)
      text += fmt::format("; {} are tied with it (tie_tolerance), and the first of them is taken", *now->ties - 1);
    text_.add(fmt::format("{}. The mean of all is {}.", text, plain_words(scores.mean())));
    explain_gains(now->candidate);
    explain_second(scores, now->candidate);
  }

  /// Adds the expected effects of the tap, if the acquisition computes its scores from these effects.
  void explain_gains(int chosen) {
    const auto add = [&](const char* quantity, const char* sentence) {
      if (belief_.available().count(quantity) == 0) return;
      const Eigen::VectorXd& gains = belief_.values(quantity);
      text_.add(fmt::format(fmt::runtime(sentence), length_words(gains(chosen)), length_words(gains.maxCoeff())));
    };
    add(quantity::kExpectedDiscovery,
        "Of one further solid that no contact contradicts, this line is expected to find {} (mean over lines from all "
        "sides); the best line finds {}.");
    add(quantity::kStdReduction,
        "A contact there is expected to reduce the mean standard deviation of the surface by {}; the best line reduces "
        "it by {}.");
  }

  void explain_second(const Eigen::VectorXd& scores, int chosen) {
    if (scores.size() < 2) return;
    Eigen::Index second = chosen == 0 ? 1 : 0;
    for (Eigen::Index i = 0; i < scores.size(); ++i)
      if (i != chosen && scores(i) > scores(second)) second = i;
    explain_runner_up(line_words(belief_.candidates().line(second)), scores(chosen), scores(second));
  }

  /// Adds the recorded score, if the acquisition is an external program. Reports do not start programs, so other scores
  /// are unknown.
  void explain_score() {
    if (const auto score = row_.number("score"))
      text_.add(fmt::format("Its score is {}; the program's scores of the other lines are not recorded.",
                            plain_words(*score)));
  }

  using Particle = LineFacts::Particle;
  const std::vector<Particle>& all() const { return facts_.particles; }

  /// Adds the belief's values at the position where the line is expected to meet the surface.
  void explain_place() {
    if (!all().front().on_object) return text_.add("According to the most probable particle, no object is there.");
    text_.add(fmt::format(
        "Where the line meets the surface, the standard deviation along the surface normal is {}; far from all "
        "contacts it is {}. The cosine between line and normal is {:.3f} (1: perpendicular to the surface).",
        length_words(facts_.surface_std), length_words(facts_.prior_std), facts_.incidence_cosine));
  }

  void explain_belief() {
    const auto [least, most] = std::minmax_element(all().begin(), all().end(), [](const auto& one, const auto& other) {
      return one.solids.size() < other.solids.size();
    });
    std::vector<std::string> solids;
    for (const LineFacts::Solid& one : all().front().solids) solids.push_back(solid_words(one));
    const std::string most_words = counted(static_cast<long>(most->solids.size()), "solid");
    const bool alike = least->solids.size() == most->solids.size();
    text_.add(fmt::format("{} of {}; the most probable one: {}.", counted(static_cast<long>(all().size()), "particle"),
                          alike ? most_words : fmt::format("{} to {}", least->solids.size(), most_words),
                          fmt::join(solids, ", ")));
  }

  void explain_expectation() {
    const Particle& best = all().front();
    std::vector<double> hits;
    for (const Particle& one : all()) {
      if (one.on_object) hits.push_back(one.distance);
    }
    const std::string what = best.on_object                 ? "an object after"
                             : best.distance < line_.length ? "the desk after"
                                                            : "nothing in";
    std::string text =
        fmt::format("Expected, by the most probable particle: {} {}. ", what, length_words(best.distance));
    if (hits.empty()) {
      text += fmt::format("None of {} has an object there.", all().size());
    } else {
      const Eigen::Map<const Eigen::ArrayXd> distances(hits.data(), static_cast<Eigen::Index>(hits.size()));
      const double mean = distances.mean();
      text += fmt::format("{} of {} {} an object there, after {} with a standard deviation of {}.", hits.size(),
                          all().size(), hits.size() == 1 ? "has" : "have", length_words(mean),
                          length_words(std::sqrt((distances - mean).square().mean())));
    }
    text_.add(text);
    if (best.on_object) expected_ = best.distance;
  }

  void explain_outcome() {
    const TapResult& contact = tap_.result;
    const double along = contact.distance.value_or(line_.length);
    const std::string robot = fmt::format("{} of robot time", seconds_words(contact.seconds));
    if (contact.outcome == Outcome::no_contact) {
      text_.add(fmt::format("Found: nothing in {}; the whole path is free. {}.", length_words(along), robot));
    } else if (contact.outcome != Outcome::contact) {
      text_.add(fmt::format("Found: nothing, the tap failed: {}{}. {}. No model uses it.",
                            outcome_name(contact.outcome), contact.reason.empty() ? "" : ", " + contact.reason, robot));
    } else {
      const bool on = row_.flag("on_object").value_or(false);
      std::string text = fmt::format("Found: contact after {}, at a height of {}, {}", length_words(along),
                                     length_words(contact.height()), on ? "on an object" : "on the desk");
      if (on && expected_ && along != *expected_)
        text += fmt::format(", {} {} than expected", length_words(std::abs(along - *expected_)),
                            along > *expected_ ? "further" : "earlier");
      text += fmt::format("; greatest force {}, {}.", readable(contact.force, Unit::newton), robot);
      if (row_.flag("true_on_object").value_or(on) != on)
        text += fmt::format(" In truth {} is there.", on ? "no object" : "an object");
      text_.add(text);
      explain_label();
    }
    explain_failure();
  }

  const TapLine& line_ = tap_.request.line;
  LineFacts facts_;                 ///< values of the belief along the line, before the tap
  std::optional<double> expected_;  ///< expected path length to an object
};

}  // namespace

std::string explain_approach(const RunEnvironment& environment, const RecordedRun& recording, int tap) {
  return AnySideExplanation(environment, recording, tap).text();
}

}  // namespace palpate
