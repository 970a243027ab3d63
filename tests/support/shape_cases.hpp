// SPDX-License-Identifier: MIT
// Every primitive three times, from its definition: as it is written in a config, as a set of points, and as triangles.
#pragma once

#include "scene/scene_options.hpp"
#include "support/tessellate.hpp"

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

namespace palpate::test {

struct ShapeCase {
  std::string name;
  std::string options;  ///< of the object, as a YAML map
  /// Whether a point of the shape's frame lies in the solid blown up by `slack` metres, or shrunk for a negative one.
  std::function<bool(const Eigen::Vector3d& point, double slack)> inside;
  std::function<Surface()> build;

  /// Within 3e-6 m; built when it is first asked for, because that takes long.
  const Surface& surface() const;
};

inline void PrintTo(const ShapeCase& one, std::ostream* out) { *out << one.options; }

const std::vector<ShapeCase>& shape_cases();

/// A scene of 40 by 40 cm with these objects, each a YAML map.
std::unique_ptr<const Scene> scene_of(const std::vector<std::string>& objects, std::uint64_t seed = 1,
                                      const std::string& more = "");

/// `options` with more fields: "{a: 1}" and "b: 2" make "{a: 1, b: 2}".
std::string with_fields(const std::string& options, const std::string& more);

}  // namespace palpate::test
