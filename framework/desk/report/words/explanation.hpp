// SPDX-License-Identifier: MIT
// What explanations of a tap have in common, whether it came from above or from any side.
#pragma once

#include "record/recording.hpp"
#include "report/words/words.hpp"

#include <string>

namespace palpate {

class Explanation {
 public:
  /// `tap` is one of the recording's, from 1. `workshop` and `recording` must outlive it.
  Explanation(const Workshop& workshop, const Recording& recording, int tap)
      : workshop_(workshop), recording_(recording), number_(tap) {}
  virtual ~Explanation() = default;
  Explanation(const Explanation&) = delete;
  Explanation& operator=(const Explanation&) = delete;

  std::string text();

 protected:
  /// Fills the page; the models are as they were before the tap.
  virtual void explain() = 0;

  std::string heading(const std::string& where) const;
  std::string acquisition_words() const;
  /// The second best choice, at `where`, whose score is `second`.
  void explain_runner_up(const std::string& where, double score, double second);
  /// If the contact has another label by all taps than it had when it was made.
  void explain_label();
  /// If the run failed at this tap.
  void explain_failure();
  /// Describes how the tap changed the errors, from the rows before and after it.
  void explain_errors(const Row& before, const Row& after);

  const Workshop& workshop_;
  const Recording& recording_;
  int number_;
  const ExperimentOptions& options_ = recording_.config.options;
  const Row& row_ = recording_.rows[static_cast<std::size_t>(number_ - 1)];
  const PastTap& tap_ = recording_.taps[static_cast<std::size_t>(number_ - 1)];
  Playback playback_{workshop_, recording_};
  TextSections text_;
};

/// Of a run from any side, what explain_tap() is of one from above.
std::string explain_approach(const Workshop& workshop, const Recording& recording, int tap);

}  // namespace palpate
