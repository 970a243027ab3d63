// SPDX-License-Identifier: MIT
#include "support/shape_cases.hpp"

#include "support/filled.hpp"

#include <cmath>
#include <map>

namespace palpate::test {
namespace {

using Eigen::Vector3d;
using Profile = std::vector<std::array<double, 2>>;

constexpr double kPi = 3.14159265358979323846;
constexpr int kSides = 360;

bool within(double value, double low, double high, double slack) {
  return value >= low - slack && value <= high + slack;
}

/// From the rim at `from` to the axis at `to`, angles of a circle around (0, centre).
Profile arc(double radius, double centre, double from, double to, int steps) {
  Profile out;
  for (int i = 0; i < steps; ++i) {
    const double angle = from + (to - from) * i / steps;
    out.push_back({radius * std::cos(angle), centre + radius * std::sin(angle)});
  }
  return out;
}

/// A top that is a function of the place along the length, of so many steps; `steep` bounds its slope.
ShapeCase prism(const std::string& name, const std::string& options, double length, double width,
                const std::function<double(double)>& top, double steep, int steps) {
  return {name, options,
          [=](const Vector3d& p, double slack) {
            return within(p.x(), -length / 2, length / 2, slack) && within(p.y(), -width / 2, width / 2, slack) &&
                   within(p.z(), 0, top(p.x()), steep * slack);
          },
          [=] { return extruded(top, length, width, steps); }};
}

ShapeCase dome() {
  const double r = (0.05 * 0.05 + 0.03 * 0.03) / (2 * 0.03);  // of the ball
  Profile profile{{0, 0}};
  for (const auto& point : arc(r, 0.03 - r, std::asin((r - 0.03) / r), kPi / 2, 120)) profile.push_back(point);
  profile.push_back({0, 0.03});
  return {"dome", "{type: dome, diameter: 10 cm, height: 3 cm}",
          [r](const Vector3d& p, double slack) {
            return within(p.z(), 0, 0.03, slack) && (p - Vector3d(0, 0, 0.03 - r)).norm() <= r + slack;
          },
          [profile] { return turned(profile, kSides); }};
}

ShapeCase cylinder() {
  return {"cylinder", "{type: cylinder, diameter: 6 cm, height: 4 cm}",
          [](const Vector3d& p, double slack) {
            return within(p.z(), 0, 0.04, slack) && std::hypot(p.x(), p.y()) <= 0.03 + slack;
          },
          [] {
            return turned({{0, 0}, {0.03, 0}, {0.03, 0.04}, {0, 0.04}}, kSides);
          }};
}

ShapeCase cone() {
  return {"cone", "{type: cone, diameter: 8 cm, height: 5 cm}",
          [](const Vector3d& p, double slack) {
            return within(p.z(), 0, 0.05, slack) && std::hypot(p.x(), p.y()) <= 0.04 * (1 - p.z() / 0.05) + 2 * slack;
          },
          [] {
            return turned({{0, 0}, {0.04, 0}, {0, 0.05}}, kSides);
          }};
}

ShapeCase ellipsoid() {
  const auto build = [] {
    Profile profile{{0, 0}};
    for (const auto& point : arc(1, 1, -kPi / 2, kPi / 2, 250)) profile.push_back(point);
    profile.erase(profile.begin() + 1);
    profile.push_back({0, 2});
    Surface surface = turned(profile, kSides);
    for (Vector3d& point : surface.points) point = point.cwiseProduct(Vector3d(0.05, 0.03, 0.02));
    return surface;
  };
  return {"ellipsoid", "{type: ellipsoid, length: 10 cm, width: 6 cm, height: 4 cm}",
          [](const Vector3d& p, double slack) {
            return (p - Vector3d(0, 0, 0.02)).cwiseQuotient(Vector3d(0.05, 0.03, 0.02)).norm() <= 1 + slack / 0.02;
          },
          build};
}

ShapeCase ring() {
  return {"ring", "{type: ring, outer: 10 cm, inner: 6 cm, height: 2 cm}",
          [](const Vector3d& p, double slack) {
            const double radius = std::hypot(p.x(), p.y());
            return within(p.z(), 0, 0.02, slack) && within(radius, 0.03, 0.05, slack);
          },
          [] {
            return turned({{0.03, 0}, {0.05, 0}, {0.05, 0.02}, {0.03, 0.02}}, kSides);
          }};
}

/// A union of rectangles {left, right, low, high}, less a rectangle.
ShapeCase bars(const std::string& name, const std::string& options, const std::vector<std::array<double, 4>>& parts,
               const std::array<double, 4>& hole, const std::vector<double>& s, const std::vector<double>& t,
               double height) {
  const auto flat = [parts, hole](double x, double y, double slack) {
    const auto in = [&](const std::array<double, 4>& r, double by) {
      return within(x, r[0], r[1], by) && within(y, r[2], r[3], by);
    };
    bool any = false;
    for (const auto& part : parts) any = any || in(part, slack);
    return any && !in(hole, -slack);
  };
  return {name, options,
          [flat, height](const Vector3d& p, double slack) {
            return within(p.z(), 0, height, slack) && flat(p.x(), p.y(), slack);
          },
          [flat, s, t, height] {
            return raised(
                s, t, [flat](double x, double y) { return flat(x, y, 0.0); }, height);
          }};
}

constexpr std::array<double, 4> kNoHole{1, -1, 1, -1};

}  // namespace

const std::vector<ShapeCase>& shape_cases() {
  static const std::vector<ShapeCase> cases{
      prism(
          "wave", "{type: wave, length: 9 cm, width: 5 cm, height: 3 cm, amplitude: 8 mm, period: 25 mm}", 0.09, 0.05,
          [](double s) { return 0.03 + 0.008 * std::cos(2 * kPi * s / 0.025); }, 3, 4000),
      prism(
          "slope", "{type: slope, length: 8 cm, width: 4 cm, low: 1 cm, high: 5 cm}", 0.08, 0.04,
          [](double s) { return 0.03 + 0.02 * s / 0.04; }, 2, 1),
      dome(), cylinder(), cone(), ellipsoid(), ring(),
      bars("block", "{type: block, length: 8 cm, width: 5 cm, height: 3 cm}", {{-0.04, 0.04, -0.025, 0.025}}, kNoHole,
           {-0.04, 0.04}, {-0.025, 0.025}, 0.03),
      bars("l", "{type: l, length: 10 cm, width: 8 cm, thickness: 3 cm, height: 4 cm}",
           {{-0.05, 0.05, -0.04, -0.01}, {-0.05, -0.02, -0.04, 0.04}}, kNoHole, {-0.05, -0.02, 0.05},
           {-0.04, -0.01, 0.04}, 0.04),
      bars("t", "{type: t, length: 10 cm, width: 8 cm, thickness: 2 cm, height: 3 cm}",
           {{-0.05, 0.05, 0.02, 0.04}, {-0.01, 0.01, -0.04, 0.04}}, kNoHole, {-0.05, -0.01, 0.01, 0.05},
           {-0.04, 0.02, 0.04}, 0.03),
      // The same as the l, of two parts that overlap, not centred, and one of them turned.
      bars("compound",
           "{type: compound, parts: [{type: block, length: 10 cm, width: 3 cm, height: 4 cm, at: [7 cm, 2 cm]}, {type: "
           "block, length: 8 cm, width: 3 cm, height: 4 cm, at: [35 mm, 45 mm], rotation: 90 deg}]}",
           {{-0.05, 0.05, -0.04, -0.01}, {-0.05, -0.02, -0.04, 0.04}}, kNoHole, {-0.05, -0.02, 0.05},
           {-0.04, -0.01, 0.04}, 0.04),
      // Anticlockwise outline, clockwise hole, a corner in the middle of an edge, and a rectangle that is not centred.
      bars("polygon",
           "{type: polygon, height: 25 mm, outline: [[1 cm, 2 cm], [9 cm, 2 cm], [9 cm, 4 cm], [9 cm, 8 cm], [1 cm, 8 "
           "cm]], "
           "hole: [[3 cm, 3 cm], [3 cm, 6 cm], [8 cm, 6 cm], [8 cm, 3 cm]]}",
           {{-0.04, 0.04, -0.03, 0.03}}, {-0.02, 0.03, -0.02, 0.01}, {-0.04, -0.02, 0.03, 0.04},
           {-0.03, -0.02, 0.01, 0.03}, 0.025)};
  return cases;
}

const Surface& ShapeCase::surface() const {
  static std::map<std::string, Surface> built;
  const auto found = built.find(name);
  return found != built.end() ? found->second : built.emplace(name, build()).first->second;
}

std::unique_ptr<const Scene> scene_of(const std::vector<std::string>& objects, std::uint64_t seed,
                                      const std::string& more) {
  std::string yaml = "{area: {width: 40 cm, depth: 40 cm}, objects: [";
  for (const std::string& object : objects) yaml += object + ", ";
  yaml += "]" + more + "}";
  return build_scene(filled<SceneOptions>(yaml), seed, shared_host());
}

std::string with_fields(const std::string& options, const std::string& more) {
  return more.empty() ? options : options.substr(0, options.size() - 1) + ", " + more + "}";
}

}  // namespace palpate::test
