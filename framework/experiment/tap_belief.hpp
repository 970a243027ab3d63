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

  /// Variance of the height process, all taps seen, square metres: height_variance() unless the surface is two_part.
  const Eigen::VectorXd& all_taps_variance() const;

  /// The mean of the weight process as it comes, whatever `weight.clip` says.
  const Eigen::VectorXd& weight_mean() const;

  /// The processes as far as they were built, up to date with all taps; null if nothing has read them. u comes from
  /// the height process, height_mean() and height_variance() from the surface process: the same one for
  /// `surface: single`, that of the taps on an object for `two_part`.
  const Process* height_process() const { return built(height_); }
  const Process* weight_process() const { return built(weight_); }
  const Process* surface_process() const { return built(surface()); }
  bool two_part() const { return two_part_; }

  /// The fit after the latest tap that `process` has absorbed; null if none was due then.
  const FitSummary* last_fit(const Process& process) const;
  /// Fits that found nothing better and kept the old values.
  int failed_fits() const { return failed_fits_; }

  /// Height of the desk, metres.
  double desk() const { return desk_; }

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
    FitSummary fit;
    int fit_at = 0;  ///< taps that the process had at its latest fit
  };

  static Model make_model(const char* name, const PluginChoice& kernel, const PluginChoice& fitting,
                          const ProcessSettings& settings, const Context& context);
  Model& surface() const { return two_part_ ? object_ : height_; }
  const Process* built(Model& model) const { return model.process ? &ready(model) : nullptr; }
  Process& ready(Model& model) const;
  void fit(const std::vector<Model*>& models) const;
  template <class Compute>
  const Eigen::VectorXd& read(Map& map, Model& model, Compute compute) const;

  const Candidates& candidates_;
  const Context& context_;
  PhaseClock& clock_;
  double desk_;
  bool clip_;
  bool two_part_;
  bool shared_;                   ///< heights and labels have one kernel
  bool fitted_together_ = false;  ///< and are fitted together, which makes each read the other's taps
  int taps_ = 0;
  int initial_taps_;
  // Lazily filled by const readers: a belief is used by one thread.
  mutable Model height_;
  mutable Model weight_;
  mutable Model object_;  ///< heights of the taps on an object
  mutable int failed_fits_ = 0;
  mutable Map uncertainty_map_, weight_map_, weight_mean_map_, mean_map_, variance_map_, all_taps_map_;
};

}  // namespace palpate
