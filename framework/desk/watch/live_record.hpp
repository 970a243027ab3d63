// SPDX-License-Identifier: MIT
// What a page that is served shows while it goes on.
#pragma once

#include <optional>
#include <string>

namespace palpate {

/// A run or a sweep that is looked at. A page begins with page() and asks for news() again and again: it says how far
/// it is, in letters, digits and dots that only this object understands. No member throws Error: what is wrong with a
/// record is told on its page.
class LiveRecord {
 public:
  virtual ~LiveRecord() = default;

  /// Looks whether the record has changed, and takes in what is new for about as many seconds; a single tap may take
  /// longer. Returns whether there is more to be taken in at once.
  virtual bool look(double seconds) = 0;

  /// The page as of the last look: HTML.
  virtual std::string page() = 0;

  /// What a page that is at `at` lacks, as of the last look: JSON on one line, with "at", where the page is then. None
  /// where it lacks nothing. A page of something else than what is there now is told to begin anew.
  virtual std::optional<std::string> news(const std::string& at) = 0;

  /// Whether somebody works on the record.
  virtual bool goes_on() const = 0;
};

}  // namespace palpate
