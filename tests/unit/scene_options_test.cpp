// SPDX-License-Identifier: MIT
// What a config may say of objects, and what it is told when it may not.
#include "config/describe.hpp"
#include "config/resolve.hpp"
#include "config/yaml.hpp"
#include "support/shape_cases.hpp"
#include "support/testing.hpp"

#include <set>

namespace palpate::test {
namespace {

/// What is said of an object, without the place.
std::string object_refusal(const std::string& object) {
  try {
    scene_of({object});
  } catch (const Error& error) {
    return error.reason();
  }
  return "accepted";
}

TEST(SceneOptions, RefuseDimensionsThatMakeNoSolidATiltOfMoreThan80DegreesAndFieldsOfAnotherShape) {
  EXPECT_EQ(object_refusal("{type: dome, diameter: 10 cm, height: 51 mm}"),
            "objects.0.height: is more than half the diameter, the height of a half ball");
  EXPECT_EQ(object_refusal("{type: ring, outer: 4 cm, inner: 4 cm}"),
            "objects.0.inner: is not less than the outer diameter");
  EXPECT_EQ(object_refusal("{type: l, length: 8 cm, width: 3 cm, thickness: 3 cm}"),
            "objects.0.thickness: is not less than length and width, which leaves no second bar");
  EXPECT_EQ(object_refusal("{type: cone, height: 0 cm}"), "objects.0.height: 0 cm is out of range");
  EXPECT_EQ(object_refusal("{type: wave, height: 1 cm, amplitude: 2 cm}"),
            "objects.0.amplitude: is larger than the mean height, so the top would be below the desk");
  EXPECT_EQ(object_refusal("{type: block, tilt: 80 deg}"), "accepted");
  EXPECT_EQ(object_refusal("{type: block, tilt: -80 deg}"), "accepted");
  EXPECT_EQ(object_refusal("{type: block, tilt: 80.1 deg}"), "objects.0.tilt: is more than 80 deg");
  EXPECT_EQ(object_refusal("{type: block, tilt: -81 deg}"), "objects.0.tilt: is more than 80 deg");
  EXPECT_EQ(object_refusal("{type: cylinder, length: 8 cm}"), "unknown option 'length' of objects.0");
  EXPECT_EQ(object_refusal("{type: cube}"), "no plugin shape/cube");
}

std::string outline(const std::string& points, const std::string& hole = "[]") {
  return object_refusal("{type: polygon, outline: " + points + ", hole: " + hole + "}");
}

TEST(SceneOptions, RefuseOutlinesThatBoundNothing) {
  const std::string square = "[[0 cm, 0 cm], [4 cm, 0 cm], [4 cm, 4 cm], [0 cm, 4 cm]]";
  EXPECT_EQ(outline(square), "accepted");
  EXPECT_EQ(object_refusal("{type: polygon}"), "'objects.0.outline' is missing");
  EXPECT_EQ(outline("[[0 cm, 0 cm], [4 cm, 0 cm]]"), "objects.0.outline: needs three points or more");
  EXPECT_EQ(outline("[[0 cm, 0 cm], [4 cm, 0 cm], [4 cm, 4 cm], [0 cm, 0 cm]]"),
            "objects.0.outline: points 4 and 1 are equal; the outline closes by itself");
  EXPECT_EQ(outline("[[0 cm, 0 cm], [4 cm, 4 cm], [4 cm, 0 cm], [0 cm, 4 cm]]"),
            "objects.0.outline: edge 1 meets edge 3");
  EXPECT_EQ(outline("[[0 cm, 0 cm], [4 cm, 0 cm], [2 cm, 0 cm]]"), "objects.0.outline: folds back at point 2");
  EXPECT_EQ(outline("[[0 cm, 0 cm], [4 cm, 0 cm], [4 cm, 4 cm], [2 cm, 0 cm], [0 cm, 4 cm]]"),
            "objects.0.outline: edge 1 meets edge 3")
      << "a corner that touches an edge";
  EXPECT_EQ(outline("[[0 cm], [4 cm, 0 cm]]"), "objects.0.outline: expects a list of rows of 2 values");
  EXPECT_EQ(outline("[[0 cm, 0], [4 cm, 0 cm]]").substr(0, 17), "objects.0.outline");
}

TEST(SceneOptions, RefuseHolesThatLeaveTheOutline) {
  const std::string square = "[[0 cm, 0 cm], [4 cm, 0 cm], [4 cm, 4 cm], [0 cm, 4 cm]]";
  EXPECT_EQ(outline(square, "[[1 cm, 1 cm], [3 cm, 1 cm], [2 cm, 3 cm]]"), "accepted");
  EXPECT_EQ(outline(square, "[[1 cm, 1 cm], [5 cm, 1 cm], [2 cm, 3 cm]]"),
            "objects.0.hole: its edge 1 meets edge 2 of the outline");
  EXPECT_EQ(outline(square, "[[6 cm, 1 cm], [9 cm, 1 cm], [7 cm, 3 cm]]"), "objects.0.hole: lies outside the outline");
  EXPECT_EQ(outline(square, "[[1 cm, 1 cm], [3 cm, 1 cm]]"), "objects.0.hole: needs three points or more");
}

TEST(SceneOptions, RefuseACompoundWithoutPartsAndSayWhichPartIsWrong) {
  EXPECT_EQ(object_refusal("{type: compound}"), "'objects.0.parts' is missing");
  EXPECT_EQ(object_refusal("{type: compound, parts: []}"), "objects.0.parts: needs at least one part");
  EXPECT_EQ(object_refusal("{type: compound, parts: [{type: cone}, {at: [1 cm, 1 cm]}]}"),
            "'objects.0.parts.1.type' is missing");
  EXPECT_EQ(object_refusal("{type: compound, parts: [{type: cone, height: 0 cm}]}"),
            "objects.0.parts.0.height: 0 cm is out of range");
  EXPECT_EQ(object_refusal("{type: compound, parts: [{type: cone, tilt: 5 deg}]}"),
            "unknown option 'tilt' of objects.0.parts.0");
  EXPECT_EQ(object_refusal("{type: random_outline, number: -1}"), "objects.0.number: -1 is out of range");
}

/// The objects of a scene as the resolved config has them, which ids of runs follow.
std::string resolved(const std::string& objects) {
  SceneOptions options;
  ResolveNotes notes;
  const std::string scene = "{area: {width: 1 m, depth: 1 m}, objects: " + objects + "}";
  return to_yaml(*resolve(options, parse_yaml(scene, "scene.yaml"), shared_host(), notes).find("objects"));
}

TEST(SceneOptions, ReadBackAsTheyWereResolvedAnObjectsOwnKeysBehindThoseOfItsShape) {
  const std::string polygon = "{type: polygon, outline: [[0 m, 0 m], [0.01 m, 0 m], [0 m, 0.01 m]], hole: [], height: ";
  const std::string ring = "{type: ring, outer: 0.14 m, inner: 0.06 m, height: 0.05 m, ";
  const std::string placed = "at: [0.115 m, 0.115 m], rotation: 0 rad, tilt: ";
  const std::string whole = "[" + polygon + "0.05 m, " + placed + "0.5 rad}, " + ring + placed + "0 rad}]";
  EXPECT_EQ(
      resolved("[{tilt: 0.5 rad, outline: [[0 cm, 0 cm], [1 cm, 0 cm], [0 cm, 1 cm]], type: polygon}, {type: ring}]"),
      to_yaml(parse_yaml(whole, "resolved.yaml")));
  EXPECT_EQ(resolved(whole), to_yaml(parse_yaml(whole, "resolved.yaml")));
}

TEST(SceneOptions, NameThePluginsOfTheirShapes) {
  SceneOptions options;
  ResolveNotes notes;
  const std::string file = (source_folder() / "configs/scene/meshes/cup.stl").string();
  const Tree tree = resolve(options,
                            parse_yaml("{area: {width: 1 m, depth: 1 m}, objects: [{type: mesh, file: '" + file +
                                           "', unit: 1 mm, rotation: 1 rad}, {type: cone}, {type: cone}]}",
                                       "scene.yaml"),
                            shared_host(), notes);
  EXPECT_EQ(notes.plugins, (std::set<std::pair<std::string, std::string>>{{"shape", "cone"}, {"shape", "mesh"}}));
  EXPECT_NE(tree.find_path("objects.0.checksum"), nullptr);
  EXPECT_EQ(options.objects[0].rotation, 1.0);
  EXPECT_EQ(object_refusal("{type: mesh, fil: cup.stl, unit: 1 mm}"), "unknown option 'fil'");
}

TEST(SceneOptions, WithAnyOneEffectMakeTapsThatAreNotPerfect) {
  EffectOptions all;
  EXPECT_TRUE(all.values.empty());
  for (const FieldDescription& effect : describe_fields([&](Fields& fields) { all.list(fields); })) {
    EffectOptions options;
    ResolveNotes notes;
    resolve(options, parse_value("{" + effect.name + ": {}}", "effects"), shared_host(), notes);
    EXPECT_FALSE(options.values.empty()) << effect.name;
  }
}

}  // namespace
}  // namespace palpate::test
