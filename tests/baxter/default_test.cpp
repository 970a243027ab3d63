// SPDX-License-Identifier: MIT
// The shipped default on a simulated arm with masses and springs, compared with the simulator with the same noise, and
// with the simulator after `calibrate`. PALPATE_CAMPAIGN=TAPS runs 15 seeds instead of two.
#include "baxter/body_bench.hpp"
#include "baxter/campaign.hpp"
#include "calibrate/calibrate.hpp"
#include "config/yaml.hpp"
#include "record/fields.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"

#include <palpate/random.hpp>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <numeric>

namespace palpate::baxter {
namespace {

using test::BodyRobot;

constexpr double kLateral = 0.002;   // m
constexpr double kVertical = 0.001;  // m
const std::string kMotion =
    "motion={type: continuous, speed: 1.5 cm/s, threshold: 5 N, hover: 13.5 cm, travel_speed: 15 cm/s, "
    "retreat_speed: 10 cm/s, tare: 500 ms, overrun: 2 cm}";
const std::string kEffects =
    "{force_noise: {deviation: 1.5 N}, stiffness: {object: 1500 N/m}, joint_lag: {delay: 350 ms}";
const std::string kPose = ", pose_noise: {lateral: 2 mm, vertical: 1 mm}}";

bool at_length() { return std::getenv("PALPATE_CAMPAIGN") != nullptr; }
int seeds() { return at_length() ? 15 : 2; }

/// The driver with its shipped settings on an arm of rigid bodies and springs, with an error of the tip's position.
class ArmBackend final : public Backend {
 public:
  ArmBackend(std::unique_ptr<const Scene> scene, std::uint64_t seed) : scene_(std::move(scene)), seed_(seed) {
    begin();
  }

  TapResult tap(const TapRequest& request) override {
    Random random(seed_, "default test", static_cast<std::uint64_t>(request.number));
    const auto normal = [&] {
      return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(6.283185307179586 * random.uniform());
    };
    const Area area = scene_->area();
    TapRequest off = request;
    const Target target = request.line.target();
    const double x = std::clamp(target.x + kLateral * normal(), 0.0, area.width);
    off.line = line_from_above({x, std::clamp(target.y + kLateral * normal(), 0.0, area.depth)});
    tapping::HeightResult contact = tapper_->tap(off);
    if (contact.ends_run) {  // a person has checked the robot and continues
      contact.ends_run = false;
      begin();
    }
    if (contact.outcome == Outcome::contact) contact.height += kVertical * normal();
    return tapping::result_on(request.line, contact);
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return true; }

 private:
  void begin() {
    tapper_.reset();
    robot_ = std::make_unique<BodyRobot>(*scene_, body(seed_));
    tapper_ = std::make_unique<Tapper>(test::shipped_options(), *scene_, *robot_, nullptr, [](const std::string&) {});
  }

  static fake_baxter::BodyOptions body(std::uint64_t seed) {
    fake_baxter::BodyOptions out = test::body_options(test::shipped_options());
    out.seed = seed;
    out.mechanics.type = fake_baxter::MechanicsOptions::Type::springs;
    out.mechanics.friction = 0.2;
    return out;
  }

  std::unique_ptr<const Scene> scene_;
  std::uint64_t seed_;
  std::unique_ptr<BodyRobot> robot_;
  std::unique_ptr<Tapper> tapper_;
};

std::vector<std::string> words(int seed, int taps, const std::vector<std::string>& more = {}) {
  std::vector<std::string> out{"motion=continuous", kMotion, "scene.placement=random", fmt::format("seed={}", seed),
                               fmt::format("taps={}", taps)};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

palpate::test::Finished on_the_arm(const std::vector<std::string>& words) {
  const ResolvedConfig config = palpate::test::shipped_config("default.yaml", words);
  const auto seed = static_cast<std::uint64_t>(config.options.seed);
  auto scene = build_scene(config.options.scene, seed, palpate::test::shared_host());
  return palpate::test::Finished("default.yaml", words, std::make_shared<ArmBackend>(std::move(scene), seed));
}

TEST(DefaultOnTheArm, EndsAsNearToTheHeightsAsInTheSimulatorWithTheSameNoise) {
  if (palpate::test::kSanitized) GTEST_SKIP() << "many descents, too slow under sanitizers: release makes them";
  const int taps = at_length() ? 40 : 20;
  double on_arm = 0.0;
  double simulated = 0.0;
  for (int seed = 1; seed <= seeds(); ++seed) {
    auto arm = on_the_arm(words(seed, taps, {"scene.effects=" + kEffects + "}"}));
    palpate::test::Finished simulator("default.yaml", words(seed, taps, {"scene.effects=" + kEffects + kPose}));
    const double one = *arm.experiment.result().errors.rmse_height;
    const double other = *simulator.experiment.result().errors.rmse_height;
    fmt::print("seed {}: {:.2f} mm on the arm, {:.2f} mm in the simulator\n", seed, 1e3 * one, 1e3 * other);
    on_arm += one / seeds();
    simulated += other / seeds();
  }
  fmt::print("mean of {} seeds, {} taps: {:.2f} mm on the arm, {:.2f} mm in the simulator\n", seeds(), taps,
             1e3 * on_arm, 1e3 * simulated);
  EXPECT_NEAR(on_arm, simulated, at_length() ? 0.002 : 0.006);
}

double mean_error(const ResolvedConfig& config, const std::vector<TapRecord>& taps) {
  const auto scene =
      build_scene(config.options.scene, static_cast<std::uint64_t>(config.options.seed), palpate::test::shared_host());
  std::vector<double> off;
  for (const TapRecord& tap : taps) {
    if (tap.is_contact()) off.push_back(tap.result.height() - scene->height(tap.target().x, tap.target().y));
  }
  std::sort(off.begin(), off.end());
  const auto tenth = static_cast<std::ptrdiff_t>(off.size() / 10);
  return std::accumulate(off.begin() + tenth, off.end() - tenth, 0.0) / static_cast<double>(off.size() - 2 * tenth);
}

TEST(DefaultOnTheArm, IsSimulatedByWhatCalibrateMakesOfFortyOfItsTaps) {
  if (palpate::test::kSanitized) GTEST_SKIP() << "many descents, too slow under sanitizers: release makes them";
  const auto of_block = words(3, 40, {"scene=block", "acquisition=random", "scene.effects=" + kEffects + "}"});
  auto arm = on_the_arm(of_block);
  RecordedRun recording{"the arm", arm.config, {}, {}, {}, {}, {}};
  for (const TapRecord& tap : arm.taps) {
    recording.rows.push_back(tap_row(tap));
    recording.taps.push_back(tap);
  }
  const Installation installation;
  const RunEnvironment environment{palpate::test::shared_host(), installation, {}, nullptr};
  const std::string file = calibrate(environment, {recording});
  SCOPED_TRACE(file);
  Tree twin = arm.config.tree;
  twin.at("scene").at("effects") = parse_yaml(file, "effects.yaml").at("effects");
  const ResolvedConfig config = resolve_experiment(twin, palpate::test::shared_host());
  Experiment experiment(config.options, {palpate::test::shared_host()});
  palpate::test::Collector journal;
  experiment.run(journal);
  const double simulated = mean_error(config, journal.taps);
  fmt::print("mean error {:.2f} mm on the arm, {:.2f} mm in the simulator\n", 1e3 * mean_error(arm.config, arm.taps),
             1e3 * simulated);
  EXPECT_NEAR(simulated, mean_error(arm.config, arm.taps), 0.001);
}

}  // namespace
}  // namespace palpate::baxter
