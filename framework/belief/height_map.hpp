// SPDX-License-Identifier: MIT
// The belief `height_map`: one height per position on the desk, tapped from above.
#pragma once

#include "belief/height_map_models.hpp"
#include "belief/metrics.hpp"

#include <palpate/belief.hpp>

#include <optional>
#include <string_view>
#include <vector>

namespace palpate {

class HeightMapBelief final : public Belief {
 public:
  using Options = HeightMapOptions;
  /// `context` must outlive the belief. Throws Error for options that a plugin rejects.
  HeightMapBelief(const HeightMapOptions& options, const Context& context);

  std::vector<Quantity> offers() const override;
  std::vector<PlannedModel> plan(const ReadPlan& plan) override;
  void begin(Stage stage) override;
  std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const override {
    return models_.log().reader().read(request, result);
  }
  void add(const TapRequest& request, const TapResult& result) override;
  void update() override;
  void infer() override { models_.infer(); }
  QuantitySet available() const override;

  const Candidates& candidates() const override { return lines_; }
  const TapsSoFar& taps() const override { return taps_; }
  const Eigen::VectorXd& values(std::string_view quantity) const override;
  std::optional<double> scalar(std::string_view quantity) const override;
  const HypothesisSample& hypotheses() const override;
  Prediction predict(Eigen::Index candidate, bool probability) const override {
    return models_.predict(candidate, probability);
  }

  BeliefState state(std::optional<Eigen::Index> candidate) const override;
  void set_truth(const Scene* scene) override;
  std::optional<BeliefErrors> errors(ErrorsFor purpose) override;
  Surface surface(double /*resolution*/) override { return {reconstruction(maps()), {}, {}, 0.0}; }

  const HeightModels& models() const { return models_; }

 private:
  /// Returns pointers to the arrays of the surface. A pointer is null if `models` does not compute its array.
  SurfaceMaps maps(const ModelSet& models) const;
  SurfaceMaps maps() const { return maps(begun_); }
  std::optional<double> expected_rmse_of(const SurfaceMaps& maps) const;
  const Truth* truth();
  void add_gp_states(BeliefState& out, bool summary) const;
  void add_values(BeliefState& out, Eigen::Index candidate) const;
  void add_calibration(BeliefState& out) const;

  const HeightMapOptions options_;
  const Context& context_;
  Candidates lines_;
  CandidateGrid grid_;
  HeightModels models_;
  ReadPlan plan_;
  ModelSet begun_;  ///< models that are needed in the stages begun so far; their states are recorded
  TapsSoFar taps_;
  mutable Eigen::VectorXd height_std_, measurement_std_;  ///< computed when they are read
  const Scene* scene_ = nullptr;                          ///< the true scene; null if it is not known
  std::optional<Truth> truth_;                            ///< the true scene at the candidates
};

}  // namespace palpate
