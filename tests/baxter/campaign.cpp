// SPDX-License-Identifier: MIT
#include "baxter/campaign.hpp"

#include "baxter/body_bench.hpp"
#include "config/compose.hpp"
#include "record/resolved_config.hpp"

#include <palpate/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace palpate::baxter::test {
namespace {

using palpate::test::shared_host;

constexpr double kSpikes = 0.01;     // fraction of the readings
constexpr double kStalls = 0.03;     // fraction of the periods
constexpr double kSpike = 9.0;       // N
constexpr double kStall = 0.05;      // s
constexpr double kTouched = 0.5;     // N of true force from which a tap counts as a touch
constexpr double kEven = 0.012;      // m around a position; sagging springs displace the tip by up to 5 mm
constexpr double kAfterwards = 3.0;  // s after which an arm without commands is at rest

/// Returns the kind of a reason: the reason without digits.
std::string kind_of(const std::string& reason) {
  std::string out = reason.substr(0, reason.find(';'));
  out.erase(std::remove_if(out.begin(), out.end(), [](char c) { return c >= '0' && c <= '9'; }), out.end());
  return out;
}

/// One run, until a tap ends it.
class Session {
 public:
  Session(const Condition& condition, const Scene& scene, std::uint64_t seed)
      : scene_(scene),
        random_(seed, "campaign"),
        predicts_(!condition.motion.empty()),
        robot_(scene, body_of(condition, seed)),
        tapper_(options_of(condition), scene, robot_, nullptr, [](const std::string&) {}) {
    for (const fake_baxter::Fault& fault : condition.faults) robot_.body.inject(fault);
    if (condition.spikes) {
      robot_.spoil = [this](Snapshot& seen) { spike(*seen.endpoint); };
    }
    if (condition.stalls) {
      robot_.late = [this] { return random_.uniform() < kStalls ? kStall * random_.uniform() : 0.0; };
    }
    robot_.every_period = [this] {
      peak_ = std::max(peak_, robot_.body.arm().peak);
      if (robot_.body.pressing() > 0.0) {
        if (!touched_at_) touched_at_ = robot_.body.now();
        pressed_until_ = robot_.body.now();
      }
    };
  }

  /// Makes a tap. Returns whether the run continues.
  bool tap(Tally& tally) {
    TapRequest request;
    request.number = ++taps_;
    request.line = line_from_above(draw_place());
    request.previous = previous_;
    previous_ = request.line;
    if (predicts_)
      request.predicted = Prediction{scene_.height(request.line.target().x, request.line.target().y), 0.005, {}};
    peak_ = 0.0;
    touched_at_.reset();
    const tapping::HeightResult contact = tapper_.tap(request);
    ++tally.taps;
    const bool touched = peak_ > kTouched;
    tally.touched += touched ? 1 : 0;
    tally.peak = std::max(tally.peak, peak_);
    tally.too_strong += peak_ > Tally::kMostForce ? 1 : 0;
    tally.seconds += contact.seconds;
    if (touched_at_) tally.found = std::max(tally.found, pressed_until_ - *touched_at_);
    if (contact.outcome == Outcome::contact) {
      ++tally.contacts;
      const double error = std::abs(contact.height - scene_.height(request.line.target().x, request.line.target().y));
      tally.error = std::max(tally.error, error);
      tally.phantoms += !touched || error >= Tally::kFar ? 1 : 0;
      return true;
    }
    tally.rejected += touched ? 1 : 0;
    ++tally.reasons[kind_of(contact.reason)];
    if (!contact.ends_run) return true;
    ++tally.ended;
    robot_.late = nullptr;
    robot_.wait_until(robot_.body.now() + kAfterwards);
    tally.pressing += robot_.body.pressing() > 0.0 ? 1 : 0;
    return false;
  }

 private:
  static BodyOptions body_of(const Condition& condition, std::uint64_t seed) {
    BodyOptions out = body_options(shipped_options());
    out.seed = seed;
    out.mechanics = condition.arm;
    return out;
  }

  static BaxterOptions options_of(const Condition& condition) {
    BaxterOptions out = shipped_options();
    if (!condition.motion.empty()) out.motion = palpate::test::filled<tapping::BackendMotion>(condition.motion);
    return out;
  }

  void spike(EndpointReading& reading) {
    if (reading.received == spiked_at_) return;  // once per message
    spiked_at_ = reading.received;
    if (random_.uniform() < kSpikes) reading.force.z() += random_.uniform() < 0.5 ? kSpike : -kSpike;
  }

  Target draw_place() {
    for (;;) {
      const Target out{0.01 + 0.21 * random_.uniform(), 0.01 + 0.21 * random_.uniform()};
      if (is_even(scene_, out, kEven)) return out;
    }
  }

  const Scene& scene_;
  Random random_;
  bool predicts_;
  BodyRobot robot_;
  Tapper tapper_;
  int taps_ = 0;
  double peak_ = 0.0;  ///< N, in this tap
  double spiked_at_ = -1.0;
  std::optional<double> touched_at_;  ///< s, in this tap
  double pressed_until_ = 0.0;        ///< s
  std::optional<TapLine> previous_;
};

}  // namespace

const BaxterOptions& shipped_options() {
  static const BaxterOptions options = [] {
    const std::filesystem::path configs = palpate::test::source_folder() / "configs";
    const Tree composed = Composer(configs, config_keys())
                              .compose(configs / "paper" / "object_i.yaml", {parse_override("backend=fake_baxter")});
    const ResolvedConfig config = resolve_experiment(composed, shared_host());
    BaxterOptions out;
    fill(*config.options.backend.options, shared_host(), "backend", [&](Fields& fields) { out.list(fields); });
    return out;
  }();
  return options;
}

void Tally::add(const Tally& other) {
  taps += other.taps;
  contacts += other.contacts;
  touched += other.touched;
  phantoms += other.phantoms;
  rejected += other.rejected;
  ended += other.ended;
  pressing += other.pressing;
  peak = std::max(peak, other.peak);
  error = std::max(error, other.error);
  seconds += other.seconds;
  found = std::max(found, other.found);
  too_strong += other.too_strong;
  for (const auto& [reason, count] : other.reasons) reasons[reason] += count;
}

Tally campaign(const Condition& condition, int taps, std::uint64_t seed) {
  const std::unique_ptr<const Scene> scene = palpate::test::scene_of(
      palpate::test::kObjectI, fmt::format("{{stiffness: {{object: {} N/m}}}}", condition.stiffness));
  Tally out;
  std::unique_ptr<Session> session;
  while (out.taps < taps) {
    if (!session) session = std::make_unique<Session>(condition, *scene, 1000 * seed + static_cast<unsigned>(out.taps));
    if (!session->tap(out)) session.reset();
  }
  return out;
}

std::string in_words(const Tally& tally) {
  return fmt::format(
      "{} taps, {} contacts, {} touched: {} phantom, {} rejected, {} ended the run, {} left pressing; at most {:.1f} "
      "N ({} above {:.0f} N), {:.1f} mm; pressed {:.1f} s at most; {:.1f} s a tap",
      tally.taps, tally.contacts, tally.touched, tally.phantoms, tally.rejected, tally.ended, tally.pressing,
      tally.peak, tally.too_strong, Tally::kMostForce, 1e3 * tally.error, tally.found,
      tally.seconds / std::max(1, tally.taps));
}

}  // namespace palpate::baxter::test
