// SPDX-License-Identifier: MIT
#include "record/mesh_ply.hpp"

#include <fmt/format.h>

#include <array>

namespace palpate {

std::string mesh_ply(const Surface& mesh, const std::string& deviation, const std::string& comment) {
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment {}, of cubes of {:.3g} mm\nelement vertex {}\nproperty float "
      "x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float {}\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      comment, 1e3 * mesh.resolution, mesh.vertices.size(), deviation, mesh.triangles.size());
  const auto append = [&](const auto& value) {
    out.append(reinterpret_cast<const char*>(value.data()), sizeof(value[0]) * value.size());
  };
  out.reserve(out.size() + 28 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const Surface::Vertex& one : mesh.vertices) {
    Eigen::Matrix<float, 7, 1> numbers;
    numbers << one.position.cast<float>(), one.normal.cast<float>(), static_cast<float>(one.standard_deviation);
    append(numbers);
  }
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    out += '\3';
    append(triangle);
  }
  return out;
}

}  // namespace palpate
