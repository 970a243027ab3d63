// SPDX-License-Identifier: MIT
// The footprint of the belief: which candidates are on an object. Its plugin receives the data of the log only when
// another part of the run first needs the footprint.
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
  /// `candidates` and `context` must outlive the model.
  FootprintModel(const PluginChoice& choice, const CandidateGrid& candidates, const Context& context);

  /// Returns whether the footprint is the clipped label GP. If so, the functions below must not be called.
  bool is_label_gp() const { return footprint_->is_weight(); }

  /// Requests the probability, and with `hypotheses` also the hypotheses, from the next update() on. Returns whether
  /// this is the first request for the probability or for the hypotheses.
  bool show(bool hypotheses);
  const std::string& name() const { return choice_.type; }
  bool is_shown() const { return shown_; }
  const Footprint& plugin() const { return *footprint_; }

  /// Adds the new data of the log, and updates probability, hypotheses and positions. Throws Error for a probability
  /// that is not finite.
  void update(const ContactLog& log);
  /// Removes all data, because labels have changed.
  void reset();

  /// Returns the probability at each candidate, M values; empty before the first update().
  const Eigen::VectorXd& probability() const { return probability_; }
  const HypothesisSample& hypotheses() const { return hypotheses_; }

  /// Returns the current positions of all data, one row each. Pushes of objects may have changed them.
  const Points& positions() const { return positions_now_; }
  /// Returns whether a data point has moved since its tap; false for data that update() has not added yet.
  bool has_moved(int row) const;

 private:
  PluginChoice choice_;
  const CandidateGrid& candidates_;
  const Context& context_;
  std::shared_ptr<Footprint> footprint_;
  bool shown_ = false;
  bool shows_hypotheses_ = false;
  int taken_ = 0;  ///< number of data in the plugin
  Eigen::VectorXd probability_;
  HypothesisSample hypotheses_;
  Points positions_, positions_now_;  ///< positions of all data when measured, and after pushes of the objects
};

}  // namespace palpate
