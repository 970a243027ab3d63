// SPDX-License-Identifier: MIT
#include "belief/contact_reader.hpp"

#include <cmath>

namespace palpate {

std::optional<TapReading> ContactReader::read(const TapRequest& request, const TapResult& result) const {
  if (!result.is_contact()) return std::nullopt;
  TapReading out;
  out.tap = request.number;
  out.position = {request.line.start.x(), request.line.start.y(), result.height()};
  out.on_object = scene_.on_object(result.height());
  if (!offset_) return out;
  out.is_corrected = true;
  // While the offset is uncertain, a contact slightly above the desk is more probably a contact with the desk than with
  // a very low object.
  const OffsetModel::Estimate estimate = offset_->at(seconds_, request.motion);
  const double height = out.position.z() -= estimate.value;
  const double unsure =
      OffsetModel::kAboveDeskSigmas * std::sqrt(estimate.variance + offset_->noise() * offset_->noise());
  out.on_object = scene_.on_object(height) && height - scene_.desk() > unsure;
  return out;
}

bool ContactReader::add(const TapRequest& request, const TapResult& result, std::vector<Touch>& contacts) {
  const double began = seconds_;
  const std::optional<TapReading> reading = read(request, result);
  seconds_ += result.seconds;
  if (!reading) return false;
  contacts.push_back({request.line.target(), reading->position.z() - scene_.desk(), reading->on_object});
  if (!offset_) return false;
  measured_.push_back({result.height() - scene_.desk(), began, request.motion});
  offset_->add(request.line.target(), began, measured_.back().height, request.motion);
  // Offsets are rounded to steps far below the noise, because each change of the heights rebuilds a GP.
  constexpr double kStep = 2.5e-4;
  const double noise = offset_->noise();
  bool has_changed = false;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    Touch& contact = contacts[i];
    const OffsetModel::Estimate estimate = offset_->at(measured_[i].begin, measured_[i].motion);
    contact.height = measured_[i].height - kStep * std::round(estimate.value / kStep);
    const bool clear = offset_->above(i) ||
                       contact.height > OffsetModel::kAboveDeskSigmas * std::sqrt(estimate.variance + noise * noise);
    const bool on = clear && scene_.on_object(scene_.desk() + contact.height);
    has_changed = has_changed || (on != contact.on && i + 1 < contacts.size());
    contact.on = on;
  }
  return has_changed;
}

}  // namespace palpate
