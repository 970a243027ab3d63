// SPDX-License-Identifier: MIT
#include "report/history.hpp"

#include <cmath>

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

enum : std::size_t { kHeight, kDeviation, kUncertainty, kWeight, kScore };

/// Whether scores are maps of their own: not u, nor u w, at some moment.
bool is_own(const Eigen::VectorXd& scores, const TapBelief& belief) {
  return scores != belief.uncertainty() && scores != belief.uncertainty().cwiseProduct(belief.weight());
}

}  // namespace

History make_history(const Workshop& workshop, const Recording& recording, const Progress& progress) {
  Playback playback(workshop, recording);
  Experiment& experiment = playback.experiment();
  const TapBelief& belief = experiment.belief();
  const Shown shown(experiment.candidates());
  History out;
  out.x = shown.x();
  out.y = shown.y();
  out.maps = {{"height", {}}, {"deviation", {}}, {"u", {}}, {"w", {}}, {"score", {}}};
  bool own_scores = false;
  const auto all = static_cast<int>(recording.taps.size());
  for (int taps = 0; taps <= all; ++taps) {
    playback.advance_to(taps);
    const auto keep = [&](std::size_t which, const Eigen::VectorXd& map) {
      out.maps[which].frames.push_back(shown.of(map));
    };
    keep(kHeight, reconstruction(belief));
    keep(kDeviation, belief.height_variance().cwiseSqrt());
    keep(kUncertainty, belief.uncertainty());
    keep(kWeight, belief.weight());
    const Eigen::VectorXd scores = experiment.scores();
    keep(kScore, scores);
    own_scores = own_scores || is_own(scores, belief);
    out.moments.push_back({taps, experiment.result(), experiment.choose_next(),
                           std::sqrt(belief.all_taps_variance().maxCoeff()), belief.weight_mean().minCoeff(),
                           belief.weight_mean().maxCoeff()});
    progress(taps, all);
  }
  if (!own_scores) out.maps.pop_back();
  if (const Truth* truth = experiment.truth()) out.maps.push_back({"truth", {shown.of(truth->height)}});
  return out;
}

}  // namespace palpate
