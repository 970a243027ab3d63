// SPDX-License-Identifier: MIT
#include "report/history.hpp"

#include "report/snapshot.hpp"

#include <algorithm>
#include <array>

namespace palpate {
namespace {

/// The candidates that a map shows.
class Shown {
 public:
  explicit Shown(const Candidates& all) : all_(all) {
    step_ = (std::max(all.columns, all.rows) + kMostCellsAcross - 1) / kMostCellsAcross;
  }

  Eigen::VectorXd x() const {
    Eigen::VectorXd out(count(all_.columns));
    for (Eigen::Index i = 0; i < out.size(); ++i) out(i) = all_.points(i * step_, 0);
    return out;
  }

  Eigen::VectorXd y() const {
    Eigen::VectorXd out(count(all_.rows));
    for (Eigen::Index i = 0; i < out.size(); ++i) out(i) = all_.points(i * step_ * all_.columns, 1);
    return out;
  }

  Eigen::VectorXf of(const Eigen::VectorXd& map) const {
    Eigen::VectorXf out(count(all_.columns) * count(all_.rows));
    Eigen::Index next = 0;
    for (int row = 0; row < all_.rows; row += step_) {
      for (int column = 0; column < all_.columns; column += step_)
        out(next++) = static_cast<float>(map(row * all_.columns + column));
    }
    return out;
  }

 private:
  int count(int all) const { return (all + step_ - 1) / step_; }

  const Candidates& all_;
  int step_ = 1;
};

/// Whether the scores are a map of their own, beside those that are shown anyhow.
bool own_scores(const Snapshot& now) {
  if (now.scores == now.uncertainty) return false;
  return now.has_weight() ? now.scores != now.exploration() : now.scores != now.probability;
}

}  // namespace

History make_history(const Workshop& workshop, const Recording& recording, const OnProgress& progress) {
  Playback playback(workshop, recording);
  Experiment& experiment = playback.experiment();
  const Shown shown(experiment.candidates());
  History out;
  out.x = shown.x();
  out.y = shown.y();
  const bool weight = experiment.belief().footprint_is_weight();
  out.maps = {{"height", {}}, {"deviation", {}}, {"u", {}}, {weight ? "w" : "p", {}}, {"score", {}}};
  bool scores = false;
  const auto all = static_cast<int>(recording.taps.size());
  for (int taps = 0; taps <= all; ++taps) {
    playback.advance_to(taps);
    const Snapshot now = snapshot_of(playback, recording);
    const std::array<const Eigen::VectorXd*, 5> maps{&now.surface, &now.deviation, &now.uncertainty,
                                                     weight ? &now.weight : &now.probability, &now.scores};
    for (std::size_t i = 0; i < maps.size(); ++i) out.maps[i].frames.push_back(shown.of(*maps[i]));
    scores = scores || own_scores(now);
    out.moments.push_back({taps, experiment.result(), now.next, now.largest_deviation, {}, {}});
    if (weight) {
      out.moments.back().least_weight = experiment.belief().weight_mean().minCoeff();
      out.moments.back().most_weight = experiment.belief().weight_mean().maxCoeff();
    }
    progress(taps, all);
  }
  double largest = 0.0;
  for (const Moment& moment : out.moments) largest = std::max(largest, moment.largest_deviation);
  for (Eigen::VectorXf& frame : out.maps[1].frames) frame = frame.cwiseMin(static_cast<float>(largest));
  if (!scores) out.maps.pop_back();
  if (const Truth* truth = experiment.truth()) out.maps.push_back({"truth", {shown.of(truth->height)}});
  return out;
}

}  // namespace palpate
