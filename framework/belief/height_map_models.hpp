// SPDX-License-Identifier: MIT
// The models of the belief `height_map`: the height GP and the label GP over the candidates, the footprint, and with
// `surface: two_part` the GP of the heights on objects. If height GP and label GP have the same kernel and the same
// ratio of noise to signal, they are one GP with two outputs and one factorisation.
#pragma once

#include "belief/contact_log.hpp"
#include "belief/footprint_model.hpp"
#include "belief/gp_model.hpp"
#include "belief/height_map_options.hpp"
#include "belief/height_model.hpp"
#include "belief/surface_model.hpp"
#include "gp/candidate_grid.hpp"

#include <palpate/belief.hpp>
#include <palpate/footprint.hpp>
#include <palpate/plugin.hpp>

#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A set of models. The comment of a member lists the quantities that its model provides as arrays.
struct ModelSet {
  bool heights = false;      ///< the height GP: uncertainty, measurement_std
  bool labels = false;       ///< the label GP: label_mean
  bool surface = false;      ///< the surface GP of `two_part`, only for heights at single candidates; no arrays
  bool surface_map = false;  ///< the surface GP with its arrays: height_mean, height_std
  bool footprint = false;    ///< a footprint that is not the label GP
  bool hypotheses = false;
};

class HeightModels {
 public:
  /// Creates all plugins, so that options which they reject are rejected before the first tap. `candidates` and
  /// `context` must outlive the models.
  HeightModels(const HeightMapOptions& options, const CandidateGrid& candidates, const Context& context);

  const ContactLog& log() const { return log_; }

  /// Returns the models that `quantities` need. kOutliers may be one of the quantities. `at_one_candidate`: whether the
  /// quantities are only read by predict().
  ModelSet models_of(const QuantitySet& quantities, bool at_one_candidate = false) const;
  /// Internal quantity: the outlier probabilities of contacts. They need the surface GP, but not its arrays.
  static constexpr const char* kOutliers = "outlier_probability";
  /// Returns the names of models, such as "height GP" or "footprint primitives".
  std::vector<std::string> names_of(const ModelSet& models) const;

  /// Adds the result of a tap to the log. Only contacts change the models.
  void add(const TapRequest& request, const TapResult& result);

  /// Builds the models that do not exist yet. The next update() adds all taps so far one by one, so the new models pass
  /// through the same states as models that were built before the first tap.
  void build(const ModelSet& models);

  /// Adds the taps since the last update to the built models, one by one, fits included. Then updates the footprint,
  /// and then the outlier probabilities.
  void update();
  /// Updates the arrays of the built models; requires update(). Throws Error for values that are not finite.
  void infer();

  /// Returns whether the arrays include the last tap.
  bool is_inferred() const { return is_updated_ && is_inferred_; }

  // The arrays, M values each. An array is empty before infer(), and if its model is not built.
  const HeightModel& heights() const { return heights_; }
  const LabelMap& label_map() const { return label_map_; }
  const Eigen::VectorXd& height_mean() const { return surface_ ? surface_->mean() : heights_.mean(); }
  const Eigen::VectorXd& height_variance() const { return surface_ ? surface_->variance() : heights_.variance(); }
  const Eigen::VectorXd& probability() const { return footprint_ ? footprint_->probability() : label_map_.clipped(); }
  /// Returns the height and, if `probability` is true, the object probability at a candidate. Requires infer().
  Prediction predict(Eigen::Index candidate, bool probability) const;

  /// One output of a GP.
  struct Output {
    const GaussianProcess* process = nullptr;
    int output = 0;
    const FitSummary* last_fit = nullptr;  ///< the fit after the latest tap; null if none was due then
    explicit operator bool() const { return process != nullptr; }
  };
  /// The GPs; null before they are built. With `surface: single`, `surface` is the height GP.
  struct Gps {
    Output height, label, surface;
  };
  Gps gps() const;
  /// Returns nullopt with `surface: single`.
  const std::optional<SurfaceModel>& surface() const { return surface_; }
  /// Returns null if the footprint is the label GP.
  const FootprintModel* footprint() const { return footprint_ ? &*footprint_ : nullptr; }

  /// Sets `out` to the current readings of all contacts, from the log and the built models.
  void read_again(std::vector<TapReading>& out) const;
  /// Returns the number of failed fits (FitSummary::failed), which kept the old hyperparameters.
  int failed_fits() const;
  /// Returns the standard deviation of the noise of a height, metres.
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
  std::optional<GpModel> labels_;  ///< nullopt: the labels are output 1 of heights_
  LabelMap label_map_;
  std::optional<SurfaceModel> surface_;      ///< nullopt: the surface is the mean of heights_
  std::optional<FootprintModel> footprint_;  ///< nullopt: the footprint is the clipped label GP
  bool is_updated_ = true, is_inferred_ = true;
};

}  // namespace palpate
