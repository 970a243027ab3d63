// SPDX-License-Identifier: MIT
// The footprint of the belief: which candidates are on an object. Its plugin sees the data of the log when a reader
// first needs it.
#pragma once

#include "belief/contact_log.hpp"
#include "gp/candidate_grid.hpp"

#include <palpate/footprint.hpp>
#include <palpate/plugin.hpp>

#include <memory>
#include <string>

namespace palpate {

class FootprintModel {
 public:
  /// `candidates` and `context` must outlive it.
  FootprintModel(const PluginChoice& choice, const CandidateGrid& candidates, const Context& context);

  /// Whether the footprint is the label GP, clipped: then nothing below is called.
  bool is_label_gp() const { return footprint_->is_weight(); }

  /// Keeps the probability, and hypotheses if these are wanted, from the next update() on. Returns whether anything was
  /// missing.
  bool show(bool hypotheses);
  const std::string& name() const { return choice_.type; }
  bool is_shown() const { return shown_; }
  const Footprint& plugin() const { return *footprint_; }

  /// Takes in the data since; brings probability, hypotheses and positions up to date. Throws Error for a probability
  /// that is not finite.
  void update(const ContactLog& log);
  /// Forgets all data, as labels have changed.
  void reset();

  /// M values; empty before the first update().
  const Eigen::VectorXd& probability() const { return probability_; }
  const HypothesisSample& hypotheses() const { return hypotheses_; }

  /// The positions of all data now, a row each: objects may have been pushed since.
  const Points& positions() const { return positions_now_; }
  /// Whether a datum has moved since its tap; false for data that update() has not seen.
  bool has_moved(int row) const;

 private:
  PluginChoice choice_;
  const CandidateGrid& candidates_;
  const Context& context_;
  std::shared_ptr<Footprint> footprint_;
  bool shown_ = false;
  bool shows_hypotheses_ = false;
  int taken_ = 0;  ///< number of data that the plugin has
  Eigen::VectorXd probability_;
  HypothesisSample hypotheses_;
  Points positions_, positions_now_;  ///< as made, and now
};

}  // namespace palpate
