// SPDX-License-Identifier: MIT
// What the taps so far say: the height process and the weight process over the candidates, each built when it is first
// read and never before.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/phases.hpp"
#include "gp/candidates.hpp"
#include "gp/process.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace palpate {

/// The belief behind the acquisitions, and what the metrics and the record want beyond it.
class TapBelief final : public Belief {
 public:
  /// `candidates`, `context` and `clock` must outlive the belief.
  TapBelief(const ExperimentOptions& options, const Candidates& candidates, const Context& context, PhaseClock& clock);

  /// Takes a tap to the record of the belief; a process absorbs it when next read. Only contacts reach the models:
  /// heights above the desk, and labels 1 or 0 by the scene's rule.
  void observe(const Target& place, const Contact& contact);

  // Belief, for acquisitions.
  const Points& candidates() const override { return candidates_.points; }
  Area area() const override { return context_.scene.area(); }
  int taps() const override { return taps_; }
  int initial_taps() const override { return initial_taps_; }
  const Eigen::VectorXd& uncertainty() const override;
  const Eigen::VectorXd& weight() const override;
  const Eigen::VectorXd& height_mean() const override;
  const Eigen::VectorXd& height_variance() const override;

  /// The mean of the weight process as it comes, whatever `weight.clip` says.
  const Eigen::VectorXd& weight_mean() const;

  /// The processes as far as they were built, up to date with all taps; null if nothing has read them.
  const Process* height_process() const;
  const Process* weight_process() const;

  /// Standard deviation of the noise of one tap's height, metres.
  double height_noise() const;

 private:
  struct Datum {
    Target place;
    double value;
  };
  /// A map that is computed when first read after a change.
  struct Map {
    Eigen::VectorXd values;
    int taps = -1;  ///< contacts that it knows of
  };
  struct Model {
    std::vector<Datum> data;
    std::unique_ptr<Process> process;
    const char* name = "";
    std::shared_ptr<Kernel> kernel;
    std::shared_ptr<Fitting> fitting;
    ProcessSettings settings;
  };

  Process& ready(Model& model) const;
  template <class Compute>
  const Eigen::VectorXd& read(Map& map, Model& model, Compute compute) const;

  const Candidates& candidates_;
  const Context& context_;
  PhaseClock& clock_;
  double desk_;
  bool clip_;
  int taps_ = 0;
  int initial_taps_;
  // Lazily filled by const readers: a belief is used by one thread.
  mutable Model height_;
  mutable Model weight_;
  mutable Map uncertainty_map_, weight_map_, weight_mean_map_, mean_map_, variance_map_;
};

}  // namespace palpate
