// SPDX-License-Identifier: MIT
// The belief `solids`: closed surfaces in space, tapped from any side. It consists of particles made of simple solids,
// and of a residual GP that corrects the most probable particle.
#pragma once

#include "solids/assembly_sampler.hpp"
#include "solids/candidate_lines.hpp"
#include "solids/candidate_quantities.hpp"
#include "solids/residual_gp.hpp"
#include "solids/solids_options.hpp"
#include "solids/surface_errors.hpp"
#include "solids/touch_log.hpp"

#include <palpate/belief.hpp>
#include <palpate/plugin.hpp>

#include <optional>
#include <set>
#include <string_view>
#include <vector>

namespace palpate {

/// Quantities of a line, for the most probable particle:
/// - expected_discovery, metres: expected change of the surface by objects that a tap along the line discovers. The
///   prior is assumed to expect one primitive more than the particle contains. Such a primitive counts if no touch so
///   far contradicts it and the line meets it before the estimated surface. The value is the probability of such a
///   primitive times the change. The change is the decrease of the distance to the surface along a line, at most 3 cm,
///   averaged over lines from all sides.
/// - std_reduction, metres: expected decrease of the surface's mean standard deviation after a tap along the line. The
///   value is 0 for lines that meet no object, or meet it at less than 30 degrees to its surface.
/// - surface_std, metres: standard deviation of the surface along its normal where the line meets it; else 0.
class SolidsBelief final : public Belief {
 public:
  using Options = SolidsOptions;
  /// `context` must outlive the object. Throws Error if the kernel depends on more than the distance, or unless
  /// `fitting` is `fixed`: this belief fits no hyperparameters.
  SolidsBelief(const SolidsOptions& options, const Context& context);

  std::vector<Quantity> offers() const override;
  std::vector<PlannedModel> plan(const ReadPlan& plan) override;
  void begin(Stage stage) override { begun_.insert(stage); }
  std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const override {
    return touches_.read(request, result);
  }
  void add(const TapRequest& request, const TapResult& result) override { touches_.add(request, result); }
  void update() override;
  void infer() override;
  QuantitySet available() const override;
  void draw_candidates(const LineFilter& filter) override;
  bool is_ready() const override;
  bool reads_scene() const override { return options_.view.has_value(); }

  const Candidates& candidates() const override { return lines_.lines; }
  const TapsSoFar& taps() const override { return touches_.taps(); }
  const Eigen::VectorXd& values(std::string_view quantity) const override;
  std::optional<double> scalar(std::string_view quantity) const override;

  BeliefState state(std::optional<Eigen::Index> candidate) const override;
  void set_truth(const Scene* scene) override { errors_.set_truth(scene); }
  std::optional<BeliefErrors> errors(ErrorsFor purpose) override;
  /// Returns a surface without vertices before an object is known.
  Surface surface(double resolution) override;
  LineFacts explain(const TapLine& line) const override;

 private:
  const Context& context_;
  const SolidsOptions options_;
  SearchBall region_;
  TouchLog touches_;
  AssemblySampler solids_;
  ResidualGp residual_gp_;
  SampledLines lines_;
  CandidateQuantities values_;
  SurfaceErrors errors_;
  ReadPlan plan_;
  std::set<Stage> begun_;
  std::size_t taken_in_ = 0;                                   ///< number of touches that solids_ contains
  int updated_for_ = -1, drawn_for_ = -1, inferred_for_ = -1;  ///< number of taps at the last update of each kind
};

}  // namespace palpate
