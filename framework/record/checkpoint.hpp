// SPDX-License-Identifier: MIT
// When a recorded run is looked at: after so many taps, or as soon as it was good enough.
#pragma once

#include "record/row.hpp"

#include <optional>
#include <string>

namespace palpate {

class Checkpoint {
 public:
  /// At least 1.
  static Checkpoint after(int taps);

  /// After the first tap at which a field of the summary is as good as that, "rmse_m=8 mm": it must say which way is
  /// better. Throws Error, of the command line, for another text.
  static Checkpoint once(const std::string& text);

  /// None of a occasion that depends on what came of the taps.
  std::optional<int> taps() const { return taps_; }

  /// Whether it has come, `summary` being that after `taps` taps. An error that is not known, or not finite, is not
  /// good enough.
  bool has_come(int taps, const Row& summary) const;

  /// "after 17 taps", "once rmse_m was 8 mm or less".
  const std::string& words() const { return words_; }

  /// In names of files: "at_17", "until_rmse_m_0.008".
  const std::string& key() const { return key_; }

 private:
  std::optional<int> taps_;
  std::string field_;
  double goal_ = 0.0;  ///< SI
  bool less_ = true;   ///< is better
  std::string words_, key_;
};

inline bool operator==(const Checkpoint& a, const Checkpoint& b) { return a.key() == b.key(); }

}  // namespace palpate
