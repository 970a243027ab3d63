// SPDX-License-Identifier: MIT
// Reads contacts: subtracts the estimated offset of arm and motion from the measured height, and decides whether the
// contact is on an object. Later contacts may change the readings of earlier contacts.
#pragma once

#include "belief/height_map_options.hpp"
#include "gp/offset_model.hpp"

#include <palpate/scene.hpp>
#include <palpate/tap.hpp>
#include <palpate/types.hpp>

#include <optional>
#include <vector>

namespace palpate {

class ContactReader {
 public:
  /// `offset`: nullopt if no offset is estimated. `scene` must outlive the reader.
  ContactReader(const std::optional<OffsetOptions>& offset, const Scene& scene) : scene_(scene) {
    if (offset) offset_.emplace(OffsetPrior{offset->offset, offset->drift, offset->noise});
  }

  /// Returns the reading of `result` as the result of the next tap; nullopt without a contact. Changes nothing.
  std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const;

  /// Adds the contact of a tap to `contacts`, the contacts so far, and updates the readings of all contacts. Returns
  /// whether the label of an earlier contact has changed.
  bool add(const TapRequest& request, const TapResult& result, std::vector<Touch>& contacts);

  /// Returns whether the config estimates the offset of arm and motions (`belief.height.offset`).
  bool has_offset() const { return offset_.has_value(); }
  /// Returns the current variance of the estimated offset, square metres; 0 without an estimate. The error of the
  /// offset is the same for all heights.
  double offset_variance() const { return offset_ ? offset_->at(seconds_).variance : 0.0; }

 private:
  /// A contact with its measured height, before any correction.
  struct MeasuredContact {
    double height;  ///< above the desk, metres
    double begin;   ///< robot time before the tap, seconds
    int motion;
  };

  const Scene& scene_;
  double seconds_ = 0.0;  ///< robot time of all taps
  std::optional<OffsetModel> offset_;
  std::vector<MeasuredContact> measured_;  ///< only if offsets are estimated
};

}  // namespace palpate
