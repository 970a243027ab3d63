// SPDX-License-Identifier: MIT
// The shape `height_map`: where lines meet it against its triangles one by one, and its files.
#include "support/testing.hpp"

#include <palpate/shape.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;
using testing::StartsWith;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnit = 1e-6;
constexpr double kSpacing = 0.01;

using Rows = std::vector<std::vector<int>>;

/// What tests/data/heights holds, the far row first.
const Rows kRows{{0, 0, 0, 0, 0, 0, 0},
                 {0, 0, 1000, 2000, 1500, 0, 0},
                 {0, 500, 3000, 40000, 2500, 0, 0},
                 {0, 0, 2500, 30000, 65535, 800, 0},
                 {0, 0, 0, 700, 900, 0, 0},
                 {0, 0, 0, 0, 0, 0, 0}};

class HeightMapShape : public InFolder {
 protected:
  static std::shared_ptr<const Shape> of_file(const fs::path& file, double unit = kUnit) {
    return make<const Shape>(shared_host(), "height_map",
                             fmt::format("{{file: '{}', unit: {} m, spacing: 1 cm}}", file.string(), unit));
  }
  std::shared_ptr<const Shape> of(const std::string& name, const std::string& bytes) const {
    return of_file(folder_.write(name, bytes));
  }
  std::string refusal(const std::string& name, const std::string& bytes) const {
    return error_of([&] { of(name, bytes); });
  }
  /// Without libpng a build has no images.
  static bool reads_png() {
    return error_of([&] { of_file(data("map_16.png")); }).find("which this build cannot read") == std::string::npos;
  }
  static fs::path data(const char* name) { return source_folder() / "tests/data/heights" / name; }
};

struct Triangle {
  Vector3d a, b, c;
};

/// The solid's surface: two triangles a cell above, two below, and the walls, which are flat here because the map ends
/// in zeros.
std::vector<Triangle> triangles_of(const Rows& rows) {
  std::vector<Triangle> out;
  const int height = static_cast<int>(rows.size());
  const int width = static_cast<int>(rows.front().size());
  const auto node = [&](int column, int row, bool top) {
    const double z =
        top ? kUnit * rows[static_cast<std::size_t>(height - 1 - row)][static_cast<std::size_t>(column)] : 0;
    return Vector3d(kSpacing * (column - (width - 1) / 2.0), kSpacing * (row - (height - 1) / 2.0), z);
  };
  for (int row = 0; row + 1 < height; ++row) {
    for (int column = 0; column + 1 < width; ++column) {
      for (const bool top : {true, false}) {
        out.push_back({node(column, row, top), node(column + 1, row, top), node(column, row + 1, top)});
        out.push_back({node(column + 1, row + 1, top), node(column, row + 1, top), node(column + 1, row, top)});
      }
    }
  }
  return out;
}

/// Distances at which the line meets triangles (Moeller and Trumbore 1997).
std::vector<double> meetings(const std::vector<Triangle>& triangles, const Line& line) {
  std::vector<double> out;
  for (const auto& [a, b, c] : triangles) {
    const Vector3d ab = b - a;
    const Vector3d ac = c - a;
    const Vector3d p = line.direction.cross(ac);
    const double determinant = ab.dot(p);
    if (std::abs(determinant) < 1e-15) continue;
    const Vector3d from = line.origin - a;
    const double u = from.dot(p) / determinant;
    const Vector3d q = from.cross(ab);
    const double v = line.direction.dot(q) / determinant;
    if (u >= 0 && v >= 0 && u + v <= 1) out.push_back(ac.dot(q) / determinant);
  }
  std::sort(out.begin(), out.end());
  return out;
}

TEST_F(HeightMapShape, IsMetWhereItsTrianglesAre) {
  const auto shape = of_file(data("map.csv"));
  const std::vector<Triangle> triangles = triangles_of(kRows);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> within(-0.03, 0.03);
  int met = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vector3d through(within(random), within(random), 0.02 + within(random));
    const Vector3d along = Vector3d(normal(random), normal(random), normal(random)).normalized();
    const Line line{through - 0.5 * along, along};
    const std::vector<double> expected = meetings(triangles, line);
    // Where the map is 0 top and bottom coincide: no solid lies between them.
    std::vector<double> ends;
    for (std::size_t at = 0; at + 1 < expected.size(); at += 2) {
      if (expected[at + 1] - expected[at] > 1e-9) ends.insert(ends.end(), {expected[at], expected[at + 1]});
    }
    const std::vector<LineInterval> intervals = shape->intervals(line);
    ASSERT_EQ(2 * intervals.size(), ends.size()) << i;
    for (std::size_t k = 0; k < intervals.size(); ++k) {
      EXPECT_NEAR(intervals[k].begin, ends[2 * k], 1e-9) << i;
      EXPECT_NEAR(intervals[k].end, ends[2 * k + 1], 1e-9) << i;
    }
    const double hit = shape->first_intersection(line);
    EXPECT_TRUE(ends.empty() ? hit == kInfinity : std::abs(hit - ends[0]) < 1e-9) << i << ": " << hit;
    met += ends.empty() ? 0 : 1;
  }
  EXPECT_GT(met, 1000);
}

TEST_F(HeightMapShape, HasTheHeightsOfItsNodesWithTheFirstRowAtTheFarSide) {
  const auto shape = of_file(data("map.csv"));
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 7; ++column) {
      const int value = kRows[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
      const double there = shape->top(kSpacing * (column - 3), kSpacing * (2.5 - row));
      EXPECT_TRUE(value > 0 ? std::abs(there - kUnit * value) < 1e-12 : there < 1e-12) << row << ", " << column;
    }
  }
  EXPECT_NEAR(shape->support({0, 0, 1}), kUnit * 65535, 1e-12);
}

TEST_F(HeightMapShape, LeavesOutZerosAroundTheObject) {
  const auto shape = of("wide.csv", "0,0,0,0,0\n0,0,0,0,0\n0,0,9000,0,0\n0,0,0,0,0\n0,0,0,0,0\n0,0,0,0,0\n");
  EXPECT_NEAR(shape->support({1, 0, 0}), kSpacing, 1e-12);
  EXPECT_NEAR(shape->support({0, 1, 0}), kSpacing, 1e-12);
  EXPECT_NEAR(shape->top(0, 0), 0.009, 1e-12) << "the object's middle is the origin";
}

TEST_F(HeightMapShape, HasWallsWhereTheMapEnds) {
  const auto shape = of("block.csv", "20000,20000\n20000,20000\n");
  EXPECT_NEAR(shape->first_intersection({{-1, 0, 0.01}, {1, 0, 0}}), 1 - kSpacing / 2, 1e-12);
  EXPECT_EQ(shape->first_intersection({{-1, 0, 0.021}, {1, 0, 0}}), kInfinity);
  EXPECT_NEAR(shape->top(0.0049, -0.0049), 0.02, 1e-12);
  EXPECT_EQ(shape->top(0.0051, 0), -kInfinity);
}

/// An array as NumPy saves it.
std::string npy(const std::string& type, bool by_columns, const Rows& rows, const std::string& shape = "") {
  std::string header =
      fmt::format("{{'descr': '{}', 'fortran_order': {}, 'shape': ({}), }}", type, by_columns ? "True" : "False",
                  shape.empty() ? fmt::format("{}, {}", rows.size(), rows.front().size()) : shape);
  header.resize(118 - 10, ' ');
  header += '\n';
  std::string out = std::string("\x93NUMPY\1\0", 8);
  out += static_cast<char>(header.size());
  out += '\0';
  out += header;
  const auto put = [&](int value) {
    const auto add = [&](auto number) { out.append(reinterpret_cast<const char*>(&number), sizeof number); };
    if (type == "<f8") add(static_cast<double>(value));
    if (type == "<f4") add(static_cast<float>(value));
    if (type == "<u2") add(static_cast<std::uint16_t>(value));
    if (type == "<i8") add(static_cast<std::int64_t>(value));
  };
  for (std::size_t i = 0; i < rows.size() * rows.front().size(); ++i)
    put(by_columns ? rows[i % rows.size()][i / rows.size()] : rows[i / rows.front().size()][i % rows.front().size()]);
  return out;
}

TEST_F(HeightMapShape, IsTheSameFromEveryFormat) {
  const auto expected = of_file(data("map.csv"));
  const auto check = [&](const std::shared_ptr<const Shape>& shape, double precision, const std::string& what) {
    for (double x = -0.0275; x < 0.03; x += 0.005) {
      for (double y = -0.0225; y < 0.025; y += 0.005)
        EXPECT_NEAR(std::max(0.0, shape->top(x, y)), std::max(0.0, expected->top(x, y)), precision) << what;
    }
  };
  for (const char* type : {"<f8", "<f4", "<u2", "<i8"}) {
    for (const bool by_columns : {false, true}) check(of("map.npy", npy(type, by_columns, kRows)), 1e-12, type);
  }
  std::string table = "\xef\xbb\xbf";
  for (const auto& row : kRows) table += fmt::format(" {} \r\n", fmt::join(row, " , "));
  check(of("map.csv", table + "\r\n \r\n"), 1e-12, "a table with blanks");
  if (!reads_png()) return;
  check(of_file(data("map_16.png")), 1e-12, "16 bits");
  check(of_file(data("map_8.png"), 256 * kUnit), 256 * kUnit, "8 bits");
}

TEST_F(HeightMapShape, ThatIsNoneIsRefusedWithWhatIsWrong) {
  EXPECT_THAT(refusal("a.csv", "1,2\n3\n"), HasSubstr("a.csv:2: has 1 values, the first row has 2"));
  EXPECT_THAT(refusal("a.csv", "x,y\n1,2\n"),
              HasSubstr("a.csv:1: 'x' is not a number, write one row of numbers per line"));
  EXPECT_THAT(refusal("a.csv", "1,2\n\n3,4\n"), HasSubstr("a.csv:2: '' is not a number"));
  EXPECT_THAT(refusal("a.csv", "1,2\n3,-4\n"), HasSubstr("a.csv: row 2, column 2 is -4, but a height is at least 0"));
  EXPECT_THAT(refusal("a.csv", "1,nan\n3,4\n"), HasSubstr("row 1, column 2 is nan"));
  EXPECT_THAT(refusal("a.csv", "0,0\n0,0\n"), HasSubstr("is 0 everywhere"));
  EXPECT_THAT(refusal("a.csv", "1,2,3\n"),
              HasSubstr("has 1 x 3 values, but must have between 2 x 2 and 4000000 in all"));
  EXPECT_THAT(refusal("a.csv", "3000000,3000000\n1,1\n"),
              HasSubstr("m large, at most 2 m are allowed, check unit and"));
  EXPECT_THAT(refusal("a.txt", "1,2\n3,4\n"), HasSubstr("has no supported file extension"));
  const std::string whole = npy("<f8", false, kRows);
  for (std::size_t length = 1; length < whole.size(); length += 7)
    EXPECT_NE(refusal("a.npy", whole.substr(0, length)), "") << length;
  EXPECT_THAT(refusal("a.npy", npy("<f8", false, kRows, "42,")), HasSubstr("does not have two dimensions"));
  EXPECT_THAT(refusal("a.npy", npy("<f8", false, kRows, "999999999, 999999999")),
              HasSubstr("but must have between 2 x 2 and 4000000 in all"));
  EXPECT_THAT(refusal("a.npy", npy(">f8", false, kRows)), HasSubstr("has values of an unsupported type"));
  if (!reads_png()) return;
  const std::string image = text_of(data("map_16.png"));
  for (std::size_t length = 1; length + 12 < image.size(); length += 3)
    EXPECT_THAT(refusal("a.png", image.substr(0, length)), HasSubstr("a.png: cannot be read as PNG: ")) << length;
}

}  // namespace
}  // namespace palpate::test
