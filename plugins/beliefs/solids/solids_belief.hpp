// SPDX-License-Identifier: MIT
// The belief `solids`: closed surfaces in space, tapped from any side. Particles made of simple solids, and a residual
// GP that corrects the best of them.
#pragma once

#include "solids/line_sampler.hpp"
#include "solids/line_values.hpp"
#include "solids/residual_gp.hpp"
#include "solids/solids.hpp"
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

/// Its quantities of a line, by the most probable particle:
/// - expected_discovery, metres: what a tap is expected to find that nobody has touched yet, were one primitive more
///   expected a priori than is believed: the probability that there is one which no touch so far contradicts and which
///   the line meets before all that is believed, times how far it moves the surface: the mean over lines from all sides
///   of how much earlier they are met, of which no line counts more than 3 cm.
/// - std_reduction, metres: by how much a tap is expected to lower the standard deviation of the believed surface, the
///   mean over all of it; 0 for lines that meet no object, or meet it at less than 30 degrees.
/// - surface_std, metres: standard deviation of the surface along its normal where the line meets it; else 0.
class SolidsBelief final : public Belief {
 public:
  using Options = SolidsOptions;
  /// `context` must outlive it. Throws Error for a kernel that is not one of the distance alone, and for a fitting: no
  /// hyperparameter is fitted.
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
  /// Without vertices before an object is known.
  Surface surface(double resolution) override;
  LineFacts explain(const TapLine& line) const override;

 private:
  const Context& context_;
  const SolidsOptions options_;
  Region region_;
  TouchLog touches_;
  Solids solids_;
  ResidualGp residual_gp_;
  SampledLines lines_;
  LineValues values_;
  SurfaceErrors errors_;
  ReadPlan plan_;
  std::set<Stage> begun_;
  std::size_t taken_in_ = 0;                                   ///< of the touches, by the solids
  int updated_for_ = -1, drawn_for_ = -1, inferred_for_ = -1;  ///< taps after which that was done
};

}  // namespace palpate
