// SPDX-License-Identifier: MIT
#include "experiment/run_monitor.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Returns whether a line ends on an object of the scene.
bool ends_on_object(const Scene& scene, const TapLine& line) {
  if (line.from_above) {
    const Target target = line.target();
    return scene.on_object(scene.height(target.x, target.y));
  }
  const double end = std::min(distance_down_to(scene.desk(), line.line()), line.length);
  return scene.first_intersection(line.line()) < end;
}

}  // namespace

RunMonitor::RunMonitor(const Scene& scene, bool is_truth) : scene_(scene), is_truth_(is_truth) {}

const Scene* RunMonitor::truth(Belief& belief) {
  if (!is_truth_) return nullptr;
  if (truth_taps_ < 0 || (scene_.effects().push && truth_taps_ != result_.taps)) {
    const bool stood = truth_taps_ >= 0 && pushed_ == nullptr;
    pushed_ = scene_.effects().push ? scene_.after(result_.taps) : nullptr;
    truth_taps_ = result_.taps;
    if (!stood || pushed_ != nullptr) belief.set_truth(pushed_ ? pushed_.get() : &scene_);
  }
  return pushed_ ? pushed_.get() : &scene_;
}

void RunMonitor::take_in(const TapRecord& tap, Belief& belief) {
  // Uses the scene before this tap, because a push moves the objects only after its tap.
  if (const Scene* const scene = truth(belief); scene != nullptr && tap.is_contact()) note_object(tap, *scene);
  first_labels_.push_back(tap.reading && tap.reading->on_object);
  ++result_.taps;
  result_.robot_seconds += tap.result.seconds;
  if (tap.request.source == Source::fallback) ++result_.state.diagnostics["fallback"];
  if (is_refused(tap.result)) ++result_.state.diagnostics["heights_rejected"];
  if (!tap.is_contact()) {
    ++(tap.is_free_line() ? result_.no_contact_taps : result_.failed_taps);
    return;
  }
  result_.object_taps = result_.desk_taps = 0;
  result_.first_hit_tap.reset();
  result_.relabelled.clear();
  for (const TapReading& one : belief.taps().readings) {
    if (!one.is_contact) continue;
    ++(one.on_object ? result_.object_taps : result_.desk_taps);
    if (one.on_object && !result_.first_hit_tap) result_.first_hit_tap = one.tap;
    if (one.on_object != first_labels_[static_cast<std::size_t>(one.tap - 1)])
      result_.relabelled.push_back({one.tap, one.on_object});
  }
}

void RunMonitor::note_object(const TapRecord& tap, const Scene& scene) {
  if (!tap.request.line.from_above) return;
  touches_.resize(static_cast<std::size_t>(scene.objects()));
  const Target target = tap.target();
  const int object =
      scene.on_object(scene.height(target.x, target.y)) ? scene.object(target.x, target.y) : Scene::kNoObject;
  if (object == Scene::kNoObject) return;
  ObjectTouches& touches = touches_[static_cast<std::size_t>(object)];
  ++touches.taps;
  if (!touches.first_tap) touches.first_tap = result_.taps + 1;
}

void RunMonitor::describe(TapRecord& tap, Belief& belief) {
  const Scene* const scene = truth(belief);
  tap.state = belief.state(tap.candidate);
  if (scene == nullptr) return;
  tap.true_on_object = ends_on_object(*scene, tap.request.line);
  tap.errors = belief.errors(ErrorsFor::tap).value_or(BeliefErrors()).errors;
}

RunResult RunMonitor::result(Belief& belief) {
  RunResult out = result_;
  out.interrupted = out.stop_reason == kStoppedByUser;
  out.from_above = belief.candidates().from_above;
  const Scene* const scene = truth(belief);
  if (scene != nullptr) {
    const BeliefErrors all = belief.errors(ErrorsFor::summary).value_or(BeliefErrors());
    out.errors = all.errors;
    require_finite(out.errors, out.taps);
    touches_.resize(static_cast<std::size_t>(scene->objects()));
    if (out.from_above) out.objects.emplace();
    for (std::size_t i = 0; out.objects && i < all.objects.size(); ++i)
      out.objects->push_back({all.objects[i], touches_[i]});
  }
  BeliefState state = belief.state(std::nullopt);
  for (const auto& [kind, count] : result_.state.diagnostics) state.diagnostics[kind] += count;
  out.state = std::move(state);
  return out;
}

void require_finite(const Errors& errors, int taps) {
  for (const auto member : kErrors) {
    if (std::isfinite((errors.*member).value_or(0.0))) continue;
    throw Error("maps", fmt::format("their errors are not finite numbers after tap {}", taps),
                "check for heights that no arm can report, or choose a larger belief.height.noise", Error::Kind::run);
  }
}

}  // namespace palpate
