// SPDX-License-Identifier: MIT
// What a belief thinks anew of earlier taps, in the light of later ones: how high they were, where they would be made
// now, and whether they are believed.
#include "experiment/tap_belief.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Surfaces have steps that no process foresees, so what the heights say against a contact is too sure of itself: above
/// one half, its logarithmic odds count half. Of 402 contacts that were doubted at 90 % without that, 83 % lied.
double tempered(double doubt) {
  if (doubt <= 0.5) return doubt;
  const double odds = std::sqrt(doubt / (1.0 - doubt));
  return std::isfinite(odds) ? odds / (1.0 + odds) : 1.0;
}

}  // namespace

/// Takes off all heights what is thought now to be added to them, and says anew which were with an object.
void TapBelief::read_again() {
  // In steps far below the noise, so that the processes are not made anew after every tap.
  constexpr double kStep = 2.5e-4;
  const double noise = systematic_->noise();
  hits_.clear();
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    Touch& touch = touches_[i];
    const Systematic::Estimate estimate = systematic_->at(times_[i], motions_[i]);
    touch.height = excess_[i] - kStep * std::round(estimate.value / kStep);
    const bool clear =
        systematic_->above(i) || touch.height > Systematic::kClearly * std::sqrt(estimate.variance + noise * noise);
    const bool on = clear && context_.scene.on_object(desk_ + touch.height);
    if (on != touch.on && i + 1 < touches_.size()) flipped_ = true;
    touch.on = on;
    if (on) hits_.push_back(touch);
  }
}

/// Forgets what the models made of labels that are others now; they take in all taps anew.
void TapBelief::begin_again() {
  flipped_ = false;
  if (joined_) begin_again(heights_);
  begin_again(labels_);
  begin_again(object_);
  doubted_.forget();
  touches_taken_ = 0;
  sights_taken_ = false;
  probability_.resize(0);
  if (footprint_) footprint_ = context_.create<Footprint>(footprint_choice_);
}

void TapBelief::begin_again(Model& model) {
  if (!model.process) return;
  const int shown = model.process->shown();
  const bool of_labels = model.of_labels;
  const std::vector<ProcessSettings> outputs = model.outputs;
  model = make_model(model.name, model.kernel_choice, model.fitting_choice, outputs.front());
  model.outputs = outputs;
  model.of_labels = of_labels;
  show(model, shown - 1);
}

/// Gives the processes the heights as they read now.
void TapBelief::correct() {
  for (Model* model : {&heights_, &object_}) {
    if (!model->process) continue;
    Eigen::VectorXd values(data(*model));
    for (int i = 0; i < data(*model); ++i) values(i) = datum(*model, i).height;
    if (model->process->correct(values)) model->stale = true;
  }
}

/// Moves the contacts along with what was pushed since.
void TapBelief::follow() {
  // In steps far below what a push can be told by, so that the processes are not made anew after every tap.
  constexpr double kStep = 1e-3;
  const int known = data(heights_);
  places_.resize(known, 2);
  for (int i = 0; i < known; ++i) {
    const Target& place = datum(heights_, i).place;
    places_.row(i) << place.x, place.y;
  }
  places_now_ = places_;
  footprint_->current_positions(places_now_);
  for (int i = 0; i < known; ++i) {
    for (int k = 0; k < 2; ++k) {
      const double way = places_now_(i, k) - places_(i, k);
      places_now_(i, k) = places_(i, k) + kStep * std::round(way / kStep);
    }
  }
  for (Model* model : {&heights_, &labels_}) {
    if (model->process && model->process->move(places_now_)) model->stale = true;
  }
  if (!object_.process) return;
  Points hits(data(object_), 2);
  Eigen::Index hit = 0;
  for (int i = 0; i < known; ++i) {
    if (datum(heights_, i).on) hits.row(hit++) = places_now_.row(i);
  }
  if (object_.process->move(hits)) object_.stale = true;
}

/// What is thought of each contact: by its label, which the footprint may take for wrong, and by its height, if it is
/// one of an object.
void TapBelief::judge() {
  // To judge costs the cube of the hits. By so many a surface is known that a lie can do little to: later contacts are
  // believed, and what was doubted stays so.
  constexpr std::size_t kMostHits = 100;
  const auto contacts = static_cast<Eigen::Index>(touches_.size());
  if (hits_.size() > kMostHits) {
    const Eigen::Index known = doubt_.size();
    for (Eigen::VectorXd* values : {&doubt_, &by_label_}) {
      values->conservativeResize(contacts);
      values->tail(contacts - known).setZero();
    }
    believe();
    return;
  }
  Eigen::VectorXd by_label = Eigen::VectorXd::Zero(data(heights_));
  if (footprint_asked_) footprint_->doubt(by_label);
  doubt_ = by_label.tail(contacts);
  by_label_ = doubt_;
  // What was seen is no lie, only less exact.
  Eigen::VectorXd suspicion = Eigen::VectorXd::Zero(data(object_));
  Eigen::VectorXd roughness = Eigen::VectorXd::Zero(data(object_));
  Eigen::Index hit = 0;
  for (const std::size_t seen : hits_seen_) roughness(hit++) = sights_[seen].deviation * sights_[seen].deviation;
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    const double mislabelled = by_label_(static_cast<Eigen::Index>(i));
    if (touches_[i].on) suspicion(hit++) = mislabelled + (1.0 - mislabelled) * *lies_;
  }
  doubted_.judge(*object_.process, suspicion, sights_.empty() ? Eigen::VectorXd() : roughness);
  hit = seen(object_);
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    if (touches_[i].on) doubt_(static_cast<Eigen::Index>(i)) = tempered(doubted_.doubt()(hit++));
  }
  object_.stale = true;
  believe();
}

/// How far the heights that were seen are to be trusted beside those of taps.
Eigen::VectorXd TapBelief::shares_seen(bool of_hits) const {
  const double variance = height_noise() * height_noise();
  Eigen::VectorXd out(static_cast<Eigen::Index>(of_hits ? hits_seen_.size() : sights_.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const auto number = static_cast<std::size_t>(i);
    const Sight& sight = sights_[of_hits ? hits_seen_[number] : number];
    const double more = sight.deviation * sight.deviation;
    out(i) = more > 0.0 ? std::max(1e-12, variance / (variance + more)) : 1.0;
  }
  return out;
}

/// Has the processes trust each contact as far as it is believed.
void TapBelief::believe() {
  constexpr double kLeast = 1e-3;  // never quite nothing
  const Eigen::Map<const Eigen::ArrayXd> share(share_.data(), static_cast<Eigen::Index>(share_.size()));
  const Eigen::VectorXd of_taps = (share * (1.0 - (doubt_.array() * kSteps).round() / kSteps)).max(kLeast);
  Eigen::VectorXd trust(data(heights_));
  trust << shares_seen(false), of_taps;
  if (heights_.process && heights_.process->trust(trust)) heights_.stale = true;
  Eigen::VectorXd hits(data(object_));
  hits.head(seen(object_)) = shares_seen(true);
  Eigen::Index hit = seen(object_);
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    if (touches_[i].on) hits(hit++) = of_taps(static_cast<Eigen::Index>(i));
  }
  if (object_.process && object_.process->trust(hits)) object_.stale = true;
}

}  // namespace palpate
