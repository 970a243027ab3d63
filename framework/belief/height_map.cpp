// SPDX-License-Identifier: MIT
#include "belief/height_map.hpp"

#include "belief/expected_rmse.hpp"
#include "belief/object_errors.hpp"
#include "gp/candidate_grid.hpp"
#include "regular/factor_diagnostics.hpp"

#include <palpate/grid.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace palpate {
namespace {

/// Adds the fields of a GP, whose names begin with `name`. Before the GP is built, the fields are null, and the fields
/// of kernel and fit are left out.
void add_gp(BeliefState& out, const std::string& name, const HeightModels::Output& gp, bool summary) {
  const auto add = [&](const char* field, auto value) {
    out.add(name + "." + field, gp ? std::optional(value) : std::nullopt);
  };
  const GpSettings settings = gp ? gp.process->settings(gp.output) : GpSettings();
  const GpDiagnostics numbers = gp ? gp.process->diagnostics(gp.output) : GpDiagnostics();
  const EngineReport engine = gp ? gp.process->engine() : EngineReport{"", "", 0.0};
  if (gp) {
    for (const KernelParameter& one : gp.process->kernel().parameters())
      out.add(name + ".kernel." + one.name, one.value);
  }
  add("signal", settings.signal);
  add("noise", settings.noise);
  add("mean", settings.mean);
  add("log_marginal_likelihood", numbers.log_marginal_likelihood);
  add("jitter", numbers.factors.jitter);
  add("condition", numbers.condition);
  add("engine", std::string(engine.name));
  add("error_bound", engine.error_bound);
  if (gp && gp.last_fit != nullptr) {
    out.add(name + ".fit.changed", gp.last_fit->changed);
    out.add(name + ".fit.objective", gp.last_fit->objective);
    out.add(name + ".fit.evaluations", std::int64_t{gp.last_fit->evaluations});
    out.add(name + ".fit.reason", gp.last_fit->reason);
  }
  if (summary) add("engine_reason", engine.reason);
}

void add_footprint(BeliefState& out, const Footprint& footprint) {
  for (const FootprintNumber& one : footprint.numbers()) out.add("footprint." + one.name, one.value);
  const std::string remark = footprint.remark();
  out.add("footprint.remark", remark.empty() ? std::nullopt : std::optional(remark));
}

/// Returns the diagnostics of factorisations among the numbers that a footprint reports.
FactorReport factors_of(const Footprint& footprint) {
  FactorReport out;
  for (const FootprintNumber& one : footprint.numbers()) {
    if (one.name == "jitter") out.jitter = one.value;
    if (one.name == "jitter_raised") out.raised = static_cast<int>(one.value);
    if (one.name == "pivoted") out.pivoted = static_cast<int>(one.value);
    if (one.name == "redundant_taps") out.redundant_taps = static_cast<int>(one.value);
  }
  return out;
}

/// Returns the suspected outliers as a list; nullopt if there are none. Probabilities are rounded to two decimals.
std::optional<JsonList> outliers_among(const std::vector<TapReading>& readings) {
  std::vector<std::string> rows;
  for (const TapReading& one : readings) {
    if (one.outlier_probability < OutlierModel::kRetapThreshold) continue;
    const double rounded = std::round(100.0 * one.outlier_probability) / 100.0;
    rows.push_back(fmt::format(R"({{"tap": {}, "probability": {}}})", one.tap, rounded));
  }
  return rows.empty() ? std::nullopt : std::optional(JsonList{fmt::format("[{}]", fmt::join(rows, ", "))});
}

ModelSet operator|(ModelSet a, const ModelSet& b) {
  a.heights |= b.heights;
  a.labels |= b.labels;
  a.surface |= b.surface;
  a.surface_map |= b.surface_map;
  a.footprint |= b.footprint;
  a.hypotheses |= b.hypotheses;
  return a;
}

}  // namespace

HeightMapBelief::HeightMapBelief(const HeightMapOptions& options, const Context& context)
    : options_(options),
      context_(context),
      lines_(grid_from_above(context)),
      grid_(grid_of(lines_)),
      models_(options_, grid_, context) {}

std::vector<Quantity> HeightMapBelief::offers() const {
  using namespace quantity;
  return {{kUncertainty, "variance of the height GP at the candidate, relative to its prior, noise excluded"},
          {kMeasurementStd, "standard deviation of the height GP at the candidate, noise excluded (m)"},
          {kLabelMean, "mean of the label GP, clipped to [0, 1] with `label: {clip: true}`"},
          {kObjectProbability, "probability that the candidate is on an object, by the footprint"},
          {kHeightMean, "mean height of the surface (m)"},
          {kHeightStd, "standard deviation of the height of the surface, noise excluded (m)"},
          {kHypotheses, "hypotheses of the footprint, and the area that a tap is expected to discover (m^2)"},
          {kDeskPosition, "fixed positions of the candidates on the desk"},
          {kExpectedRmse, "expected RMSE of the reconstructed surface over the candidates (m)"},
          {kUndiscoveredProbability, "probability of an object that no tap has touched"},
          {kObjectSeen, "whether a camera saw an object before the first tap"}};
}

std::vector<PlannedModel> HeightMapBelief::plan(const ReadPlan& plan) {
  plan_ = plan;
  if (options_.height.outlier_probability)
    plan_.readers.push_back({"belief.height.outlier_probability", {HeightModels::kOutliers}, Stage::first_tap});
  if (plan.surface_from)
    plan_.readers.push_back({"surface", {quantity::kHeightMean, quantity::kObjectProbability}, *plan.surface_from});
  std::vector<PlannedModel> out;
  for (const ReadPlan::Reader& reader : plan_.readers) {
    if (reader.from == Stage::summary) continue;  // these readers do not influence taps
    for (const std::string& model : models_.names_of(models_.models_of(reader.reads, reader.at_one_candidate))) {
      const bool is_known = std::any_of(out.begin(), out.end(), [&](const PlannedModel& one) {
        return one.model == model && one.reader == reader.name;
      });
      if (!is_known) out.push_back({model, reader.name});
    }
  }
  return out;
}

void HeightMapBelief::begin(Stage stage) {
  ModelSet more;
  for (const ReadPlan::Reader& reader : plan_.readers) {
    if (reader.from == stage) more = more | models_.models_of(reader.reads, reader.at_one_candidate);
  }
  begun_ = begun_ | more;
  models_.build(more);
}

void HeightMapBelief::add(const TapRequest& request, const TapResult& result) {
  models_.add(request, result);
  taps_.add(request);
  models_.read_again(taps_.readings);
}

void HeightMapBelief::update() {
  models_.update();
  models_.read_again(taps_.readings);
}

QuantitySet HeightMapBelief::available() const {
  using namespace quantity;
  QuantitySet out;
  if (begun_.heights) out = out | QuantitySet{kUncertainty, kMeasurementStd};
  if (begun_.labels) out.insert(kLabelMean);
  if (models_.surface() ? begun_.surface_map : begun_.heights) out = out | QuantitySet{kHeightMean, kHeightStd};
  if (models_.footprint() != nullptr ? begun_.footprint : begun_.labels) out.insert(kObjectProbability);
  if (begun_.hypotheses) out.insert(kHypotheses);
  return out;
}

const Eigen::VectorXd& HeightMapBelief::values(std::string_view quantity) const {
  using namespace quantity;
  const Eigen::VectorXd* out = nullptr;
  if (quantity == kUncertainty) out = &models_.heights().uncertainty();
  if (quantity == kMeasurementStd) out = &(measurement_std_ = models_.heights().variance().cwiseSqrt());
  if (quantity == kLabelMean) out = &models_.label_map().weight();
  if (quantity == kObjectProbability) out = &models_.probability();
  if (quantity == kHeightMean) out = &models_.height_mean();
  if (quantity == kHeightStd) out = &(height_std_ = models_.height_variance().cwiseMax(0.0).cwiseSqrt());
  if (out == nullptr || out->size() == 0)
    throw std::logic_error(std::string(quantity) + " is read, but no begun reader has it");
  if (!models_.is_inferred())
    throw std::logic_error(std::string(quantity) + " is read, but is older than the last tap");
  return *out;
}

std::optional<double> HeightMapBelief::scalar(std::string_view quantity) const {
  if (quantity == quantity::kObjectSeen) return models_.log().prior_objects() > 0 ? 1.0 : 0.0;
  const FootprintModel* const footprint = models_.footprint();
  if (quantity == quantity::kUndiscoveredProbability)
    return footprint != nullptr && footprint->is_shown() ? footprint->plugin().undiscovered_probability()
                                                         : std::nullopt;
  return quantity == quantity::kExpectedRmse ? expected_rmse_of(maps()) : std::nullopt;
}

std::optional<double> HeightMapBelief::expected_rmse_of(const SurfaceMaps& maps) const {
  if (maps.height == nullptr || (maps.two_part && maps.probability == nullptr)) return std::nullopt;
  return expected_rmse(maps, models_.height_variance(), models_.gps().surface.process, models_.log().object_contacts());
}

const HypothesisSample& HeightMapBelief::hypotheses() const {
  static const HypothesisSample none;
  return models_.footprint() != nullptr ? models_.footprint()->hypotheses() : none;
}

SurfaceMaps HeightMapBelief::maps(const ModelSet& models) const {
  const bool height = models_.surface() ? models.surface_map : models.heights;
  const bool probability = models_.footprint() != nullptr ? models.footprint : models.labels;
  return {height ? &models_.height_mean() : nullptr, probability ? &models_.probability() : nullptr,
          models_.surface().has_value(), context_.scene.desk()};
}

BeliefState HeightMapBelief::state(std::optional<Eigen::Index> candidate) const {
  BeliefState out;
  constexpr std::size_t kUsualFields = 32;
  out.fields.reserve(kUsualFields);
  if (candidate) {
    add_values(out, *candidate);
  } else {
    for (const char* kind : {"fit_failed", "jitter", "pivoted", "redundant_taps", "variance_clamped"})
      out.diagnostics[kind] = 0;
    add_calibration(out);
  }
  add_gp_states(out, !candidate);
  const FootprintModel* const footprint = models_.footprint();
  if (footprint != nullptr && begun_.footprint) {
    add_footprint(out, footprint->plugin());
    if (!candidate) count_factors(out, factors_of(footprint->plugin()));
  }
  const bool has_outliers = options_.height.outlier_probability.has_value();
  const OutlierModel* const outliers = models_.surface() ? models_.surface()->outliers() : nullptr;
  if (has_outliers) out.add("suspected_outliers", outliers_among(taps_.readings));
  if (has_outliers && outliers != nullptr && !candidate) {
    count_factors(out, outliers->surface().report());
    out.diagnostics["variance_clamped"] += models_.surface()->variances_clamped();
  }
  if (!candidate) out.diagnostics["fit_failed"] = models_.failed_fits();
  const bool expects = std::any_of(plan_.readers.begin(), plan_.readers.end(), [](const ReadPlan::Reader& one) {
    return one.reads.count(quantity::kExpectedRmse) != 0;
  });
  if (expects || !candidate) out.add("expected_rmse_m", scalar(quantity::kExpectedRmse));
  return out;
}

void HeightMapBelief::add_values(BeliefState& out, Eigen::Index candidate) const {
  std::optional<double> u, w;
  if (begun_.heights) {
    u = models_.heights().uncertainty()(candidate);
    const Eigen::VectorXd& variance = models_.heights().variance();
    out.add("max_standard_deviation", std::sqrt(variance.maxCoeff<Eigen::PropagateNaN>()));
    out.add("mean_standard_deviation", variance.cwiseSqrt().mean());
  }
  if (begun_.labels) {
    w = models_.label_map().weight()(candidate);
    out.add("min_weight", models_.label_map().mean().minCoeff());
    out.add("max_weight", models_.label_map().mean().maxCoeff());
  }
  out.add("u", u);
  out.add("w", w);
  out.add("e", u && w ? std::optional(*u * *w) : std::nullopt);
  if (begun_.footprint) out.add("p", models_.probability()(candidate));
}

void HeightMapBelief::add_gp_states(BeliefState& out, bool summary) const {
  std::vector<const GaussianProcess*> counted;  // one GP may have several outputs
  const auto add = [&](const char* name, const HeightModels::Output& gp, bool is_recorded) {
    add_gp(out, name, is_recorded ? gp : HeightModels::Output(), summary);
    if (!summary || !gp) return;
    FactorReport factors = gp.process->diagnostics(gp.output).factors;
    if (std::find(counted.begin(), counted.end(), gp.process) != counted.end()) {
      factors.raised = factors.pivoted = 0;
    } else {
      counted.push_back(gp.process);
      out.diagnostics["variance_clamped"] += gp.process->variances_clamped();
    }
    count_factors(out, factors);
  };
  const HeightModels::Gps gps = models_.gps();
  add("height_gp", gps.height, summary || begun_.heights);
  add("label_gp", gps.label, summary || begun_.labels);
  const bool has_surface = models_.surface() && (summary ? bool(gps.surface) : begun_.surface_map);
  if (has_surface) add("surface_gp", gps.surface, true);
}

void HeightMapBelief::add_calibration(BeliefState& out) const {
  const SurfaceMaps all = maps();
  Calibration calibrated;
  if (truth_ && all.height != nullptr) {
    std::vector<bool> tapped(static_cast<std::size_t>(grid_.size()), false);
    for (const TapReading& one : taps_.readings) {
      const int candidate = grid_.nearest(one.position.x(), one.position.y(), context_.scene.area());
      tapped[static_cast<std::size_t>(candidate)] = true;
    }
    calibrated = calibration(*all.height, models_.height_variance(), models_.height_noise(), *truth_, tapped);
  }
  out.add("nlpd", calibrated.nlpd);
  out.add("coverage_95", calibrated.coverage_95);
}

void HeightMapBelief::set_truth(const Scene* scene) {
  scene_ = scene;
  truth_.reset();
}

const Truth* HeightMapBelief::truth() {
  if (scene_ != nullptr && !truth_) truth_ = truth_at(grid_, *scene_);
  return truth_ ? &*truth_ : nullptr;
}

std::optional<BeliefErrors> HeightMapBelief::errors(ErrorsFor purpose) {
  ModelSet models = begun_;
  if (purpose == ErrorsFor::display) {
    models = truth() != nullptr ? models_.models_of({quantity::kHeightMean, quantity::kObjectProbability})
                                : models_.models_of({quantity::kExpectedRmse});
    const HeightModels::Gps gps = models_.gps();
    const bool has_all = (!models.heights || gps.height) && (!models.labels || gps.label) &&
                         (!models.surface || gps.surface) && (!models.footprint || models_.footprint()->is_shown());
    if (!has_all) return std::nullopt;
    models_.build(models);
    models_.update();
    models_.infer();
  }
  const SurfaceMaps all = maps(models);
  BeliefErrors out;
  if (truth() != nullptr) out.errors = errors_of(all, *truth_);
  if (purpose == ErrorsFor::summary && truth_) out.objects = object_errors(all, *truth_, grid_);
  if (purpose == ErrorsFor::display) out.expected_rmse = expected_rmse_of(all);
  return out;
}

}  // namespace palpate
