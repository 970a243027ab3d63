// SPDX-License-Identifier: MIT
#include "calibrate/simulated_rerun.hpp"

#include "scene/scene_options.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr int kDraws = 24;
/// Ratio of standard deviation to median absolute deviation for a normal distribution.
constexpr double kOfNormal = 1.4826;

/// Returns the median, or 0 if there are no values.
double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Errors of all taps over all draws of the effects.
struct RerunErrors {
  /// errors of the heights, metres: one list per tap, with one error per draw in which the tap made a contact
  std::vector<std::vector<double>> errors;
  double failed = 0.0;  ///< number of taps without a contact over all draws, except unreachable taps
};

RerunErrors draw_taps(const RunEnvironment& environment, const Scene& scene, const PluginChoice& choice,
                      const std::vector<TapRequest>& requests) {
  RerunErrors out;
  out.errors.resize(requests.size());
  for (std::uint64_t draw = 1; draw <= kDraws; ++draw) {
    const Context context{environment.host, scene, draw, nullptr};
    const auto backend = context.create<Backend>(choice);
    for (std::size_t i = 0; i < requests.size(); ++i) {
      const TapResult contact = backend->tap(requests[i]);
      const Target place = requests[i].line.target();
      if (contact.outcome == Outcome::contact) {
        out.errors[i].push_back(contact.height() - scene.height(place.x, place.y));
      } else if (contact.outcome != Outcome::unreachable) {
        ++out.failed;
      }
    }
  }
  return out;
}

}  // namespace

std::vector<TapRequest> requests_of(const RecordedRun& recording) {
  std::vector<TapRequest> out;
  TapRequest request;
  for (const TapRecord& tap : recording.taps) {
    request.line = tap.request.line;
    request.predicted = tap.request.predicted;
    request.motion = tap.request.motion;
    out.push_back(request);
    ++request.number;
    request.previous = tap.request.line;
    request.elapsed += tap.result.seconds;
  }
  return out;
}

SimulatedRerun::SimulatedRerun(const RunEnvironment& environment, const RecordedRun& recording)
    : environment_(environment), recording_(recording), config_(recording.config.tree) {
  if (config_.find("motion") == nullptr)
    throw Error(recording.directory.string(),
                "its backend, " + recording.config.options.backend.type + ", has no motion to simulate",
                "use runs of a backend with a motion: baxter, process, simulator");
  config_.at("backend") = Tree::map({{"type", Tree::scalar("simulator")}});
  config_.erase("expect");
}

SimulatedRerun::Result SimulatedRerun::make(const Tree& effects, const std::vector<double>& expected) const {
  Tree config = config_;
  config.at("scene").at("effects") = effects;
  const ResolvedConfig resolved = resolve_experiment(config, environment_.host);
  const auto seed = static_cast<std::uint64_t>(resolved.options.seed);
  const std::unique_ptr<const Scene> scene = build_scene(resolved.options.scene, seed, environment_.host);
  const RerunErrors drawn = draw_taps(environment_, *scene, resolved.options.backend, requests_of(recording_));
  Result out;
  out.failed = drawn.failed / static_cast<double>(drawn.errors.size() * kDraws);
  double all = 0.0;
  double near = 0.0;
  for (std::size_t i = 0; i < drawn.errors.size(); ++i) {
    const double middle = median(drawn.errors[i]);
    out.error.push_back(middle);
    std::vector<double> deviations;
    for (const double error : drawn.errors[i]) deviations.push_back(std::abs(error - middle));
    const double deviation = kOfNormal * median(deviations);
    out.variance.push_back(deviation * deviation);
    for (const double error : drawn.errors[i]) {
      ++all;
      if (std::abs(error - (expected.empty() ? middle : expected[i])) > kOutlierError) continue;
      ++near;
      out.mean_error += error;
    }
  }
  out.mean_error /= std::max(1.0, near);
  out.far_off = (all - near) / std::max(1.0, all);
  return out;
}

}  // namespace palpate
