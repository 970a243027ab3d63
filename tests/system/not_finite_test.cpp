// SPDX-License-Identifier: MIT
// A plugin that gives NaN or infinity, by each of its functions in turn: the run ends with one line that names both.
// The plugins are those of tests/bad_plugins/not_finite.cpp.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cctype>
#include <ostream>

namespace palpate {
namespace {

const char* const kAbove =
    "kernel: {type: rbf, length_scale: 3 cm}\nacquisition: {type: footprint_entropy}\nfitting: {type: fixed}\n"
    "belief: {surface: two_part, height: {noise: 6 mm, outlier_probability: 0.03}}\n"
    "backend: {type: simulator}\ntaps: 20\ncandidates: {count: 15}\n"
    "scene: {area: {width: 23 cm, depth: 23 cm}, min_object_height: 1 cm, objects: [{type: wave, at: [12 cm, 12 "
    "cm]}]}\n";

const char* const kAnySide =
    "kernel: {type: matern32, length_scale: 4 cm}\nacquisition: {type: discovery}\nfitting: {type: fixed}\n"
    "belief: {type: solids, particles: 4, moves: 50}\ncandidates: {count: 100}\ninitial: {design: random, count: 1}\n"
    "backend: {type: simulator}\ntaps: 12\n"
    "scene: {area: {width: 26 cm, depth: 26 cm}, objects: [{type: block, at: [13 cm, 13 cm]}]}\n";

/// A function of a plugin, what is said of it, and the rest of a config in which it is called.
struct Spoilt {
  std::string kind;
  std::string function;
  std::string said;
  Words more{};
  const char* config = kAbove;
};

void PrintTo(const Spoilt& one, std::ostream* out) { *out << one.kind << ": " << one.function; }

const Words kFootprint{"belief.footprint={type: gp_classifier, kernel: {type: rbf, length_scale: 3 cm}}"};

class NotFinite : public Shell, public testing::WithParamInterface<std::tuple<Spoilt, const char*>> {};

TEST_P(NotFinite, EndsTheRunWithOneLineThatNamesPluginAndFunction) {
  const auto& [one, by] = GetParam();
  environment_ = {test::with_plugin("not_finite")};
  const bool sound_footprint = one.config == kAbove && one.kind != "footprint";
  const std::string file = write("exp.yaml", one.config).string();
  const std::string at = one.kind == "shape"       ? "scene.objects.0"
                         : one.kind == "footprint" ? "belief.footprint"
                                                   : one.kind;
  const Ended ended =
      palpate(Words{"run", file, "--quiet"} + (sound_footprint ? kFootprint : Words{}) +
              Words{at + ".type=not_finite", at + ".spoils='" + one.function + "'", at + ".by=" + by} + one.more);
  EXPECT_NE(ended.status, 0);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(lines(ended.err), 1) << ended.err;
  EXPECT_THAT(ended.err, HasSubstr(one.kind + "/not_finite: "));
  EXPECT_THAT(ended.err, HasSubstr(one.said));
}

const Words kCeres{"fitting.type=ceres"};
const Words kFarFit{"fitting.type=not_finite", "fitting.spoils='fit: far'", "belief.engine.type=dense"};

INSTANTIATE_TEST_SUITE_P(
    By, NotFinite,
    testing::Combine(
        testing::Values(
            Spoilt{"kernel", "covariance", "covariance() returned"},
            Spoilt{"kernel", "variance", "variance() returned"},
            Spoilt{"kernel", "axis_covariance", "axis_covariance() returned"},
            Spoilt{"kernel", "parameters", "parameters() returned"},
            Spoilt{"kernel", "derivatives", "derivatives() returned", kCeres},
            Spoilt{"kernel",
                   "covariance",
                   "covariance() returned",
                   {"belief.engine.type=dense", "belief.engine.threads=3"}},
            Spoilt{"kernel", "covariance", "covariance() returned", {}, kAnySide},
            Spoilt{"kernel", "set_parameters", "() returned", kCeres},
            Spoilt{"kernel", "covariance of a far fit", "covariance() returned", kFarFit},
            Spoilt{"acquisition", "score", "score that is not"},
            Spoilt{"acquisition", "prior_scale", "prior_scale() returned"},
            Spoilt{"acquisition", "score", "score that is not", {}, kAnySide},
            Spoilt{"fitting", "fit: noise", "fit() returned"}, Spoilt{"fitting", "fit: signal", "fit() returned"},
            Spoilt{"fitting", "fit: mean", "fit() returned"}, Spoilt{"fitting", "fit: objective", "fit() returned"},
            Spoilt{"fitting", "fit: kernel", "fit() returned"},
            Spoilt{"footprint", "probability", "probability() returned"},
            Spoilt{"footprint", "sample", "sample() returned", {"acquisition.type=variance_reduction"}},
            Spoilt{"footprint", "doubt", "doubt() returned"},
            Spoilt{"footprint", "current_positions", "current_positions() returned"},
            Spoilt{"footprint",
                   "undiscovered_probability",
                   "undiscovered_probability() returned",
                   {"stop.expected_rmse='3 cm'"}},
            Spoilt{"footprint", "numbers", "numbers() returned"},
            Spoilt{"backend", "tap: height", "height that is not"},
            Spoilt{"backend", "tap: force", "force or a time that is not"},
            Spoilt{"backend", "tap: seconds", "force or a time that is not"},
            Spoilt{"backend", "tap: peak", "force or a time that is not"},
            Spoilt{"backend", "motions: seconds", "seconds() returned"},
            Spoilt{"backend", "motions: deviation", "deviation() returned"},
            Spoilt{"shape", "support", "support() returned"}, Spoilt{"shape", "top", "top() returned"},
            Spoilt{"shape", "first_intersection", "first_intersection() returned", {"scene.objects.0.tilt='10 deg'"}},
            Spoilt{"shape", "first_intersection", "first_intersection() returned", {}, kAnySide},
            Spoilt{"shape", "intervals", "intervals() returned", {}, kAnySide},
            Spoilt{"backend", "tap: along", "an end point that is not on the path", {}, kAnySide}),
        testing::Values("nan", "infinity")),
    [](const auto& one) {
      const Spoilt& spoilt = std::get<0>(one.param);
      std::string name =
          spoilt.kind + "_" + spoilt.function + "_" + std::get<1>(one.param) + "_" + std::to_string(one.index);
      for (char& letter : name) letter = std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
      return name;
    });

}  // namespace
}  // namespace palpate
