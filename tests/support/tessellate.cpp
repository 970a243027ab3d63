// SPDX-License-Identifier: MIT
#include "support/tessellate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

constexpr double kFullTurn = 6.28318530717958647692;

/// Two triangles; those that a side of length 0 leaves without area are dropped.
void add_quad(Surface& out, std::size_t a, std::size_t b, std::size_t c, std::size_t d) {
  if (a != b && b != c && a != c) out.triangles.push_back({a, b, c});
  if (a != c && c != d && a != d) out.triangles.push_back({a, c, d});
}

template <class Number>
void append(std::string& out, Number value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

}  // namespace

double Surface::support(const Vector3d& direction) const {
  double best = -HUGE_VAL;
  for (const Vector3d& point : points) best = std::max(best, direction.dot(point));
  return best;
}

Surface turned(const std::vector<std::array<double, 2>>& profile, int sides) {
  Surface out;
  std::vector<std::size_t> begin;  // of each circle of points; one on the axis is alone
  for (const auto& [radius, height] : profile) {
    begin.push_back(out.points.size());
    for (int i = 0; i < (radius > 0.0 ? sides : 1); ++i) {
      const double angle = kFullTurn * i / sides;
      out.points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), height);
    }
  }
  const auto at = [&](std::size_t circle, int i) {
    return begin[circle] + (profile[circle][0] > 0.0 ? static_cast<std::size_t>(i % sides) : 0);
  };
  const bool closed = profile.front()[0] > 0.0;
  for (std::size_t k = 0; k + (closed ? 0 : 1) < profile.size(); ++k) {
    const std::size_t next = (k + 1) % profile.size();
    for (int i = 0; i < sides; ++i) add_quad(out, at(k, i), at(k, i + 1), at(next, i + 1), at(next, i));
  }
  return out;
}

Surface extruded(const std::function<double(double)>& top, double length, double width, int steps) {
  Surface out;
  for (int i = 0; i <= steps; ++i) {
    const double s = length * (static_cast<double>(i) / steps - 0.5);
    for (const double t : {-width / 2, width / 2}) {
      out.points.emplace_back(s, t, 0.0);
      out.points.emplace_back(s, t, top(s));
    }
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(steps); ++i) {
    const std::size_t a = 4 * i;
    const std::size_t b = a + 4;
    add_quad(out, a, a + 2, b + 2, b);          // bottom
    add_quad(out, a + 1, b + 1, b + 3, a + 3);  // top
    add_quad(out, a, b, b + 1, a + 1);
    add_quad(out, a + 2, a + 3, b + 3, b + 2);
  }
  const std::size_t last = 4 * static_cast<std::size_t>(steps);
  add_quad(out, 0, 1, 3, 2);
  add_quad(out, last, last + 2, last + 3, last + 1);
  return out;
}

Surface raised(const std::vector<double>& s, const std::vector<double>& t,
               const std::function<bool(double, double)>& inside, double height) {
  Surface out;
  std::map<std::array<std::size_t, 3>, std::size_t> known;
  const auto point = [&](std::size_t i, std::size_t j, std::size_t upper) {
    const auto [found, added] = known.try_emplace({i, j, upper}, out.points.size());
    if (added) out.points.emplace_back(s[i], t[j], upper == 1 ? height : 0.0);
    return found->second;
  };
  const auto full = [&](std::size_t i, std::size_t j) {
    return i < s.size() - 1 && j < t.size() - 1 && inside((s[i] + s[i + 1]) / 2, (t[j] + t[j + 1]) / 2);
  };
  const auto wall = [&](std::size_t i, std::size_t j, std::size_t k, std::size_t l) {
    add_quad(out, point(i, j, 0), point(k, l, 0), point(k, l, 1), point(i, j, 1));
  };
  for (std::size_t i = 0; i < s.size(); ++i) {
    for (std::size_t j = 0; j < t.size(); ++j) {
      const bool here = full(i, j);
      // Indices that pass below 0 wrap to huge numbers, beyond the last cell.
      if (here != full(i - 1, j)) wall(i, j, i, j + 1);
      if (here != full(i, j - 1)) wall(i, j, i + 1, j);
      for (std::size_t upper : {0, 1}) {
        if (here)
          add_quad(out, point(i, j, upper), point(i + 1, j, upper), point(i + 1, j + 1, upper), point(i, j + 1, upper));
      }
    }
  }
  return out;
}

std::string stl_text(const Surface& surface) {
  std::string out = "solid test\n";
  for (const auto& triangle : surface.triangles) {
    out += "facet normal 0 0 0\n outer loop\n";
    for (const std::size_t corner : triangle) {
      const Vector3d p = 1e3 * surface.points[corner];
      out += fmt::format("  vertex {:.9g} {:.9g} {:.9g}\n", p.x(), p.y(), p.z());
    }
    out += " endloop\nendfacet\n";
  }
  return out + "endsolid test\n";
}

std::string stl_binary(const Surface& surface) {
  std::string out(80, ' ');
  append(out, static_cast<std::uint32_t>(surface.triangles.size()));
  for (const auto& triangle : surface.triangles) {
    for (int i = 0; i < 3; ++i) append(out, 0.0F);
    for (const std::size_t corner : triangle) {
      for (Eigen::Index k = 0; k < 3; ++k) append(out, static_cast<float>(1e3 * surface.points[corner](k)));
    }
    append(out, std::uint16_t{0});
  }
  return out;
}

std::string obj(const Surface& surface) {
  std::string out = "mtllib not_there.mtl\nusemtl red\n";
  for (const Vector3d& p : surface.points)
    out += fmt::format("v {:.9g} {:.9g} {:.9g}\n", 1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z());
  for (const auto& [a, b, c] : surface.triangles) out += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
  return out;
}

std::string ply(const Surface& surface) {
  std::string out = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      surface.points.size(), surface.triangles.size());
  for (const Vector3d& p : surface.points)
    out += fmt::format("{:.9g} {:.9g} {:.9g}\n", 1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z());
  for (const auto& [a, b, c] : surface.triangles) out += fmt::format("3 {} {} {}\n", a, b, c);
  return out;
}

}  // namespace palpate::test
