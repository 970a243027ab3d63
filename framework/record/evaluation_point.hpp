// SPDX-License-Identifier: MIT
// The point at which a recorded run is evaluated: after a number of taps, or after the first tap that reached a goal.
#pragma once

#include "record/row.hpp"

#include <optional>
#include <string>

namespace palpate {

class Checkpoint {
 public:
  /// Returns the checkpoint after `taps` taps, at least 1.
  static Checkpoint after(int taps);

  /// Returns the checkpoint after the first tap at which a summary field reaches a goal, such as "rmse_m=8 mm". For
  /// this field, lower or higher values must be defined as better. Throws Error, with the location "command line", for
  /// any other text.
  static Checkpoint once(const std::string& text);

  /// Returns the number of taps; nullopt if the checkpoint depends on the results of the taps.
  std::optional<int> taps() const { return taps_; }

  /// Returns whether the checkpoint is reached. `summary` is the summary after `taps` taps. A field that is unknown or
  /// not finite does not reach the goal.
  bool has_come(int taps, const Row& summary) const;

  /// Returns the description: "after 17 taps", "once rmse_m was 8 mm or less".
  const std::string& words() const { return words_; }

  /// Returns the text for names of files: "at_17", "until_rmse_m_0.008".
  const std::string& key() const { return key_; }

 private:
  std::optional<int> taps_;
  std::string field_;
  double goal_ = 0.0;  ///< in SI units
  bool less_ = true;   ///< whether less is better
  std::string words_, key_;
};

inline bool operator==(const Checkpoint& a, const Checkpoint& b) { return a.key() == b.key(); }

}  // namespace palpate
