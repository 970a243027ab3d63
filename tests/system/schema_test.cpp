// SPDX-License-Identifier: MIT
// The JSON Schema that editors get, judged by a validator that is not ours.
#include "config/yaml.hpp"
#include "system/shell.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

namespace palpate {
namespace {

using Json = nlohmann::json;

/// A config as an editor's YAML server sees it: plain scalars typed by YAML's core schema.
Json as_json(const Tree& tree) {
  switch (tree.kind) {
    case Tree::Kind::null:
      return nullptr;
    case Tree::Kind::scalar: {
      const Json typed = tree.quoted ? Json() : Json::parse(tree.text, nullptr, false);
      return typed.is_number() || typed.is_boolean() ? typed : Json(tree.text);
    }
    case Tree::Kind::list: {
      Json out = Json::array();
      for (const Tree& item : tree.items) out.push_back(as_json(item));
      return out;
    }
    case Tree::Kind::map: {
      Json out = Json::object();
      for (const Tree::Entry& entry : tree.entries) out[entry.key] = as_json(entry.value);
      return out;
    }
  }
  return nullptr;
}

class Schema : public Shell {
 protected:
  void SetUp() override {
    const Ended ended = palpate("schema");
    ASSERT_EQ(ended.status, 0) << ended.err;
    const Json text = Json::parse(ended.out);
    valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(text), schema_);
  }

  bool accepts(const Json& config) {
    return valijson::Validator().validate(schema_, valijson::adapters::NlohmannJsonAdapter(config), nullptr);
  }

  valijson::Schema schema_;
};

TEST_F(Schema, AcceptsEveryShippedExperiment) {
  int files = 0;
  for (const char* folder : {"configs/paper", "configs/ci", "configs/sweep", "configs/scene", "runs/reference"}) {
    for (const auto& entry : fs::recursive_directory_iterator(test::source_folder() / folder)) {
      if (entry.path().extension() != ".yaml") continue;
      ++files;
      EXPECT_TRUE(accepts(as_json(read_yaml(entry.path())))) << entry.path();
    }
  }
  EXPECT_GE(files, 10);
}

TEST_F(Schema, RefusesWhatTheProgramRefuses) {
  const Json good = as_json(read_yaml(test::source_folder() / "runs/reference/object_i_right_seed_3.yaml"));
  ASSERT_TRUE(accepts(good));
  const auto refused = [&](const char* pointer, const Json& value) {
    Json config = good;
    config[Json::json_pointer(pointer)] = value;
    return !accepts(config);
  };
  EXPECT_TRUE(refused("/tapps", 17)) << "unknown key";
  EXPECT_TRUE(refused("/taps", "many")) << "wrong type";
  EXPECT_TRUE(refused("/label/clip", "yes")) << "wrong type";
  EXPECT_TRUE(refused("/scene/objects/0/at", Json::array({"9 cm"}))) << "one length for two";
  EXPECT_TRUE(refused("/kernel/length_scale", 0.017)) << "a length without unit";
  EXPECT_TRUE(refused("/kernel/length_scale", "1.7 s")) << "a time for a length";
  EXPECT_TRUE(refused("/kernel/length_scal", "1.7 cm")) << "unknown option of a plugin";
  EXPECT_TRUE(refused("/fallback", "uncertain")) << "unknown choice";
  EXPECT_TRUE(refused("/scene/objects/0/type", "cube")) << "unknown shape";
  EXPECT_TRUE(refused("/scene/objects/0/diameter", "3 cm")) << "an option of another shape";
  EXPECT_TRUE(refused("/scene/objects/0/tilt", "3 cm")) << "a length for an angle";
  EXPECT_TRUE(refused("/scene/objects/0", {{"length", "3 cm"}})) << "an object without type";
  EXPECT_FALSE(refused("/scene/objects/0", {{"type", "ring"}, {"inner", "3 cm"}, {"at", {"9 cm", "9 cm"}}}));
  EXPECT_FALSE(refused("/kernel", "matern52")) << "a group by name is legal";
  const Json ring = {{"type", "ring"}, {"inner", "uniform(3 cm, 4 cm)"}, {"height", "5 cm"}};
  const Json draw = {{"least", 1}, {"most", 3}, {"of", Json::array({ring})}};
  EXPECT_FALSE(refused("/scene/objects", {{"draw", draw}}));
  EXPECT_TRUE(refused("/scene/objects", Json::array({ring}))) << "a range that nobody draws";
  EXPECT_TRUE(refused("/scene/objects", {{"drow", draw}})) << "unknown key";
  EXPECT_TRUE(refused("/scene/objects", {{"draw", {{"least", 1}, {"of", draw["of"]}}}})) << "no most";
  const Json cubes = {{"least", 1}, {"most", 3}, {"of", Json::array({{{"type", "cube"}}})}};
  EXPECT_TRUE(refused("/scene/objects", {{"draw", cubes}})) << "unknown shape";
  const Json rbf = {{"type", "rbf"}, {"length_scale", "2 cm"}};
  const Json scaled = {{"type", "scale"}, {"factor", 2}, {"kernel", rbf}};
  EXPECT_FALSE(refused("/kernel", {{"type", "sum"}, {"kernels", Json::array({rbf, scaled})}}));
  EXPECT_TRUE(refused("/kernel", {{"type", "sum"}, {"kernels", rbf}})) << "no list";
  EXPECT_TRUE(refused("/kernel", {{"type", "sum"}, {"kernels", Json::array({{{"length_scale", "2 cm"}}})}}))
      << "an item without type";
  EXPECT_TRUE(refused("/kernel", {{"type", "sum"}, {"kernels", Json::array({"rbf"})}})) << "a name in a list";
  EXPECT_TRUE(refused("/kernel", {{"type", "sum"}, {"kernels", Json::array({{{"type", "rfb"}}})}})) << "unknown type";
  EXPECT_TRUE(refused("/kernel", {{"type", "scale"}, {"factor", "2 cm"}, {"kernel", rbf}})) << "a length for a number";
  EXPECT_TRUE(refused("/surface", "two_parts")) << "unknown choice";
  EXPECT_FALSE(refused("/expect", {{"median(rmse_m)", "<= 2 cm"}, {"found", true}}));
  EXPECT_TRUE(refused("/expect", {{"rmse", "<= 2 cm"}})) << "no field of the summary";
  EXPECT_TRUE(refused("/expect", {{"meadian(rmse_m)", "<= 2 cm"}})) << "unknown statistic";
  EXPECT_TRUE(refused("/expect", {{"taps", 17}})) << "no comparison";
  const Json points = {{"samples", 64}, {"keys", {{"kernel.length_scale", "log_uniform(1 cm, 10 cm)"}}}};
  EXPECT_FALSE(refused("/sweep", {{"grid", {{"seed", "range(0,9)"}, {"taps", {12, 17}}}}, {"sobol", points}}));
  EXPECT_FALSE(refused("/sweep", {{"list", Json::array({{{"taps", 12}}})}, {"where", "taps > 9"}}));
  EXPECT_FALSE(refused("/sweep", {{"zip", {{"taps", {12, 17}}}}, {"where", {"taps > 9", "seed < 3"}}}));
  EXPECT_TRUE(refused("/sweep", {{"gird", {{"taps", {12, 17}}}}})) << "unknown block";
  EXPECT_TRUE(refused("/sweep", {{"list", {{"taps", 12}}}})) << "no list";
  EXPECT_TRUE(refused("/sweep", {{"sobol", {{"samples", 0}, {"keys", points["keys"]}}}})) << "no points";
  EXPECT_TRUE(refused("/sweep", {{"sobol", {{"samples", 4}}}})) << "no keys";
  EXPECT_TRUE(refused("/sweep", {{"where", 3}})) << "no condition";
  Json plan = {{"metric", "rmse_m"}, {"by", {"acquisition", "kernel"}}, {"seeds", 40}, {"difference", "1 mm"}};
  EXPECT_FALSE(refused("/compare", plan));
  EXPECT_FALSE(refused("/compare", "none"));
  plan["seeds"] = "many";
  EXPECT_TRUE(refused("/compare", plan)) << "wrong type";
  EXPECT_TRUE(refused("/compare", {{"metric", "rmse_m"}, {"by", "acquisition"}})) << "no seeds";
  EXPECT_TRUE(refused("/compare", {{"metrics", "rmse_m"}})) << "unknown option";
}

}  // namespace
}  // namespace palpate
