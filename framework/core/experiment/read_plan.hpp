// SPDX-License-Identifier: MIT
// The readers of the belief: which quantities each reads, and from which tap on. The plan is fixed before the first
// tap; no other model is built for the choice of taps.
#pragma once

#include "experiment/tap_record.hpp"

#include <palpate/belief.hpp>

#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// When a reader begins to read. Its models take in the taps so far then.
enum class Stage {
  first_tap,
  second_tap,
  first_scored_tap,       ///< the first tap that scores choose, of the acquisition or of a caller
  first_acquisition_tap,  ///< the first tap that the acquisition's scores choose
  first_fallback,
  first_object_contact
};

class ReadPlan {
 public:
  struct Reader {
    std::string name;  ///< such as "acquisition weighted"
    Quantities reads;
    Stage from;
  };

  void add(std::string name, Quantities reads, Stage from) { readers_.push_back({std::move(name), reads, from}); }
  const std::vector<Reader>& readers() const { return readers_; }

  /// Returns all that is read from this stage on.
  Quantities reads(Stage from) const {
    Quantities out;
    for (const Reader& one : readers_) {
      if (one.from == from) out = out | one.reads;
    }
    return out;
  }
  /// Returns all that is read of the belief to choose a tap by this source.
  Quantities reads(Source source) const {
    Quantities out = reads(Stage::first_tap);
    if (source == Source::initial) return out;
    out = out | reads(Stage::first_scored_tap);
    if (source == Source::caller) return out;
    out = out | reads(Stage::first_acquisition_tap);
    return source == Source::fallback ? out | reads(Stage::first_fallback) : out;
  }

 private:
  std::vector<Reader> readers_;
};

}  // namespace palpate
