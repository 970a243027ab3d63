// SPDX-License-Identifier: MIT
// The laws of shape.hpp, over every shape found that can be made without further options, and over the others.
#include "support/shape_laws.hpp"
#include "support/testing.hpp"

#include <ostream>

namespace palpate::test {
namespace {

struct PluginCase {
  std::string name;
  std::string type;
  std::string options;
};

void PrintTo(const PluginCase& one, std::ostream* out) { *out << one.type << " " << one.options; }

std::vector<PluginCase> plugin_cases() {
  const std::string cup = "file: '" + (source_folder() / "configs/scene/meshes/cup.stl").string() + "'";
  std::vector<PluginCase> out{
      {"mesh", "mesh", "{" + cup + ", unit: 1 mm}"},
      {"mesh_on_its_side", "mesh", "{" + cup + ", unit: 0.4 mm, up: y}"},
      {"height_map", "height_map",
       "{file: '" + (source_folder() / "tests/data/heights/map.csv").string() + "', unit: 1 um, spacing: 1 cm}"},
      {"polygon", "polygon", "{outline: [[0 cm, 0 cm], [9 cm, 1 cm], [3 cm, 3 cm], [2 cm, 8 cm]]}"},
      {"compound", "compound",
       "{parts: [{type: dome, at: [3 cm, 1 cm]}, {type: ring, at: [-5 cm, 0 cm]}, {type: slope, rotation: 20 deg}]}"}};
  for (const std::string& name : plugins_under_contract("shape")) out.push_back({test_name(name), name, "{}"});
  return out;
}

class ShapeContract : public testing::TestWithParam<PluginCase> {};

TEST_P(ShapeContract, KeepsTheLawsOfShapes) {
  check_shape_laws(*make<Shape>(contract_host(), GetParam().type, GetParam().options));
}

INSTANTIATE_TEST_SUITE_P(Every, ShapeContract, testing::ValuesIn(plugin_cases()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace palpate::test
