// SPDX-License-Identifier: MIT
#include "belief/footprint_model.hpp"

#include "gp/finite.hpp"

#include <cmath>

namespace palpate {

FootprintModel::FootprintModel(const PluginChoice& choice, const CandidateGrid& candidates, const Context& context)
    : choice_(choice), candidates_(candidates), context_(context), footprint_(context.create<Footprint>(choice)) {}

bool FootprintModel::show(bool hypotheses) {
  const bool more = !shown_ || (hypotheses && !shows_hypotheses_);
  if (hypotheses && !shows_hypotheses_) probability_.resize(0);
  shown_ = true;
  shows_hypotheses_ = shows_hypotheses_ || hypotheses;
  return more;
}

void FootprintModel::update(const ContactLog& log) {
  if (probability_.size() == 0 || taken_ < log.size()) {
    for (; taken_ < log.size(); ++taken_) footprint_->add(log.datum(taken_));
    probability_.resize(candidates_.size());
    footprint_->probability(candidates_.points, probability_);
    require_finite(probability_, "the probability p", log.taps());
    if (shows_hypotheses_) footprint_->sample(candidates_.points, hypotheses_);
  }
  // Displacements are rounded to steps far below the shortest push that taps can reveal, because each change of a
  // position rebuilds a GP.
  constexpr double kStep = 1e-3;
  positions_.resize(log.size(), 2);
  for (int i = 0; i < log.size(); ++i) {
    const Target& place = log.datum(i).place;
    positions_.row(i) << place.x, place.y;
  }
  positions_now_ = positions_;
  footprint_->current_positions(positions_now_);
  const Eigen::ArrayXXd steps = ((positions_now_ - positions_).array() / kStep).round();
  positions_now_ = positions_.array() + kStep * steps;
}

bool FootprintModel::has_moved(int row) const {
  return row < taken_ && (positions_now_.row(row) - positions_.row(row)).squaredNorm() > 0.0;
}

void FootprintModel::reset() {
  footprint_ = context_.create<Footprint>(choice_);
  taken_ = 0;
  probability_.resize(0);
}

}  // namespace palpate
