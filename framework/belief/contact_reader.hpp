// SPDX-License-Identifier: MIT
// How contacts are read: their height without the offset of arm and motion, and whether they are on an object. Later
// contacts may change how earlier ones are read.
#pragma once

#include "belief/height_map_options.hpp"
#include "gp/offset_model.hpp"

#include <palpate/scene.hpp>
#include <palpate/tap.hpp>
#include <palpate/types.hpp>

#include <cstddef>
#include <optional>
#include <vector>

namespace palpate {

class ContactReader {
 public:
  /// `offset`: nullopt if no offset is estimated. `scene` must outlive it.
  ContactReader(const std::optional<OffsetOptions>& offset, const Scene& scene) : scene_(scene) {
    if (offset) offset_.emplace(OffsetPrior{offset->offset, offset->drift, offset->noise});
  }

  /// Returns the contact of the next tap, as it would be read; nullopt without a contact. Changes nothing.
  std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const;

  /// Takes the result of a tap, adds its contact to `contacts`, those so far, and reads all of them again. Returns
  /// whether the label of an earlier contact has changed.
  bool add(const TapRequest& request, const TapResult& result, std::vector<Touch>& contacts);

  /// Whether the config estimates the offset of arm and motions (`belief.height.offset`).
  bool has_offset() const { return offset_.has_value(); }
  /// Returns the variance of that estimate now, which all heights share, square metres; 0 without.
  double offset_variance() const { return offset_ ? offset_->at(seconds_).variance : 0.0; }

 private:
  /// A contact as measured.
  struct Measured {
    double height;  ///< above the desk, metres
    double begin;   ///< robot time before the tap, seconds
    int motion;
  };

  const Scene& scene_;
  double seconds_ = 0.0;  ///< robot time of all taps
  std::optional<OffsetModel> offset_;
  std::vector<Measured> measured_;  ///< if offsets are estimated
};

}  // namespace palpate
