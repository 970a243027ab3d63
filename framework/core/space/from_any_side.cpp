// SPDX-License-Identifier: MIT
#include "space/from_any_side.hpp"

#include "experiment/policy.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace palpate {
namespace {

// Lines from 150 directions, 6 mm apart: every patch of a surface as large as a finger is met by some. Points 3 mm
// apart tell how far two surfaces are from each other to 1 mm.
constexpr int kDirections = 150;
constexpr double kPitch = 0.006;
constexpr double kSide = 0.003;

}  // namespace

FromAnySide::FromAnySide(const ExperimentOptions& options, const PluginFactory& factory,
                         const std::atomic<bool>* interrupted, std::shared_ptr<Backend> backend,
                         const std::string& directory)
    : Experiment(options, factory, interrupted, std::move(backend), directory),
      belief_(options_, context_, *backend_),
      acquisition_(context_.create<Acquisition>(options.acquisition)),
      bundle_(belief_.region().centre, belief_.region().outside(), kDirections, kPitch) {
  if (!acquisition_->any_side()) {
    throw Error("acquisition", fmt::format("{} scores taps from above alone", options.acquisition.type),
                "choose one that scores approaches: contrast, uncertainty, random");
  }
  result_.interventions = {{"fallback", 0}, {"fit_failed", 0}, {"height_refused", 0},  {"jitter", 0},
                           {"pivoted", 0},  {"set_aside", 0},  {"variance_clamped", 0}};
}

void FromAnySide::update() {
  if (updated_ == result_.taps) return;
  const PhaseClock::Scope infer(clock_, Phase::infer);
  belief_.update(acquisition_->reads_of_approaches());
  updated_ = result_.taps;
}

std::optional<std::string> FromAnySide::stop_rule(Source) { return std::nullopt; }

std::optional<TapRecord> FromAnySide::choose_next(const Wish*) {
  update();
  const PhaseClock::Scope acquire(clock_, Phase::acquire);
  TapRecord tap;
  tap.number = result_.taps + 1;
  tap.source = starting() ? Source::initial : Source::acquisition;
  if (!starting()) {
    Eigen::VectorXd scores(static_cast<Eigen::Index>(belief_.approaches().size()));
    acquisition_->score_approaches(belief_, scores);
    if (!all_finite(scores)) {
      throw Error("acquisition/" + options_.acquisition.type, "gave a score that is not a finite number", {},
                  Error::Kind::run);
    }
    const Pick picked = pick_best(scores, std::vector<bool>(belief_.approaches().size(), true),
                                  acquisition_->prior_scale(), options_.tie_tolerance);
    tap.candidate = picked.candidate;
    tap.score = picked.score;
    tap.ties = picked.ties;
    if (picked.runner_up >= 0) tap.runner_up_score = picked.runner_up_score;
  }
  tap.approach = belief_.approaches()[static_cast<std::size_t>(tap.candidate)];
  tap.target = {tap.approach->line.origin.x(), tap.approach->line.origin.y()};
  if (backend_->scene_is_truth()) {
    const Line& line = tap.approach->line;
    const double desk = belief_.desk_along({line.origin - Eigen::Vector3d(0, 0, scene_->desk()), line.direction});
    tap.true_on_surface = scene_->first_hit(line) < std::min(desk, tap.approach->length);
  }
  return tap;
}

void FromAnySide::read(TapRecord& tap) { tap.on_surface = tap.contact.height > scene_->desk() + 0.0015; }

void FromAnySide::observe(const PastTap& tap) {
  belief_.observe(tap.approach.value(), tap.contact);
  previous_ = tap.target;
  ++result_.taps;
  result_.robot_seconds += tap.contact.seconds;
  if (tap.contact.outcome != Outcome::contact) {
    ++result_.failed_taps;
    return;
  }
  const bool on = belief_.touches().back().contact && !belief_.touches().back().desk;
  ++(on ? result_.on_surface_taps : result_.off_surface_taps);
  if (on && !result_.first_hit_tap) result_.first_hit_tap = result_.taps;
}

void FromAnySide::resume(const std::vector<PastTap>& past) {
  for (const PastTap& tap : past) {
    observe(tap);
    update();
  }
}

const Cloud& FromAnySide::truth() {
  if (truth_) return *truth_;
  truth_.emplace();
  if (!backend_->scene_is_truth()) return *truth_;
  const Eigen::Vector3d desk(0.0, 0.0, scene_->desk());
  for (const Line& line : bundle_.lines) {
    const double hit = scene_->first_hit({line.origin + desk, line.direction});
    if (hit < belief_.desk_along(line)) truth_->push_back(line.origin + hit * line.direction);
  }
  return *truth_ = thinned(*truth_, kSide);
}

Errors FromAnySide::errors() {
  if (truth().empty()) return {};
  update();
  Cloud believed;
  for (const SpaceBelief::SurfacePoint& point : belief_.surface(bundle_, kSide)) believed.push_back(point.at);
  const CloudErrors errors = compare_clouds(believed, truth());
  Errors out;
  out.rmse = errors.rms;
  out.rmse_on_surface = errors.rms_of_truth;
  out.nearest = errors.mean;
  out.f_score = errors.f_score;
  return out;
}

RunResult FromAnySide::result() {
  RunResult out = result_;
  out.interrupted = out.stop_reason == kStoppedByUser;
  out.errors = errors();
  return out;
}

Preview FromAnySide::preview(const TapRecord& tap) const { return {std::nullopt, backend_->describe(request_of(tap))}; }

std::vector<ModelReader> FromAnySide::readers() const {
  return {{"compositions", "surface: implicit"}, {"skin", "surface: implicit"}};
}

std::string FromAnySide::surface_ply() {
  update();
  const std::vector<SpaceBelief::SurfacePoint> points = belief_.surface(bundle_, kSide);
  std::string out = fmt::format(
      "ply\nformat ascii 1.0\ncomment metres, in the frame of the area\nelement vertex {}\nproperty float x\nproperty "
      "float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float "
      "standard_deviation\nend_header\n",
      points.size());
  for (const SpaceBelief::SurfacePoint& point : points) {
    fmt::format_to(std::back_inserter(out), "{:.6f} {:.6f} {:.6f} {:.4f} {:.4f} {:.4f} {:.6f}\n", point.at.x(),
                   point.at.y(), point.at.z() + scene_->desk(), point.normal.x(), point.normal.y(), point.normal.z(),
                   point.deviation);
  }
  return out;
}

std::unique_ptr<Experiment> make_experiment(const ExperimentOptions& options, const PluginFactory& factory,
                                            const std::atomic<bool>* interrupted, std::shared_ptr<Backend> backend,
                                            const std::string& directory) {
  if (options.scene.touch == SceneOptions::Touch::any)
    return std::make_unique<FromAnySide>(options, factory, interrupted, std::move(backend), directory);
  return std::make_unique<FromAbove>(options, factory, interrupted, std::move(backend), directory);
}

FromAbove& from_above_of(Experiment& experiment, const std::string& where) {
  if (auto* const above = dynamic_cast<FromAbove*>(&experiment)) return *above;
  throw Error(where, "is a run from any side, this is of runs from above", "its surface is in surface.ply");
}

}  // namespace palpate
