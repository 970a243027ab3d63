// SPDX-License-Identifier: MIT
#include "config/describe.hpp"

#include "record/json.hpp"
#include "support/testing.hpp"

#include <nlohmann/json.hpp>

namespace palpate::test {
namespace {

struct Part : Options {
  double width = 0.05;
  void list(Fields& fields) override { fields.real(width, Field("width", "of the part").in(Unit::metre).above(0)); }
};

struct Sample : Options {
  double length = 0.017;
  std::optional<double> limit;
  double at[2] = {0.1, 0.2};
  std::int64_t count = 3;
  bool clip = false;
  std::string name = "x";
  std::size_t design = 1;
  std::int64_t side = 4;
  Part part;
  std::vector<Part> parts;
  PluginChoice kernel{"kernel", "rbf", nullptr};
  std::vector<PluginChoice> kernels;

  void list(Fields& fields) override {
    fields.real(length, Field("length", "a reach").in(Unit::metre).above(0).from("a paper"));
    fields.real(limit, Field("limit", "a time").in(Unit::second).at_least(0).at_most(10));
    fields.reals(at, 2, Field("at", "a place").in(Unit::metre));
    fields.integer(count, Field("count", "how many").at_most(7).needed());
    fields.flag(clip, Field("clip", "cut"));
    fields.text(name, Field("name", "a word"));
    fields.choice(design, Field("design", "how"),
                  {{"random", "by lot", {}},
                   {"grid", "in rows", [this](Fields& inner) { inner.integer(side, Field("side", "of the grid")); }}});
    fields.section(part, Field("part", "one part"));
    fields.sections(parts, Field("parts", "all parts"));
    fields.plugin(kernel, Field("kernel", "a shape"));
    fields.plugins(kernels, "kernel", Field("kernels", "several shapes").needed());
    fields.require(false, "count", "a law that only reading checks");
  }
};

std::vector<FieldDescription> described() {
  Sample sample;
  return describe_fields([&](Fields& fields) { sample.list(fields); });
}

TEST(Describe, ListsFieldsInTheirOrderWithTypesInWordsRangesInTheirUnitAndDefaultsAsAConfigHasThem) {
  std::vector<std::string> lines;
  for (const FieldDescription& field : described()) {
    lines.push_back(field.name + ": " + field.type_name() + " | " + field.range + " | " + field.default_value);
  }
  EXPECT_EQ(lines, (std::vector<std::string>{"length: length | > 0 m | 0.017 m", "limit: time | 0 .. 10 s | none",
                                             "at: 2 lengths |  | [0.1 m, 0.2 m]", "count: whole number | <= 7 | 3",
                                             "clip: true or false |  | false", "name: text |  | x",
                                             "design: one of random, grid |  | grid", "part: group |  | ",
                                             "parts: list of groups |  | ", "kernel: plugin of kind kernel |  | rbf",
                                             "kernels: list of plugins of kind kernel |  | "}));
}

TEST(Describe, DescribesCasesAndNestedGroups) {
  const auto fields = described();
  ASSERT_EQ(fields[6].cases.size(), 2U);
  EXPECT_TRUE(fields[6].cases[0].fields.empty());
  EXPECT_EQ(fields[6].cases[1].fields.at(0).name, "side");
  EXPECT_EQ(fields[7].fields.at(0).name, "width");
  EXPECT_EQ(fields[8].fields.at(0).meaning, "of the part");
}

TEST(Describe, ChangesNothingInTheOptions) {
  Sample sample;
  describe_fields([&](Fields& fields) { sample.list(fields); });
  EXPECT_TRUE(sample.parts.empty());
  EXPECT_EQ(sample.design, 1U);
}

TEST(Describe, PrintsAnAlignedTable) {
  double length = 0.5;
  std::int64_t n = 2;
  const auto fields = describe_fields([&](Fields& list) {
    list.real(length, Field("length", "a reach").in(Unit::metre).from("a paper"));
    list.integer(n, Field("n", "how many").needed());
  });
  EXPECT_EQ(describe_text(fields),
            "  option  type and range  default   meaning\n"
            "  length  length          0.5 m     a reach (a paper)\n"
            "  n       whole number    required  how many\n");
}

TEST(Describe, GivesATreeThatIsValidJson) {
  const Tree tree = describe_tree(described());
  EXPECT_TRUE(nlohmann::json::accept(to_json(tree)));
  EXPECT_EQ(tree.find_path("0.unit")->text, "m");
  EXPECT_EQ(tree.find_path("0.source")->text, "a paper");
  EXPECT_EQ(tree.find_path("3.required")->text, "true");
  EXPECT_EQ(tree.find_path("3.default")->kind, Tree::Kind::null);
  EXPECT_EQ(tree.find_path("6.cases.1.options.0.name")->text, "side");
  EXPECT_EQ(tree.find_path("7.options.0.name")->text, "width");
  EXPECT_EQ(tree.find_path("10.type")->text, "list of plugins of kind kernel");
  EXPECT_EQ(tree.find_path("10.required")->text, "true");
}

struct PointCount : Options {
  std::vector<std::array<double, 2>> places{{0.1, 0.2}, {0.3, 0.4}};
  PluginChoice shape{"shape", {}, nullptr};
  void list(Fields& fields) override {
    fields.table(places, Field("places", "corners").in(Unit::metre));
    fields.adopt(shape, Field("type", "what stands there").needed());
  }
};

TEST(Describe, TellsATableByItsRow) {
  PointCount points;
  const auto fields = describe_fields([&](Fields& list) { points.list(list); });
  EXPECT_EQ(fields[0].type_name(), "rows of 2 lengths");
  EXPECT_EQ(fields[0].default_value, "[[0.1 m, 0.2 m], [0.3 m, 0.4 m]]");
  const Tree schema = schema_of(fields);
  EXPECT_EQ(schema.find_path("properties.places.type")->text, "array");
  EXPECT_EQ(schema.find_path("properties.places.items.minItems")->text, "2");
  EXPECT_EQ(schema.find_path("properties.places.items.items.type")->text, "string");
}

TEST(Describe, ListsAdoptedPluginsAsCasesWithTheirOptions) {
  const auto list = [](Fields& fields) { PointCount().list(fields); };
  const auto fields = describe_fields(list, [](const std::string& kind) {
    const auto length = describe_fields([](Fields& inner) { Part().list(inner); });
    return std::vector<FieldDescription::CaseDescription>{{"dot", "a small " + kind, {}},
                                                          {"box", "a large one", length}};
  });
  ASSERT_EQ(fields.size(), 2U);
  EXPECT_EQ(fields[1].name, "type");
  EXPECT_EQ(fields[1].type_name(), "one of dot, box");
  EXPECT_EQ(fields[1].cases[0].meaning, "a small shape");
  EXPECT_EQ(fields[1].cases[1].fields[0].name, "width");
  EXPECT_EQ(describe_fields(list)[1].type_name(), "plugin of kind shape") << "without plugins their kind is known";
  EXPECT_EQ(schema_of(fields).find("additionalProperties")->text, "false");
  const Tree unknown = schema_of(describe_fields(list));
  EXPECT_EQ(unknown.find_path("properties.type.type")->text, "string");
  EXPECT_EQ(unknown.find("additionalProperties"), nullptr) << "the options of the plugin may stand there, too";
}

}  // namespace
}  // namespace palpate::test
