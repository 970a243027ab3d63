// SPDX-License-Identifier: MIT
// Interface of records whose pages are served while they grow.
#pragma once

#include <optional>
#include <string>

namespace palpate {

/// A run or a sweep with a page. The page begins with page() and asks for news() again and again, with its position in
/// the record: letters, digits and dots that only this object interprets. No member throws Error; its page shows what
/// is wrong with a record.
class LiveRecord {
 public:
  virtual ~LiveRecord() = default;

  /// Reads changes of the record for about this many seconds; a single tap may take longer. Returns whether more can be
  /// read at once.
  virtual bool look(double seconds) = 0;

  /// Returns the HTML page as of the last look().
  virtual std::string page() = 0;

  /// Returns an update for a page at position `at` as of the last look(): JSON on one line with the new position "at";
  /// nullopt if the page is up to date. If the record was replaced, the update tells the page to reload.
  virtual std::optional<std::string> news(const std::string& at) = 0;

  /// Returns whether a process works on the record.
  virtual bool goes_on() const = 0;
};

}  // namespace palpate
