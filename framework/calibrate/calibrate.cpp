// SPDX-License-Identifier: MIT
#include "calibrate/calibrate.hpp"

#include "calibrate/contact_fit.hpp"
#include "calibrate/simulated_rerun.hpp"
#include "config/yaml.hpp"
#include "scene/scene_options.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr std::size_t kFewest = 10;  // least number of contacts
constexpr double kMillimetre = 1e-3;
constexpr double kMillimetrePerMinute = 1e-3 / 60.0;
/// Largest height of a false contact above the highest object, metres.
constexpr double kAbove = 0.1;
/// At most one in kFar contacts of a run may be far from the scene. A larger share means that the real scene differs
/// from its config, because false contacts are less frequent.
constexpr std::size_t kFar = 5;
/// At most one in kThrough contacts of a run may be below the surface. False contacts occur above the surface, so they
/// cannot explain more.
constexpr std::size_t kThrough = 20;
/// Largest offset of the measured heights that the assumed effects do not explain, metres. A larger offset means that
/// the desk's height differs from the config. A perfect arm with the motion `paper` has an offset of 14 mm.
constexpr double kMostOffset = 0.03;
/// Smallest share of an effect's events (such as missed contacts) that the results of the taps must reveal. If the
/// recorded motions reveal a smaller share, the rate of the effect cannot be estimated.
constexpr double kShown = 0.1;

/// Effects that cannot be estimated from recorded taps, with default values for an arm similar to Baxter's.
constexpr std::pair<const char*, const char*> kAssumed[] = {{"force_noise", "{deviation: 1.5 N}"},
                                                            {"force_drift", "{per_metre: 10 N/m}"},
                                                            {"stiffness", "{object: 1500 N/m}"},
                                                            {"joint_lag", "{delay: 350 ms}"},
                                                            {"latency", "{deviation: 15 ms}"}};

Tree assumed() {
  Tree out = Tree::map();
  for (const auto& [effect, value] : kAssumed) out.at(effect) = parse_yaml(value, "calibrate");
  return out;
}

Tree with_rate(const char* effect) {
  Tree out = assumed();
  out.at(effect) = Tree::map({{"probability", Tree::scalar("1")}});
  return out;
}

std::string words(const IntervalEstimate& one, double unit, const char* name) {
  return fmt::format("{:.3g} [{:.3g}, {:.3g}] {}", one.value / unit, one.low / unit, one.high / unit, name);
}

/// A recorded run, its simulated rerun, and the result of the rerun.
struct CalibrationRun {
  const RecordedRun& recording;
  std::unique_ptr<const Scene> scene;
  SimulatedRerun rerun;
  SimulatedRerun::Result made;  ///< result with the assumed effects
  std::size_t contacts = 0;

  CalibrationRun(const RunEnvironment& environment, const RecordedRun& from)
      : recording(from),
        scene(build_scene(from.config.options.scene, static_cast<std::uint64_t>(from.config.options.seed),
                          environment.host)),
        rerun(environment, from),
        made(rerun.make(assumed())) {}
};

/// Counts over all taps of all runs.
struct TapCounts {
  double taps = 0.0, failed = 0.0, contacts = 0.0;
  double on_desk = 0.0;
};

class EffectsCalibration {
 public:
  EffectsCalibration(const RunEnvironment& environment, const std::vector<RecordedRun>& recordings) {
    for (const RecordedRun& recording : recordings) {
      runs_.emplace_back(environment, recording);
      add(runs_.back());
    }
    if (contacts_.size() < kFewest)
      throw Error(recordings.front().directory.string(),
                  fmt::format("{} of {} taps are contacts, but {} are needed", contacts_.size(), sums_.taps, kFewest),
                  "make more taps on a scene that stands as in its config: a bare desk, a block");
    double highest = 0.0;
    for (const CalibrationRun& pair : runs_) highest = std::max(highest, pair.scene->highest() - pair.scene->desk());
    fit_ = fit_contacts(contacts_, highest + kAbove);
    check_scenes();
  }

  std::string file() {
    Tree effects = assumed();
    std::string lines;
    const auto line = [&](const char* effect, const std::string& value, const std::string& what) {
      lines += fmt::format("  {}: {}  # {}\n", effect, value, what);
      effects.at(effect) = parse_yaml(value, "calibrate");
    };
    // The effect's parameter `constant` is the offset at the first tap.
    const double drift = fit_.drift ? fit_.drift->value : 0.0;
    line("height_offset",
         fmt::format("{{constant: {:.4g} mm, drift: {:.4g} mm/min}}",
                     (fit_.offset.value - drift * fit_.mean_elapsed) / kMillimetre, drift / kMillimetrePerMinute),
         fmt::format("offset halfway through the taps, on top of the assumed effects below, {}; {}",
                     words(fit_.offset, kMillimetre, "mm"),
                     fit_.drift ? "drift " + words(*fit_.drift, kMillimetrePerMinute, "mm/min")
                                : std::string("the drift cannot be estimated")));
    const auto less = [&](double noise) { return std::sqrt(std::max(0.0, noise * noise - simulated_variance_)); };
    const IntervalEstimate vertical{less(fit_.noise.value), less(fit_.noise.low), less(fit_.noise.high)};
    line("pose_noise",
         fmt::format("{{lateral: {:.3g} mm, vertical: {:.3g} mm}}",
                     (fit_.lateral ? fit_.lateral->value : 0.002) / kMillimetre, vertical.value / kMillimetre),
         fmt::format("lateral {}; vertical {}",
                     fit_.lateral ? words(*fit_.lateral, kMillimetre, "mm")
                                  : std::string("is assumed, because no tap was beside a step"),
                     words(vertical, kMillimetre, "mm")));
    const IntervalEstimate failed = share_of(sums_.failed, sums_.taps);
    rate(line, "missed_contacts", failed, fmt::format("{:g} of {:g} taps made no contact", sums_.failed, sums_.taps),
         [](const SimulatedRerun::Result& made) { return made.failed; });
    rate(line, "false_contacts", fit_.false_share,
         fmt::format("{:.1f} of {:g} contacts are estimated to be far from the scene",
                     fit_.false_share.value * static_cast<double>(contacts_.size()), sums_.contacts),
         [](const SimulatedRerun::Result& made) { return made.far_off; });
    for (const auto& [effect, value] : kAssumed) line(effect, value, "assumed");
    return head(effects) + "effects:\n" + lines;
  }

 private:
  /// Throws Error for a run whose scene differs from its config.
  void check_scenes() const {
    constexpr const char* kRemedy = "use taps on a scene that stands as in its config";
    std::size_t next = 0;
    for (const CalibrationRun& pair : runs_) {
      std::size_t far = 0;
      std::size_t through = 0;
      for (std::size_t i = 0; i < pair.contacts; ++i, ++next) {
        const KnownContact& one = contacts_[next];
        const double beyond = beyond_surface(one, offset_at(one.elapsed));
        far += std::abs(beyond) > SimulatedRerun::kOutlierError ? 1 : 0;
        through += beyond < -SimulatedRerun::kOutlierError ? 1 : 0;
      }
      const auto refuse = [&](std::size_t count, const char* what, std::size_t one_in) {
        throw Error(
            pair.recording.directory.string(),
            fmt::format("{} of {} contacts are {}, but only one in {} may be", count, pair.contacts, what, one_in),
            kRemedy);
      };
      if (far * kFar > pair.contacts) refuse(far, "far from its scene", kFar);
      if (through > 1 && through * kThrough > pair.contacts) refuse(through, "within an object of its scene", kThrough);
    }
    if (std::abs(fit_.offset.value) <= kMostOffset) return;
    throw Error(
        runs_.front().recording.directory.string(),
        fmt::format("the heights are off by {:.1f} mm beyond the assumed effects, but an arm errs by at most {:g} mm",
                    fit_.offset.value / kMillimetre, kMostOffset / kMillimetre),
        std::string("check the height of the desk in config and robot, ") + kRemedy);
  }

  void add(CalibrationRun& pair) {
    const SimulatedRerun::Result& made = pair.made;
    const std::vector<TapRequest> requests = requests_of(pair.recording);
    double variance = 0.0;
    for (std::size_t i = 0; i < requests.size(); ++i) {
      const TapResult& contact = pair.recording.taps[i].result;
      if (contact.outcome == Outcome::unreachable) continue;
      ++sums_.taps;
      variance += made.variance[i];
      if (contact.outcome != Outcome::contact) {
        ++sums_.failed;
        continue;
      }
      ++sums_.contacts;
      const Target place = requests[i].line.target();
      const double there = pair.scene->height(place.x, place.y);
      sums_.on_desk += pair.scene->on_object(there) ? 0.0 : 1.0;
      ++pair.contacts;
      contacts_.push_back({pair.scene.get(), place, requests[i].elapsed, contact.height() - made.error[i]});
    }
    simulated_variance_ +=
        (variance / static_cast<double>(requests.size()) - simulated_variance_) / static_cast<double>(runs_.size());
  }

  /// Adds a line with the rate at which the simulated taps show the same share of events as the recorded taps (`seen`).
  /// The simulated share is linear in the rate, so simulations with the rates 0 and 1 determine the rate.
  template <class Line, class ShownShare>
  void rate(const Line& line, const char* effect, const IntervalEstimate& seen, const std::string& what,
            const ShownShare& shown) {
    double none = 0.0;
    double all = 0.0;
    for (const CalibrationRun& pair : runs_) {
      none += shown(pair.made) / static_cast<double>(runs_.size());
      all += shown(pair.rerun.make(with_rate(effect), pair.made.error)) / static_cast<double>(runs_.size());
    }
    if (all - none < kShown)
      return line(effect, "{probability: 0.02}",
                  what + "; the rate is assumed, because these motions hardly reveal it");
    const auto rate_of = [&](double share) { return std::clamp((share - none) / (all - none), 0.0, 1.0); };
    const IntervalEstimate out{rate_of(seen.value), rate_of(seen.low), rate_of(seen.high)};
    line(effect, fmt::format("{{probability: {:.3g}}}", out.value),
         fmt::format("{}; {}, of which these motions reveal {:.0f} %", what, words(out, 1.0, "per tap"),
                     100.0 * (all - none)));
  }

  /// Returns the expected error of a height in addition to the error of the assumed effects, metres. `elapsed`: arm
  /// time, seconds.
  double offset_at(double elapsed) const {
    return fit_.offset.value + (fit_.drift ? fit_.drift->value * (elapsed - fit_.mean_elapsed) : 0.0);
  }

  std::string head(const Tree& effects) {
    double error = 0.0;
    double near = 0.0;
    double rerun_error = 0.0;
    std::string runs;
    for (const CalibrationRun& pair : runs_) {
      std::vector<double> expected;
      for (const TapRequest& request : requests_of(pair.recording)) {
        expected.push_back(pair.made.error[expected.size()] + offset_at(request.elapsed));
        const TapResult& contact = pair.recording.taps[expected.size() - 1].result;
        const Target target = request.line.target();
        const double off = contact.height() - pair.scene->height(target.x, target.y);
        if (contact.outcome != Outcome::contact || std::abs(off - expected.back()) > SimulatedRerun::kOutlierError)
          continue;
        error += off;
        ++near;
      }
      rerun_error += pair.rerun.make(effects, expected).mean_error / static_cast<double>(runs_.size());
      runs +=
          fmt::format("#   {} ({})\n", pair.recording.directory.string(), pair.recording.config.options.backend.type);
    }
    return fmt::format(
        "# Effects of an arm, by {:g} taps of\n{}# {:g} contacts with the desk, {:g} with an object. Values have 95 % "
        "intervals; assumed values cannot be estimated\n# from these taps. Heights are off by {:.2f} mm on average, in "
        "the simulator with these effects by {:.2f} mm.\n",
        sums_.taps, runs, sums_.on_desk, sums_.contacts - sums_.on_desk, error / std::max(1.0, near) / kMillimetre,
        rerun_error / kMillimetre);
  }

  std::vector<CalibrationRun> runs_;
  std::vector<KnownContact> contacts_;
  TapCounts sums_;
  ContactFit fit_;
  double simulated_variance_ = 0.0;  ///< variance of a tap's error due to the assumed effects
};

}  // namespace

std::string calibrate(const RunEnvironment& environment, const std::vector<RecordedRun>& recordings) {
  return EffectsCalibration(environment, recordings).file();
}

}  // namespace palpate
