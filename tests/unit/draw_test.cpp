// SPDX-License-Identifier: MIT
// Objects drawn from the seed: what is drawn, that the record tells it all, and what is refused.
#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace palpate::test {
namespace {

ResolvedConfig clutter(std::int64_t seed, std::vector<std::string> overrides = {}) {
  overrides.insert(overrides.begin(), {"scene=clutter", "seed=" + std::to_string(seed)});
  return shipped_config("paper/object_i.yaml", overrides);
}

std::string objects_of(const ResolvedConfig& config) { return to_yaml(*config.tree.find_path("scene.objects")); }

const std::vector<Tree>& list_of(const ResolvedConfig& config) { return config.tree.find_path("scene.objects")->items; }

/// The bounds that configs/scene/clutter.yaml has, in its order.
struct Bounds {
  double low, high;
};
const std::map<std::string, std::map<std::string, Bounds>> kKinds{
    {"block", {{"length", {0.06, 0.14}}, {"width", {0.03, 0.06}}, {"height", {0.04, 0.1}}}},
    {"cylinder", {{"diameter", {0.06, 0.1}}, {"height", {0.04, 0.1}}}},
    {"l", {{"length", {0.08, 0.14}}, {"width", {0.07, 0.1}}, {"thickness", {0.03, 0.04}}, {"height", {0.04, 0.1}}}},
    {"ring", {{"outer", {0.1, 0.14}}, {"inner", {0.03, 0.04}}, {"height", {0.04, 0.1}}}},
    {"slope", {{"length", {0.06, 0.14}}, {"width", {0.03, 0.06}}, {"low", {0.02, 0.04}}, {"high", {0.04, 0.1}}}},
    {"wave",
     {{"length", {0.06, 0.14}},
      {"width", {0.03, 0.06}},
      {"height", {0.05, 0.08}},
      {"amplitude", {0.01, 0.02}},
      {"period", {0.04, 0.08}}}}};

TEST(Draw, OfOneSeedIsTheSameAndOfAnotherAnother) {
  EXPECT_EQ(objects_of(clutter(7)), objects_of(clutter(7)));
  EXPECT_EQ(clutter(7).id, clutter(7).id);
  EXPECT_NE(objects_of(clutter(7)), objects_of(clutter(8)));
}

TEST(Draw, IsUniformInNumberKindAndSize) {
  constexpr int kSeeds = 200;
  std::map<std::size_t, int> counts;
  std::map<std::string, int> kinds;
  std::vector<double> shares;  // of the way through its range, of every size
  for (int seed = 0; seed < kSeeds; ++seed) {
    const ResolvedConfig config = clutter(seed);
    ++counts[list_of(config).size()];
    for (const Tree& object : list_of(config)) {
      const std::string type = object.find("type")->text;
      ++kinds[type];
      for (const auto& [name, bounds] : kKinds.at(type)) {
        const double value = read_quantity(*object.find(name), name, Unit::metre);
        shares.push_back((value - bounds.low) / (bounds.high - bounds.low));
      }
    }
  }
  ASSERT_EQ(counts.size(), 5U);
  EXPECT_EQ(counts.begin()->first, 2U);
  EXPECT_EQ(counts.rbegin()->first, 6U);
  // Within five standard deviations of what is expected.
  for (const auto& [count, seeds] : counts) EXPECT_NEAR(seeds, kSeeds / 5.0, 5 * std::sqrt(kSeeds * 0.16)) << count;
  ASSERT_EQ(kinds.size(), kKinds.size());
  double all = 0.0;
  for (const auto& [kind, objects] : kinds) all += objects;
  for (const auto& [kind, objects] : kinds) EXPECT_NEAR(objects, all / 6, 5 * std::sqrt(all * 5 / 36)) << kind;
  std::sort(shares.begin(), shares.end());
  EXPECT_GE(shares.front(), -1e-12);
  EXPECT_LE(shares.back(), 1.0 + 1e-12);
  const auto size = static_cast<double>(shares.size());
  for (std::size_t i = 0; i < shares.size(); ++i)
    ASSERT_NEAR(shares[i], static_cast<double>(i) / size, 2.0 / std::sqrt(size)) << "Kolmogorov and Smirnov, 1 in 1000";
}

TEST(Draw, OfFewObjectsAreTheFirstOfMany) {
  const ResolvedConfig few = clutter(3, {"scene.objects.draw.least=2", "scene.objects.draw.most=2"});
  const ResolvedConfig many = clutter(3, {"scene.objects.draw.least=5", "scene.objects.draw.most=5"});
  ASSERT_EQ(list_of(few).size(), 2U);
  ASSERT_EQ(list_of(many).size(), 5U);
  for (std::size_t i = 0; i < 2; ++i) EXPECT_EQ(list_of(few)[i].canonical(), list_of(many)[i].canonical());
}

TEST(Draw, FindsRoomForThreeHundredClutters) {
  for (int seed = 0; seed < 300; ++seed) {
    const ResolvedConfig config = clutter(seed);
    EXPECT_NO_THROW(build_scene(config.options.scene, static_cast<std::uint64_t>(seed), shared_host())) << seed;
  }
}

TEST(Draw, IsReadBackFromTheConfigOfItsRunAsAPlainListWithTheSameId) {
  const ResolvedConfig drawn = clutter(5);
  const ResolvedConfig again = resolve_experiment(parse_yaml(to_yaml(drawn.tree), "again.yaml"), shared_host());
  EXPECT_EQ(again.tree.find_path("scene.objects")->kind, Tree::Kind::list);
  EXPECT_EQ(again.id, drawn.id);
  EXPECT_EQ(to_yaml(again.tree), to_yaml(drawn.tree));
}

TEST(Draw, KnowsWhereEachValueWasWritten) {
  const ResolvedConfig config = clutter(1, {"scene.objects.draw.of=[{type: cone, height: \"uniform(4 cm, 6 cm)\"}]"});
  const auto& origins = config.notes.origins;
  const auto height = std::find_if(origins.begin(), origins.end(),
                                   [](const auto& one) { return one.path == "scene.objects.1.height"; });
  ASSERT_NE(height, origins.end());
  EXPECT_EQ(height->place, "command line");
}

/// What is said of a config with this draw, from the third line on.
std::string draw_refused(const std::string& draw) {
  return error_of([&] { resolve_experiment(parse_yaml("scene:\n  objects:\n" + draw, "c.yaml"), shared_host()); });
}

std::string drawn_from(const std::string& of, const std::string& counts = "{least: 1, most: 2, of: ") {
  return draw_refused("    draw: " + counts + "[" + of + "]}\n");
}

TEST(Draw, RefusesNumbersThatAreNone) {
  EXPECT_EQ(drawn_from("{type: block}", "{least: 3, most: 2, of: "),
            "c.yaml:3:28: scene.objects.draw.most: is less than 'least', which is 3");
  EXPECT_EQ(drawn_from("{type: block}", "{least: -1, most: 2, of: "),
            "c.yaml:3:19: scene.objects.draw.least: -1 is out of range, it must be at least 0");
  EXPECT_EQ(drawn_from("{type: block}", "{least: 1, most: 2000, of: "),
            "c.yaml:3:28: scene.objects.draw.most: 2000 is out of range, it must be at most 1000");
  EXPECT_EQ(drawn_from("{type: block}", "{most: 2, of: "),
            "c.yaml:3:11: 'scene.objects.draw.least' is missing, set it: minimum number of objects");
  EXPECT_EQ(drawn_from(""), "c.yaml:3:35: scene.objects.draw.of: is empty, name at least one object");
}

TEST(Draw, RefusesKeysThatItDoesNotKnow) {
  EXPECT_EQ(draw_refused("    drow: {least: 1}\n"), "c.yaml:3:5: unknown option 'drow', did you mean 'draw'?");
  EXPECT_EQ(drawn_from("{type: block}", "{least: 1, mots: 2, of: "),
            "c.yaml:3:22: unknown option 'mots', did you mean 'most'?");
}

TEST(Draw, RefusesWhatNoObjectMayBeEvenIfThisSeedDoesNotDrawIt) {
  const std::string many = "{type: block}, {type: block}, {type: block}, {type: block}, ";
  EXPECT_EQ(drawn_from(many + "{type: block, lenght: 3 cm}"),
            "c.yaml:3:110: unknown option 'lenght', did you mean 'length'?");
  EXPECT_EQ(drawn_from(many + "{type: ring, outer: \"uniform(6 cm, 9 cm)\", inner: \"uniform(3 cm, 7 cm)\"}"),
            "c.yaml:3:146: scene.objects.draw.of.4.inner: is not less than the outer diameter");
  EXPECT_EQ(drawn_from("{type: blok}").substr(0, 40), "c.yaml:3:43: no plugin shape/blok, did y");
}

TEST(Draw, RefusesRangesThatAreNone) {
  const std::string how = ", write uniform(0.1 mm, 1 mm) or log_uniform(1 cm, 10 cm), with a unit at both ends";
  const auto of_length = [](const std::string& value) { return drawn_from("{type: block, length: " + value + "}"); };
  const std::string at = "c.yaml:3:58: scene.objects.draw.of.0.length: ";
  EXPECT_EQ(of_length("\"uniform(8 mm)\""), at + "'uniform(8 mm)' does not have two ends" + how);
  EXPECT_EQ(of_length("uniform(3 cm, 8 cm)"),
            at + "'uniform(3 cm' has no closing ')', inside braces, put it into quotes: \"uniform(...)\"");
  EXPECT_EQ(of_length("\"uniform(3 s, 8 s)\"").substr(0, at.size() + 9), at + "'3 s' is ");
}

TEST(Draw, IsTheOnlyPlaceForARange) {
  const std::string why = "is not a number, use ranges only in scene.objects.draw.of and in the keys of sweep.sobol";
  EXPECT_EQ(error_of([] { shipped_config("paper/object_i.yaml", {"belief.height.signal=uniform(1 m, 2 m)"}); }),
            "command line: belief.height.signal: 'uniform(1 m, 2 m)' " + why);
  EXPECT_EQ(error_of([] {
              shipped_config("paper/object_i.yaml", {"scene.objects=[{type: block, length: \"uniform(1 m, 2 m)\"}]"});
            }),
            "command line: scene.objects.0.length: 'uniform(1 m, 2 m)' " + why);
}

}  // namespace
}  // namespace palpate::test
