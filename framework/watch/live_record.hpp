// SPDX-License-Identifier: MIT
// Interface of records whose pages are served while they grow.
#pragma once

#include <optional>
#include <string>

namespace palpate {

/// A run or a sweep with a page. The page begins with the HTML of page() and then repeatedly requests news(). Each
/// request contains the page's position in the record. The position is a text of letters, digits and dots that only
/// this object interprets. No member throws Error. Instead, the page shows the problem of a damaged record.
class LiveRecord {
 public:
  virtual ~LiveRecord() = default;

  /// Reads and processes changes of the record for about `seconds` seconds; a single tap may take longer. Returns
  /// whether the record has more changes to read.
  virtual bool look(double seconds) = 0;

  /// Returns the HTML page in the state of the last look().
  virtual std::string page() = 0;

  /// Returns an update for a page that is at position `at`, in the state of the last look(). The update is JSON on one
  /// line with the new position "at". Returns nullopt if the page is up to date. If another record has replaced this
  /// one, the update makes the page reload.
  virtual std::optional<std::string> news(const std::string& at) = 0;

  /// Returns whether a process works on the record.
  virtual bool goes_on() const = 0;
};

}  // namespace palpate
