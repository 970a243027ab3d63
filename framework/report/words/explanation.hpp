// SPDX-License-Identifier: MIT
// Common part of the explanations of taps from above and from any side.
#pragma once

#include "report/history.hpp"
#include "report/words/words.hpp"

#include <string>

namespace palpate {

class Explanation {
 public:
  /// `tap` is the number of a recorded tap, from 1. `environment` and `recording` must outlive the object.
  Explanation(const RunEnvironment& environment, const RecordedRun& recording, int tap)
      : environment_(environment), recording_(recording), number_(tap) {}
  virtual ~Explanation() = default;
  Explanation(const Explanation&) = delete;
  Explanation& operator=(const Explanation&) = delete;

  std::string text();

 protected:
  /// Adds the explanation to `text_`. The models must be in their state before the tap.
  virtual void explain() = 0;

  std::string heading(const std::string& where) const;
  std::string acquisition_words() const;
  /// Adds a remark about the second best candidate. `where`: its position or line as text; `second`: its score;
  /// `score`: score of the chosen candidate.
  void explain_runner_up(const std::string& where, double score, double second);
  /// Adds a remark if the contact's label changed after the tap.
  void explain_label();
  /// Adds a remark if the run failed at this tap.
  void explain_failure();
  /// Adds a remark on the change of the errors by the tap. `before` and `after` are rows with the errors before and
  /// after the tap.
  void explain_errors(const Row& before, const Row& after);

  const RunEnvironment& environment_;
  const RecordedRun& recording_;
  int number_;
  const ExperimentOptions& options_ = recording_.config.options;
  const Row& row_ = recording_.rows[static_cast<std::size_t>(number_ - 1)];
  const TapRecord& tap_ = recording_.taps[static_cast<std::size_t>(number_ - 1)];
  RunReplay playback_{environment_, recording_, page_readers(recording_)};
  Experiment& experiment_ = playback_.experiment();
  Belief& belief_ = experiment_.belief();
  TextSections text_;
};

/// Returns the explanation of a tap from any side, as explain_tap() does for taps from above.
std::string explain_approach(const RunEnvironment& environment, const RecordedRun& recording, int tap);

}  // namespace palpate
