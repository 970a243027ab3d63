// SPDX-License-Identifier: MIT
// What the taps so far say: the height process and the weight process over the candidates, the footprint, and of
// `surface: two_part` the process of the heights on an object; each built when it is first read and never before. Where
// heights and labels have the same kernel and the same ratio of noise to signal they are two outputs of one process,
// with one factorisation.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/phases.hpp"
#include "gp/candidates.hpp"
#include "gp/process.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/footprint.hpp>
#include <palpate/plugin.hpp>

#include <memory>
#include <optional>
#include <vector>

namespace palpate {

/// The loops that a config's instruction_set means on this processor.
const simd::Table& loops_of(const ExperimentOptions& options);

/// The belief behind the acquisitions, and what the metrics and the record want beyond it.
class TapBelief final : public Belief {
 public:
  /// `candidates`, `context` and `clock` must outlive the belief.
  TapBelief(const ExperimentOptions& options, const Candidates& candidates, const Context& context, PhaseClock& clock);

  /// Takes a tap, `initial` if the initial design chose it, to the record of the belief; a process absorbs it when next
  /// read. Only contacts reach the models: heights above the desk, and labels 1 or 0 by the scene's rule.
  void observe(const Target& place, const Contact& contact, bool initial = false);

  // Belief, for acquisitions.
  const Points& candidates() const override { return candidates_.points; }
  Area area() const override { return context_.scene.area(); }
  int taps() const override { return taps_; }
  int initial_taps() const override { return initial_taps_; }
  const Eigen::VectorXd& uncertainty() const override;
  const Eigen::VectorXd& weight() const override;
  const Eigen::VectorXd& probability() const override;
  const Eigen::VectorXd& height_mean() const override;
  const Eigen::VectorXd& height_variance() const override;

  /// Variance of the height process, all taps seen, square metres: height_variance() unless the surface is two_part.
  const Eigen::VectorXd& all_taps_variance() const;

  /// The mean of the weight process as it comes, whatever `weight.clip` says.
  const Eigen::VectorXd& weight_mean() const;

  /// Says, before the first tap, that scores are such a product: then formed() has them, with bounds that come out of
  /// the update of the maps, valid until the next tap. It is null for other scores, and where heights and labels have
  /// no common process.
  void form(Product product);
  const Scores* formed() const;

  /// What the belief knows of one quantity.
  struct Quantity {
    const Process* process = nullptr;
    int output = 0;
    const FitSummary* last_fit = nullptr;  ///< the fit after the latest tap; null if none was due then
    explicit operator bool() const { return process != nullptr; }
  };
  /// The processes as far as they were built, up to date with all taps; null if nothing has read them. u comes from
  /// the height process, height_mean() and height_variance() from the surface process: the same one for
  /// `surface: single`, that of the taps on an object for `two_part`.
  Quantity height_process() const { return quantity(heights_, 0); }
  Quantity weight_process() const { return quantity(labels(), label_output()); }
  Quantity surface_process() const { return quantity(surface(), 0); }
  bool two_part() const { return two_part_; }
  /// Whether the outline is known without building anything: the probability was read, or the weight that it is.
  bool outline_known() const { return footprint_ ? footprint_read_ : static_cast<bool>(weight_process()); }
  /// Whether the probability is the weight, clipped: then what is shown of the outline is w, else p.
  bool footprint_is_weight() const { return !footprint_; }
  /// The footprint, up to date with all taps, if it is not the weight and was read; else null.
  const Footprint* footprint() const;

  /// Fits that found nothing better and kept the old values.
  int failed_fits() const { return failed_fits_; }

  /// Height of the desk, metres.
  double desk() const { return desk_; }

  /// Standard deviation of the noise of one tap's height, metres.
  double height_noise() const;

 private:
  struct Datum {
    Target place;
    double height;
    double label;
  };
  /// A map that is computed when first read after a change.
  struct Map {
    Eigen::VectorXd values;
    int taps = -1;  ///< contacts that it knows of
  };
  /// A process and all that it is made from; built when first read.
  struct Model {
    const char* name = "";
    std::shared_ptr<Kernel> kernel;
    std::shared_ptr<Fitting> fitting;
    std::vector<ProcessSettings> outputs;
    bool of_labels = false;  ///< the first output is the labels
    std::vector<Datum> data;
    std::unique_ptr<Process> process;
    FitSummary fit;
    int fit_at = 0;  ///< taps that the process had at its latest fit
  };

  Model make_model(const char* name, const PluginChoice& kernel, const PluginChoice& fitting,
                   const ProcessSettings& settings) const;
  bool equal_for_good(const ExperimentOptions& options) const;
  Model& labels() const { return joined_ ? heights_ : labels_; }
  int label_output() const { return joined_ ? 1 : 0; }
  Model& surface() const { return two_part_ ? object_ : heights_; }
  Quantity quantity(Model& model, int output) const;
  Process& ready(Model& model, int output) const;
  void fit(Model& model) const;
  Footprint& ready_footprint() const;
  template <class Read>
  const Eigen::VectorXd& read(Map& map, Model& model, int output, Read read) const;

  const Candidates& candidates_;
  const Context& context_;
  PhaseClock& clock_;
  PosteriorSettings posterior_;
  double desk_;
  bool clip_;
  bool two_part_;
  bool joined_ = false;  ///< heights and labels are two outputs of one process
  int taps_ = 0;
  int initial_taps_ = 0;
  // Lazily filled by const readers: a belief is used by one thread.
  mutable Model heights_;
  mutable Model labels_;                  ///< unless joined
  mutable Model object_;                  ///< heights of the taps on an object
  std::shared_ptr<Footprint> footprint_;  ///< null where it is the weight
  std::vector<Touch> touches_;            ///< of the footprint
  mutable std::size_t touches_taken_ = 0;
  mutable bool footprint_read_ = false;
  mutable int failed_fits_ = 0;
  mutable Map uncertainty_map_, weight_map_, weight_mean_map_, probability_map_, mean_map_, variance_map_,
      all_taps_map_;
};

}  // namespace palpate
