// SPDX-License-Identifier: MIT
// Calibration: the estimates for contacts drawn with known parameters, and a simulator with the resulting file, which
// must err like the original arm.
#include "calibrate/calibrate.hpp"

#include "calibrate/contact_fit.hpp"
#include "config/yaml.hpp"
#include "record/run.hpp"
#include "scene/scene_options.hpp"
#include "support/filled.hpp"
#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <palpate/random.hpp>

#include <numeric>

namespace palpate {
namespace {

namespace fs = std::filesystem;

using test::shared_host;
using test::TemporaryFolder;
using ::testing::HasSubstr;

/// The parameters of drawn contacts.
struct Arm {
  double offset = 0.004, drift = 1e-3 / 60.0, noise = 0.0015, lateral = 0.003, lies = 0.05;
};

std::vector<KnownContact> contacts_of(const Scene& scene, const Arm& arm, int count, std::uint64_t seed) {
  Random random(seed, "calibrate test");
  const auto normal = [&] {
    return std::sqrt(-2.0 * std::log(1.0 - random.uniform())) * std::cos(6.283185307179586 * random.uniform());
  };
  std::vector<KnownContact> out;
  for (int i = 0; i < count; ++i) {
    KnownContact one{&scene, {0.23 * random.uniform(), 0.23 * random.uniform()}, 3.0 * i};
    one.height = scene.height(one.place.x + arm.lateral * normal(), one.place.y + arm.lateral * normal()) + arm.offset +
                 arm.drift * one.elapsed + arm.noise * normal();
    if (random.uniform() < arm.lies) one.height = 0.15 * random.uniform();
    out.push_back(one);
  }
  return out;
}

std::unique_ptr<const Scene> block() {
  return build_scene(test::filled<SceneOptions>("{area: {width: 23 cm, depth: 23 cm}, objects: [{type: block, length: "
                                                "14 cm, width: 8 cm, height: 5 cm}]}"),
                     1, shared_host());
}

TEST(Contacts, TellOffsetDriftNoisePlaceAndLiesWithinTheirIntervalsAsOftenAsTheseSay) {
  if (test::kSanitized) GTEST_SKIP() << "./check --all makes it in release";
  const auto scene = block();
  const Arm arm;
  constexpr int kSets = 60;
  constexpr int kContacts = 80;
  int offset = 0, drift = 0, noise = 0, lateral = 0, lies = 0;
  const auto holds = [](const IntervalEstimate& one, double truth) {
    return one.low <= truth && truth <= one.high ? 1 : 0;
  };
  for (std::uint64_t seed = 1; seed <= kSets; ++seed) {
    const ContactFit fit = fit_contacts(contacts_of(*scene, arm, kContacts, seed), 0.15);
    offset += holds(fit.offset, arm.offset + arm.drift * fit.mean_elapsed);
    drift += fit.drift ? holds(*fit.drift, arm.drift) : 0;
    noise += holds(fit.noise, arm.noise);
    lateral += fit.lateral ? holds(*fit.lateral, arm.lateral) : 1;
    lies += holds(fit.false_share, arm.lies);
  }
  // Of 60 intervals of 95 %, fewer than 51 contain the true value once in ten thousand.
  for (const int count : {offset, drift, noise, lateral, lies}) EXPECT_GE(count, 51);
}

TEST(Contacts, TellNoPlaceOfABareDeskAndNoDriftOfAnArmThatHasNone) {
  const auto desk = build_scene(test::filled<SceneOptions>("{area: {width: 23 cm, depth: 23 cm}}"), 1, shared_host());
  Arm arm;
  arm.drift = 0.0;
  int drifts = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const ContactFit fit = fit_contacts(contacts_of(*desk, arm, 40, seed), 0.15);
    EXPECT_FALSE(fit.lateral);
    drifts += fit.drift ? 1 : 0;
  }
  EXPECT_LE(drifts, 5) << "one in twenty, by the level of the test";
}

TEST(Contacts, ShareOfNoneAndOfAllKeepsToWhatASharesCanBe) {
  EXPECT_EQ(share_of(0, 40).low, 0.0);
  EXPECT_GT(share_of(0, 40).high, 0.05);
  EXPECT_LT(share_of(40, 40).low, 0.95);
  EXPECT_EQ(share_of(40, 40).high, 1.0);
  EXPECT_NEAR(share_of(20, 40).low, 0.352, 0.001);  // Wilson's interval, computed by hand
}

class Calibrate : public testing::Test {
 protected:
  RecordedRun recorded(const ResolvedConfig& config) {
    const fs::path directory = folder_.path() / std::to_string(runs_++);
    start_run(environment, config, directory, {});
    return read_recorded_run(environment.host, directory);
  }

  /// Returns the mean height error of the middle half of the contacts.
  static double mean_error(const RecordedRun& run) {
    const auto scene =
        build_scene(run.config.options.scene, static_cast<std::uint64_t>(run.config.options.seed), shared_host());
    std::vector<double> off;
    for (const TapRecord& tap : run.taps) {
      if (tap.is_contact()) off.push_back(tap.result.height() - scene->height(tap.target().x, tap.target().y));
    }
    std::sort(off.begin(), off.end());
    const auto quarter = static_cast<std::ptrdiff_t>(off.size() / 4);
    return std::accumulate(off.begin() + quarter, off.end() - quarter, 0.0) /
           static_cast<double>(off.end() - off.begin() - 2 * quarter);
  }

  std::string refusal(const std::vector<RecordedRun>& runs) {
    return test::error_of([&] { calibrate(environment, runs); });
  }

 private:
  TemporaryFolder folder_;
  Installation installation_;
  int runs_ = 0;

 public:
  RunEnvironment environment{shared_host(), installation_, {}, nullptr};
};

TEST_F(Calibrate, HasTheSimulatorErrAsTheArmDidThatTheTapsAreOf) {
  const std::string effects =
      "scene.effects={force_noise: {}, force_drift: {}, stiffness: {}, joint_lag: {}, latency: {}, pose_noise: "
      "{lateral: 3 mm, vertical: 2 mm}, missed_contacts: {probability: 0.1}, height_offset: {constant: -3 mm}}";
  for (const std::string motion : {"per_tap", "paper", "continuous"}) {
    const std::vector<std::string> words{"scene=block", "acquisition=random", "taps=40", "motion=" + motion, effects};
    const RecordedRun arm = recorded(test::shipped_config("default.yaml", words));
    const std::string file = calibrate(environment, {arm});
    SCOPED_TRACE(file);
    Tree found = test::shipped_config("default.yaml", words).tree;
    found.at("scene").at("effects") = parse_yaml(file, "effects.yaml").at("effects");
    found.at("seed") = Tree::scalar("12");
    const RecordedRun rerun = recorded(resolve_experiment(found, shared_host()));
    EXPECT_NEAR(mean_error(rerun), mean_error(arm), 0.001);
    EXPECT_THAT(file, HasSubstr("height_offset"));
    EXPECT_THAT(file, HasSubstr("# assumed"));
  }
}

TEST(Contacts, AreBesideTheSceneByHowFarTheyAreOffAllHeightsWithinOneCentimetre) {
  const auto scene = block();  // 5 cm high, x from 0 to 14 cm, y from 0 to 8 cm about its centre
  const double edge = 0.115 + 0.07;
  const auto beyond = [&](double x, double height) {
    return beyond_surface({scene.get(), {x, 0.115}, 0.0, height + 0.004}, 0.004);
  };
  EXPECT_NEAR(beyond(0.115, 0.05), 0.0, 1e-12);
  EXPECT_NEAR(beyond(0.115, 0.03), -0.02, 1e-12);
  EXPECT_NEAR(beyond(0.02, 0.03), 0.03, 1e-12);
  EXPECT_NEAR(beyond(edge + 0.009, 0.03), 0.0, 1e-12) << "between the heights of block and desk";
  EXPECT_NEAR(beyond(edge + 0.011, 0.03), 0.03, 1e-12);
  EXPECT_NEAR(beyond(edge - 0.011, 0.03), -0.02, 1e-12);
}

TEST_F(Calibrate, RejectsARunWhoseSceneDoesNotStandAsItsConfigSays) {
  const RecordedRun arm = recorded(
      test::shipped_config("default.yaml", {"scene=block", "acquisition=random", "taps=40", "scene.effects=standard"}));
  EXPECT_EQ(refusal({arm}), "accepted");
  const auto said_to_be = [&](const char* scene) {
    Tree tree = arm.config.tree;
    const Tree changes = parse_yaml(scene, "scene");
    for (const Tree::Entry& one : changes.entries) tree.at("scene").at(one.key) = one.value;
    RecordedRun out = arm;
    out.config = resolve_experiment(tree, shared_host());
    return out;
  };
  const std::string block = "{type: block, length: 12 cm, width: 8 cm, height: 5 cm, rotation: 30 deg, at: ";
  EXPECT_THAT(refusal({said_to_be("{objects: []}")}),
              HasSubstr("contacts are far from its scene, but only one in 5 may be, use taps on a scene"));
  EXPECT_THAT(refusal({said_to_be(("{objects: [" + block + "[8 cm, 11.5 cm]}]}").c_str())}),
              HasSubstr("contacts are within an object of its scene, but only one in 20 may be"));
  EXPECT_THAT(refusal({said_to_be("{desk: 4 cm}")}), HasSubstr("the heights are off by -40."));
  const RecordedRun moved = said_to_be("{objects: []}");
  EXPECT_THAT(refusal({arm, arm, arm, moved}), HasSubstr("far from its scene")) << "among others, too";
}

}  // namespace
}  // namespace palpate
