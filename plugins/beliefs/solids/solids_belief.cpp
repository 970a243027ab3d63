// SPDX-License-Identifier: MIT
#include "solids/solids_belief.hpp"

#include "gp/finite.hpp"
#include "regular/factor_diagnostics.hpp"
#include "solids/camera_rays.hpp"
#include "solids/mesh.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace palpate {
namespace {

/// Largest cost of a touch in nats, once contacts have shown errors. It is less than the cost of a floating primitive,
/// so one contact in the air creates no primitive. A model with two outliers per hundred touches, anywhere on the path,
/// would have about the same largest cost.
constexpr double kMostCost = 6.5;

constexpr std::int64_t kLines = 2000;  // drawn before each tap

AssemblySamplerSettings settings_of(const SolidsOptions& options) {
  AssemblySamplerSettings out;
  out.count = static_cast<int>(options.particles);
  out.moves = static_cast<int>(options.moves);
  out.misfit = options.model_discrepancy;
  return out;
}

LineFacts::Solid facts_of(const Primitive& primitive) {
  constexpr const char* kForms[] = {"box", "cylinder", "ellipsoid"};  // by Primitive::Form
  LineFacts::Solid out{kForms[static_cast<std::size_t>(primitive.form)], 2.0 * primitive.half, primitive.wall};
  if (primitive.form == Primitive::Form::ellipsoid && primitive.hollow()) {
    out.form = "bowl";
    out.extent.z() *= 0.5;
  }
  return out;
}

/// Returns the radius of the tool's tip, metres. It is the same for all backends.
double tip_of(const Scene& scene) { return scene.effects().tip_radius ? scene.effects().tip_radius->radius : 0.0; }

}  // namespace

SolidsBelief::SolidsBelief(const SolidsOptions& options, const Context& context)
    : context_(context),
      options_(options),
      region_(context.scene.area()),
      touches_(context.scene.desk(), tip_of(context.scene), context.scene.min_object_height()),
      solids_(context.scene.area(), settings_of(options), context.random("space/solids")),
      residual_gp_(context.create<Kernel>(context.run.kernel),
                   ResidualGpSettings{options.residual.signal, options.residual.noise}),
      values_(context.scene.desk()),
      errors_(region_) {
  lines_.lines.fixed = false;
  if (context.run.fitting.type != "fixed")
    throw Error(
        "fitting",
        fmt::format("{} fits nothing for the belief solids, which has fixed hyperparameters", context.run.fitting.type),
        "use fitting=fixed");
  if (!options.view) return;
  constexpr std::size_t kMost = 160;  // number of kept rays; the time per touch grows with it
  const std::vector<SurfaceTouch> view =
      side_view(*options.view, context.scene, region_.centre, region_.radius, context.random("space/view"));
  touches_.look(thinned_view(view, kMost), shows_object(view));
}

std::vector<Quantity> SolidsBelief::offers() const {
  using namespace quantity;
  return {{kUncertainty, "variance of the surface where a line along its normal meets it, relative to the largest"},
          {kMeasurementStd, "standard deviation of the surface along its normal where the line meets it (m)"},
          {kExpectedDistance, "distance along the line to the most probable particle, the desk or the end (m)"},
          {kSurfaceStd, "the same as measurement_std (m)"},
          {kIncidenceCosine, "cosine between line and normal, 0 without an object"},
          {kExpectedDiscovery, "expected change of the surface by objects that a tap discovers (m)"},
          {kStdReduction, "expected reduction of the mean standard deviation of the surface by a tap (m)"},
          {kObjectSeen, "whether a camera saw an object before the first tap"}};
}

std::vector<PlannedModel> SolidsBelief::plan(const ReadPlan& plan) {
  plan_ = plan;
  return {{"particles", "belief solids"}, {"residual GP", "belief solids"}};
}

void SolidsBelief::update() {
  if (updated_for_ == taps().count) return;
  updated_for_ = taps().count;
  drawn_for_ = -1;
  const std::vector<SurfaceTouch>& touches = touches_.touches();
  const PhaseClock::Scope infer(context_.clock, Phase::infer);
  const auto first = [&](std::size_t count) {
    return std::vector<SurfaceTouch>(touches.begin(), touches.begin() + static_cast<std::ptrdiff_t>(count));
  };
  if (taken_in_ < touches_.seen()) {
    solids_.look(first(touches_.seen()));
    taken_in_ = touches_.seen();
  }
  if (touches_.take_changes()) {
    // The error of a touch consists of the distance between solids and objects, and of the error of the report.
    const double error = touches_.overtravel().spread();
    const double spread = error > Overtravel::kLeastSpread ? error : 0.0;
    solids_.read_again(first(taken_in_), math::hypot(options_.model_discrepancy, spread), kMostCost);
    residual_gp_.set_noise(std::max(options_.residual.noise, spread));
  }
  for (; taken_in_ < touches.size(); ++taken_in_) solids_.add({touches[taken_in_]});
  residual_gp_.fit(solids_.best(), touches);
}

void SolidsBelief::draw_candidates(const LineFilter& filter) {
  if (drawn_for_ == taps().count) return;
  const PhaseClock::Scope infer(context_.clock, Phase::infer);
  // One random stream per tap: the lines depend only on the touches, and a resumed run draws the same lines.
  Random random = context_.random("space/approaches", static_cast<std::uint64_t>(taps().count));
  const bool is_known = taps().count > 0 || touches_.seen() > 0;
  lines_ =
      sample_lines(region_, context_.scene.desk(), static_cast<std::size_t>(context_.run.candidates.value_or(kLines)),
                   is_known ? &solids_.best() : nullptr, random, filter);
  drawn_for_ = taps().count;
  inferred_for_ = -1;
}

void SolidsBelief::infer() {
  const QuantitySet reads = plan_.reads(begun_);
  if (reads.empty() || (inferred_for_ == taps().count && values_.reads() == reads)) return;
  inferred_for_ = taps().count;
  const PhaseClock::Scope infer(context_.clock, Phase::infer);
  values_.compute(lines_, solids_, residual_gp_, reads,
                  context_.random("space/unseen", static_cast<std::uint64_t>(taps().count)));
  for (const auto& [name, values] : values_.arrays()) require_finite(values, name.c_str(), taps().count);
}

bool SolidsBelief::is_ready() const {
  return touches_.is_object_seen() || std::any_of(taps().readings.begin(), taps().readings.end(),
                                                  [](const TapReading& one) { return one.on_object; });
}

QuantitySet SolidsBelief::available() const {
  QuantitySet out;
  for (const auto& [name, values] : values_.arrays()) out.insert(name);
  return out;
}

const Eigen::VectorXd& SolidsBelief::values(std::string_view quantity) const {
  const auto found = values_.arrays().find(quantity);
  if (found == values_.arrays().end() || found->second.size() != lines_.lines.size())
    throw std::logic_error(std::string(quantity) + " is read, but no begun reader has it");
  return found->second;
}

std::optional<double> SolidsBelief::scalar(std::string_view quantity) const {
  return quantity == quantity::kObjectSeen ? std::optional(touches_.is_object_seen() ? 1.0 : 0.0) : std::nullopt;
}

BeliefState SolidsBelief::state(std::optional<Eigen::Index> candidate) const {
  BeliefState out;
  if (candidate) return out;
  FactorReport factors = residual_gp_.report();
  factors.jitter *= residual_gp_.deviation() * residual_gp_.deviation();
  factors.add(values_.factors());
  count_factors(out, factors);
  out.diagnostics["fit_failed"] = 0;
  out.diagnostics["variance_clamped"] = values_.variances_clamped();
  out.diagnostics["violated_free_paths"] = residual_gp_.free_paths().violated;
  return out;
}

std::optional<BeliefErrors> SolidsBelief::errors(ErrorsFor purpose) {
  const bool is_read = plan_.surface_from && begun_.count(*plan_.surface_from) != 0;
  if (purpose != ErrorsFor::display && !is_read) return BeliefErrors();
  return BeliefErrors{errors_.compare(is_ready() ? &solids_ : nullptr, residual_gp_)};
}

Surface SolidsBelief::surface(double resolution) {
  if (!is_ready()) return {};
  Crossings crossings = cross_surface(solids_.best(), residual_gp_, resolution);
  Cloud points;
  for (const Surface::Vertex& vertex : crossings.vertices) points.push_back(vertex.position);
  const Eigen::VectorXd deviations = surface_std(points, solids_, residual_gp_);
  require_finite(deviations, "the standard deviation of the surface", taps().count);
  for (std::size_t i = 0; i < points.size(); ++i)
    crossings.vertices[i].standard_deviation = deviations(static_cast<Eigen::Index>(i));
  return close_mesh(crossings, context_.scene.desk());
}

LineFacts SolidsBelief::explain(const TapLine& line) const {
  const Line own{line.start - Eigen::Vector3d(0.0, 0.0, context_.scene.desk()), line.direction};
  const double free = std::min(line.length, distance_down_to(0.0, own));
  LineFacts out;
  for (const Assembly& one : solids_.assemblies()) {
    const double hit = one.first_intersection(own);
    out.particles.push_back({std::max(0.0, std::min(free, hit)), hit < free, {}});
    for (const Assembly::Part& part : one.parts) out.particles.back().solids.push_back(facts_of(part.primitive));
    if (&one == &solids_.best()) std::swap(out.particles.front(), out.particles.back());
  }
  const LineFacts::Particle& best = out.particles.front();
  if (!best.on_object) return out;
  const Eigen::Vector3d at = own.origin + best.distance * own.direction;
  const Eigen::Vector3d normal = solids_.best().normal(at);
  out.surface_std = std::sqrt(residual_gp_.posterior({{at, normal}}).variance(0));
  out.prior_std = residual_gp_.signal();
  out.incidence_cosine = std::abs(normal.dot(line.direction));
  return out;
}

}  // namespace palpate
