// SPDX-License-Identifier: MIT
// The models of the belief `height_map`: the height GP and the label GP over the candidates, the footprint, and with
// `surface: two_part` the GP of the heights on objects. A GP of heights and labels with equal kernel and equal ratio of
// noise to signal has two outputs and one factorisation.
#pragma once

#include "belief/contact_log.hpp"
#include "belief/footprint_model.hpp"
#include "belief/gp_model.hpp"
#include "belief/height_map_options.hpp"
#include "belief/height_model.hpp"
#include "belief/metrics.hpp"
#include "belief/surface_model.hpp"
#include "gp/candidate_grid.hpp"

#include <palpate/belief.hpp>
#include <palpate/footprint.hpp>
#include <palpate/plugin.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Models, by the arrays that they have.
struct ModelSet {
  bool heights = false;      ///< the height GP: uncertainty, measurement_std
  bool labels = false;       ///< the label GP: label_mean
  bool surface = false;      ///< the surface GP of `two_part`, for heights at one candidate
  bool surface_map = false;  ///< and for its arrays
  bool footprint = false;    ///< a footprint that is not the label GP
  bool hypotheses = false;
};

class HeightModels {
 public:
  /// Creates all plugins, so that options which they reject are rejected before the first tap. `candidates` and
  /// `context` must outlive it.
  HeightModels(const HeightMapOptions& options, const CandidateGrid& candidates, const Context& context);

  const ContactLog& log() const { return log_; }

  /// Returns the models that some quantities need; `at_one_candidate`: by predict() alone. kOutliers is among them.
  ModelSet models_of(const QuantitySet& quantities, bool at_one_candidate = false) const;
  /// The outlier probabilities of contacts, which need the surface GP without its arrays.
  static constexpr const char* kOutliers = "outlier_probability";
  /// Returns their names: "height GP", "footprint primitives".
  std::vector<std::string> names_of(const ModelSet& models) const;

  /// Takes the result of a tap. Only contacts reach the models.
  void add(const TapRequest& request, const TapResult& result);

  /// Builds models that are missing, from the next update() on with all taps so far: they pass through the very states
  /// that they would have had, had they been built before the first tap.
  void build(const ModelSet& models);

  /// Has the built models take in the taps since, one by one, fits included; then the footprint, then the outliers.
  void update();
  /// Brings the arrays of the built models up to date, after update(). Throws Error for values that are not finite.
  void infer();

  /// Whether the arrays are those of the last tap.
  bool is_inferred() const { return is_updated_ && is_inferred_; }

  // The arrays, M values each; empty before infer(), and without their model.
  const HeightModel& heights() const { return heights_; }
  const LabelMap& label_map() const { return label_map_; }
  const Eigen::VectorXd& height_mean() const { return surface_ ? surface_->mean() : heights_.mean(); }
  const Eigen::VectorXd& height_variance() const { return surface_ ? surface_->variance() : heights_.variance(); }
  const Eigen::VectorXd& probability() const { return footprint_ ? footprint_->probability() : label_map_.clipped(); }
  /// Returns height and, if `probability`, the object probability at a candidate, after infer().
  Prediction predict(Eigen::Index candidate, bool probability) const;

  /// One output of a GP.
  struct Output {
    const GaussianProcess* process = nullptr;
    int output = 0;
    const FitSummary* last_fit = nullptr;  ///< the fit after the latest tap; null if none was due then
    explicit operator bool() const { return process != nullptr; }
  };
  /// The GPs; null before they are built. The surface GP is the height GP with `surface: single`.
  struct Gps {
    Output height, label, surface;
  };
  Gps gps() const;
  /// Nullopt with `surface: single`.
  const std::optional<SurfaceModel>& surface() const { return surface_; }
  /// Null if the footprint is the label GP.
  const FootprintModel* footprint() const { return footprint_ ? &*footprint_ : nullptr; }

  /// Sets `out` to the contacts as the log and the built models read them now.
  void read_again(std::vector<TapReading>& out) const;
  /// Number of fits that found nothing better and kept the old hyperparameters.
  int failed_fits() const;
  /// Standard deviation of the noise of a height, metres.
  double height_noise() const { return surface_model().noise(); }

 private:
  bool is_joined() const { return !labels_; }
  const GpModel& label_model() const { return labels_ ? *labels_ : heights_.gp(); }
  int label_output() const { return labels_ ? 0 : 1; }
  const GpModel& surface_model() const { return surface_ ? surface_->gp() : heights_.gp(); }
  const OutlierModel* outliers() const { return surface_ ? surface_->outliers() : nullptr; }
  /// Calls visit(gp) for each GP, built or not.
  template <class Visit>
  void for_each_gp(const Visit& visit);
  void add_data();
  void find_outliers();

  const Context& context_;
  ContactLog log_;
  HeightModel heights_;
  std::optional<GpModel> labels_;  ///< none: output 1 of heights_
  LabelMap label_map_;
  std::optional<SurfaceModel> surface_;      ///< none: the surface is the mean of heights_
  std::optional<FootprintModel> footprint_;  ///< none: the label GP, clipped
  bool is_updated_ = true, is_inferred_ = true;
};

}  // namespace palpate
