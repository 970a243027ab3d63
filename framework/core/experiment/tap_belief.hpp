// SPDX-License-Identifier: MIT
// What the taps so far say: the height GP and the label GP over the candidates, the footprint, and of
// `surface: two_part` the process of the heights on an object; each built when it is asked for and never before. Where
// heights and labels have the same kernel and the same ratio of noise to signal they are two outputs of one process,
// with one factorisation.
#pragma once

#include "experiment/contact_log.hpp"
#include "experiment/experiment_options.hpp"
#include "experiment/footprint_model.hpp"
#include "experiment/gp_model.hpp"
#include "experiment/height_model.hpp"
#include "experiment/phases.hpp"
#include "experiment/surface_model.hpp"
#include "gp/candidates.hpp"

#include <palpate/backend.hpp>
#include <palpate/footprint.hpp>
#include <palpate/plugin.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// The belief behind the acquisitions, and what the metrics and the record want beyond it. A plain value: taps are
/// noted by observe(), quantities asked for by ask(), the maps brought up to date by update(); what reads, computes
/// nothing. A map that nobody asked for, or that update() has not seen the last tap of, throws std::logic_error.
class TapBelief final : public Belief {
 public:
  /// `candidates`, `context` and `clock` must outlive the belief.
  TapBelief(const ExperimentOptions& options, const Candidates& candidates, const Context& context, PhaseClock& clock);

  /// The taps so far, as they are read now.
  const ContactLog& log() const { return log_; }

  /// Notes a tap. Only contacts reach the models: heights above the desk, and labels 1 or 0, as they read. Where the
  /// config has learnt what is added to all heights, every contact so far is read again by what is thought of it now.
  void observe(const Target& place, const Contact& contact, const Manner& manner = {});

  /// From now on these quantities are kept and belong to the record: builds the models that they lack, with all taps so
  /// far, and updates. Models go through the very states that they would have had, had they been there from the first
  /// tap.
  void ask(Quantities wanted);
  /// The same, but nothing more belongs to the record.
  void build(Quantities wanted);

  /// Whether all models behind some quantities are built: then to build these costs a map, and no model changes.
  bool has_models_of(Quantities quantities) const;

  /// Has the models take in the taps noted since, one by one, fits included, and their maps follow.
  void update();

  /// The models behind some quantities, by their names: "height GP", "footprint primitives".
  std::vector<std::string> models_of(Quantities quantities) const;

  /// The quantities that belong to the record: those that were asked for, and what comes from the same models.
  Quantities recorded() const { return known(asked_); }

  /// What the reconstruction of the surface is made of.
  Quantities surface_reads() const;

  // Belief, for acquisitions.
  const Points& candidates() const override { return candidates_.points; }
  Area area() const override { return context_.scene.area(); }
  int taps() const override { return log_.taps(); }
  int initial_taps() const override { return log_.initial_taps(); }
  const std::vector<Target>& targets() const override { return log_.targets(); }
  const std::vector<Touch>& touches() const override { return log_.contacts(); }
  const Eigen::VectorXd& uncertainty() const override { return kept(heights_.uncertainty()); }
  const Eigen::VectorXd& weight() const override { return kept(label_map_.weight()); }
  const Eigen::VectorXd& probability() const override {
    return kept(footprint_ ? footprint_->probability() : label_map_.clipped());
  }
  const OutlineSample& outlines() const override;
  const Eigen::VectorXd& height_mean() const override { return kept(surface_ ? surface_->mean() : heights_.mean()); }
  const Eigen::VectorXd& height_variance() const override {
    return kept(surface_ ? surface_->variance() : heights_.variance());
  }

  /// Variance of the height GP, all taps seen, square metres: height_variance() unless the surface is two_part.
  /// There where the uncertainty is.
  const Eigen::VectorXd& all_taps_variance() const { return kept(heights_.variance()); }

  /// The mean of the label GP as it comes, whatever `label.clip` says.
  const Eigen::VectorXd& weight_mean() const { return kept(label_map_.mean()); }

  /// One output of a process.
  struct Output {
    const GaussianProcess* process = nullptr;
    int output = 0;
    const FitSummary* last_fit = nullptr;  ///< the fit after the latest tap; null if none was due then
    explicit operator bool() const { return process != nullptr; }
  };
  /// The processes as far as they were built, null if nothing has asked for them. u comes from the height GP,
  /// height_mean() and height_variance() from the surface GP: the same one for `surface: single`, that of the taps
  /// on an object for `two_part`.
  Output height_gp() const { return output(heights_.gp(), 0); }
  Output label_gp() const { return output(label_model(), label_output()); }
  Output surface_gp() const { return output(surface_model(), 0); }
  bool two_part() const { return surface_.has_value(); }
  /// Whether the probability is the weight, clipped: then what is shown of the outline is w, else p.
  bool footprint_is_weight() const { return !footprint_; }
  /// The footprint, if it is not the weight and was asked for; else null.
  const Footprint* footprint() const { return footprint_ && footprint_->is_shown() ? &footprint_->plugin() : nullptr; }

  /// The outlier model of `height.outlier_probability` with `surface: two_part`; null without, and before its GP is
  /// built.
  const OutlierModel* outliers() const { return surface_ ? surface_->outliers() : nullptr; }
  /// The contacts that are probably outliers; none without an outlier model.
  std::vector<SuspectedOutlier> suspected_outliers() const;
  /// The probability that a contact is an outlier; 0 without an outlier model.
  double outlier_probability(std::size_t contact) const;
  /// Whether the objects are thought to have been pushed since that contact: then it says nothing of its place any
  /// more.
  bool moved(std::size_t contact) const {
    return footprint_ && footprint_->has_moved(log_.prior_size() + static_cast<int>(contact));
  }
  /// Variances of the map of heights that rounding has taken below 0.
  int variances_clamped() const { return surface_ ? surface_->variances_clamped() : 0; }

  /// Fits that found nothing better and kept the old values.
  int failed_fits() const;

  /// Height of the desk, metres.
  double desk() const { return context_.scene.desk(); }

  /// Standard deviation of the noise of one tap's height, metres.
  double height_noise() const { return surface_model().noise(); }

  /// Of a candidate: the height, and the probability if that is among the `wanted`. What predictable() says of these
  /// was asked for: where contacts are doubted, a height at one place needs no map.
  Prediction predict(int candidate, Quantities wanted) const;
  Quantities predictable(Quantities wanted) const;

 private:
  Quantities known(Quantities asked) const;
  bool joined() const { return !labels_; }
  const GpModel& label_model() const { return labels_ ? *labels_ : heights_.gp(); }
  int label_output() const { return labels_ ? 0 : 1; }
  const GpModel& surface_model() const { return surface_ ? surface_->gp() : heights_.gp(); }
  static Output output(const GpModel& model, int output);
  /// Calls visit(gp) for each GP, built or not.
  template <class Visit>
  void for_each_gp(const Visit& visit);
  void add_data();
  void find_outliers();
  void update_maps();
  const Eigen::VectorXd& kept(const Eigen::VectorXd& map) const;

  const Candidates& candidates_;
  const Context& context_;
  PhaseClock& clock_;
  ContactLog log_;
  EngineSettings posterior_;
  HeightModel heights_;
  std::optional<GpModel> labels_;  ///< none: output 1 of heights_
  LabelMap label_map_;
  std::optional<SurfaceModel> surface_;      ///< none: the surface is the mean of heights_
  std::optional<FootprintModel> footprint_;  ///< none: the weight, clipped
  Quantities asked_;
  bool current_ = true;  ///< update() has seen all taps
};

}  // namespace palpate
