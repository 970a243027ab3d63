// SPDX-License-Identifier: MIT
#include "space/from_any_side.hpp"

#include "experiment/policy.hpp"
#include "space/view.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

// Lines from 150 directions, 6 mm apart: every patch of a surface as large as a finger is met by some.
constexpr int kDirections = 150;
constexpr double kPitch = 0.006;
constexpr double kSide = 0.001;  // of cubes of which each has one point of a surface
// Of cubes so large a wall of 3 mm holds those whose centres it holds, too many here and too few there.
constexpr double kCube = 0.004;

}  // namespace

FromAnySide::FromAnySide(const ExperimentOptions& options, const PluginFactory& factory,
                         const std::atomic<bool>* interrupted, std::shared_ptr<Backend> backend,
                         const std::string& directory)
    : Experiment(options, factory, interrupted, std::move(backend), directory),
      belief_(options_, context_, *backend_),
      acquisition_(context_.create<Acquisition>(options.acquisition)),
      bundle_(belief_.region().centre, belief_.region().outside(), kDirections, kPitch),
      cubes_(belief_.region().centre, belief_.region().outside(), kCube) {
  if (!acquisition_->any_side()) {
    throw Error("acquisition", fmt::format("{} only scores taps from above", options.acquisition.type),
                "choose one that scores approaches: discovery, uncertainty, random");
  }
  if (options_.space->view) look();
}

void FromAnySide::look() {
  if (!backend_->scene_is_truth()) {
    throw Error("space.view",
                fmt::format("uses the scene of the config, but backend {} taps another scene", options_.backend.type),
                "remove it, or choose backend=simulator");
  }
  constexpr std::size_t kMost = 160;  // rays that are kept: what a touch costs grows with them
  const std::vector<SurfaceTouch> view = side_view(*options_.space->view, *scene_, belief_.region().centre,
                                                   belief_.region().radius, context_.random("space/view"));
  object_seen_ = shows_object(view);
  belief_.look(thinned_view(view, kMost));
}

void FromAnySide::update() {
  if (updated_ == result_.taps) return;
  const PhaseClock::Scope infer(clock_, Phase::infer);
  belief_.update(acquisition_->reads_of_approaches());
  updated_ = result_.taps;
}

std::optional<std::string> FromAnySide::stop_rule(Source) { return std::nullopt; }

Eigen::VectorXd FromAnySide::scores() {
  update();
  if (!has_scores()) return Eigen::VectorXd::Zero(static_cast<Eigen::Index>(belief_.approaches().size()));
  Eigen::VectorXd out(static_cast<Eigen::Index>(belief_.approaches().size()));
  acquisition_->score_approaches(belief_, out);
  if (!out.allFinite()) {
    throw Error("acquisition/" + options_.acquisition.type, "returned a score that is not a finite number", {},
                Error::Kind::run);
  }
  return out;
}

std::optional<TapRecord> FromAnySide::choose_next(const Wish*) {
  update();
  const PhaseClock::Scope acquire(clock_, Phase::acquire);
  TapRecord tap;
  tap.number = result_.taps + 1;
  tap.source = starting() ? Source::initial : Source::acquisition;
  if (!starting() && !has_scores()) {
    if (!recalled_) return std::nullopt;
    tap = *recalled_;
    tap.number = result_.taps + 1;
    tap.candidate = belief_.find(approach_of(tap));
  } else if (!starting()) {
    const Pick picked =
        pick_best(scores(), Allowed::Constant(static_cast<Eigen::Index>(belief_.approaches().size()), true),
                  acquisition_->prior_scale(), options_.tie_tolerance);
    tap.candidate = picked.candidate;
    tap.score = picked.score;
    tap.ties = picked.ties;
    if (picked.runner_up >= 0) tap.runner_up_score = picked.runner_up_score;
  }
  tap.approach = belief_.approaches()[static_cast<std::size_t>(tap.candidate)];
  tap.target = {tap.approach->line.origin.x(), tap.approach->line.origin.y()};
  tap.unreached = belief_.unreached();
  if (backend_->scene_is_truth()) {
    const Line& line = tap.approach->line;
    const double end = std::min(distance_down_to(scene_->desk(), line), tap.approach->length);
    tap.true_on_object = scene_now().first_intersection(line) < end;
  }
  return tap;
}

void FromAnySide::read(TapRecord& tap) { tap.on_object = belief_.on_object(approach_of(tap), tap.contact); }

void FromAnySide::observe(const PastTap& tap) {
  belief_.observe(approach_of(tap), tap.contact);
  previous_ = tap.target;
  result_.count(tap);
  if (tap.contact.outcome != Outcome::contact) return;
  const SpaceBelief::Hits hits = belief_.hits();  // as all contacts are read now
  result_.object_taps = hits.count;
  result_.desk_taps = result_.taps - result_.failed_taps - result_.no_contact_taps - hits.count;
  result_.first_hit_tap = hits.first;
  result_.relabelled = belief_.relabelled();
}

void FromAnySide::resume(const std::vector<PastTap>& past) {
  for (std::size_t i = 0; i < past.size(); ++i) recall(result_.taps + static_cast<int>(i) + 1, past[i].unreached);
  update();
  for (const PastTap& tap : past) {
    observe(tap);
    update();
  }
}

const Scene& FromAnySide::scene_now() {
  if (scene_->effects().push && now_taps_ != result_.taps) {
    const bool stood = pushed_ == nullptr;
    pushed_ = scene_->after(result_.taps);
    now_taps_ = result_.taps;
    if (!stood || pushed_) truth_.reset();
  }
  return pushed_ ? *pushed_ : *scene_;
}

const FromAnySide::TrueSurface& FromAnySide::truth() {
  const Scene& scene = scene_now();
  if (truth_) return *truth_;
  truth_.emplace();
  if (!backend_->scene_is_truth()) return *truth_;
  Cloud& cloud = truth_->cloud;
  const Eigen::Vector3d desk(0.0, 0.0, scene_->desk());
  for (const Line& line : bundle_.lines) {
    const double hit = scene.first_intersection({line.origin + desk, line.direction});
    if (hit < distance_down_to(0.0, line)) cloud.push_back(line.origin + hit * line.direction);
  }
  cloud = thinned(cloud, kSide);
  truth_->cubes = cubes_.of(scene);
  return *truth_;
}

std::vector<Ring> FromAnySide::true_contours() {
  constexpr double kApart = 0.01;
  constexpr double kOfGrid = 0.002;  // walls of 3 mm are whole
  if (!backend_->scene_is_truth()) return {};
  return contours(scene_now(), belief_.region().centre, belief_.region().radius, kApart, kOfGrid);
}

Errors FromAnySide::errors() {
  if (truth().cloud.empty()) return {};
  update();
  // Before an object is known there is no surface, and all of the true one is missing.
  const Cloud surface = knows_object() ? belief_.surface(bundle_, kSide) : Cloud();
  const CloudErrors errors = compare_clouds(surface, truth().cloud);
  Errors out;
  out.rms_surface_distance = errors.rms;
  out.rmse_object = errors.rms_of_truth;
  out.surface_distance = errors.mean;
  out.f_score = errors.f_score;
  out.coverage = coverage(surface);
  const Cubes::Held& cubes = truth().cubes;
  if (std::find(cubes.begin(), cubes.end(), true) == cubes.end()) return out;  // thinner than a cube
  out.volume_iou =
      knows_object() ? intersection_over_union(cubes_.of(belief_.solids().best(), belief_.skin()), cubes) : 0.0;
  return out;
}

std::optional<double> FromAnySide::coverage(const Cloud& surface) {
  if (surface.empty()) return std::nullopt;
  constexpr double kOf95Percent = 1.96;
  constexpr double kApart = 0.006;
  const Cloud points = thinned(surface, kApart);
  const Eigen::VectorXd deviations = belief_.uncertainty(points);
  const std::vector<double> distances = nearest_distances(points, truth().cloud);
  const auto within =
      Eigen::Map<const Eigen::ArrayXd>(distances.data(), deviations.size()) <= kOf95Percent * deviations.array();
  return within.cast<double>().mean();
}

RunResult FromAnySide::result() {
  update();
  RunResult out = result_;
  const Skin& skin = belief_.skin();
  out.count(belief_.factors());
  out.diagnostics["variance_clamped"] = belief_.variances_clamped();
  out.diagnostics["violated_free_paths"] = skin.violated_free_paths();
  out.interrupted = out.stop_reason == kStoppedByUser;
  out.errors = errors();
  require_finite(out.errors, result_.taps);
  return out;
}

Preview FromAnySide::preview(const TapRecord& tap) const { return {std::nullopt, backend_->describe(request_of(tap))}; }

std::vector<ModelReader> FromAnySide::readers() const {
  return {{"particles", "surface: implicit"}, {"skin", "surface: implicit"}};
}

Crossings FromAnySide::crossings(double side) {
  update();
  if (!knows_object()) return {};
  Crossings out = cross_surface(belief_.solids().best(), belief_.skin(), side);
  Cloud points;
  for (const Crossings::Vertex& vertex : out.vertices) points.push_back(vertex.at);
  const Eigen::VectorXd deviations = belief_.uncertainty(points);
  for (std::size_t i = 0; i < points.size(); ++i) out.vertices[i].deviation = deviations(static_cast<Eigen::Index>(i));
  return out;
}

std::string FromAnySide::surface_ply() {
  return mesh_ply(close_mesh(crossings(kFineSide)), scene_->desk(), "standard_deviation",
                  "metres, in the frame of the area");
}

const Approach& approach_of(const PastTap& tap) {
  if (tap.approach) return *tap.approach;
  throw Error("", "a tap of a run from any side has no z and no direction", "its record is damaged", Error::Kind::run);
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
  throw Error(where, "is a run from any side, but this needs a run from above", "read its surface from surface.ply");
}

}  // namespace palpate
