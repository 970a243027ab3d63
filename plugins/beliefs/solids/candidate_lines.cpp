// SPDX-License-Identifier: MIT
#include "solids/candidate_lines.hpp"

#include <palpate/error.hpp>
#include <palpate/math.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;

/// Sine of the steepest upward direction: tools move down, level, or up by at most 30 degrees.
constexpr double kSteepestUp = 0.5;

/// Returns a uniformly drawn line with a direction in which a tool may move.
Line random_line(const SearchBall& region, Random& random) {
  while (true) {
    const double z = -1.0 + (1.0 + kSteepestUp) * random.uniform();
    const double angle = 2.0 * kHalfTurn * random.uniform();
    const double level = std::sqrt(1.0 - z * z);
    const Vector3d direction(level * math::cos(angle), level * math::sin(angle), z);
    const double away = region.radius * std::sqrt(random.uniform());
    const double turn = 2.0 * kHalfTurn * random.uniform();
    const Vector3d aside = direction.unitOrthogonal();
    const Vector3d nearest =
        region.centre + away * (math::cos(turn) * aside + math::sin(turn) * direction.cross(aside));
    const double back = std::sqrt(region.outside() * region.outside() - away * away);
    Line out{nearest - back * direction, direction};
    if (out.origin.z() > 0.0) return out;
  }
}

/// Returns the line along the surface normal at the point where a random line meets the surface; nullopt if it misses.
std::optional<Line> along_normal(const SearchBall& region, const Assembly& surface, Random& random) {
  const Line line = random_line(region, random);
  const double hit = surface.first_intersection(line);
  if (hit >= distance_down_to(0.0, line)) return std::nullopt;
  const Vector3d at = line.origin + hit * line.direction;
  const Vector3d inwards = -surface.normal(at);
  if (inwards.z() > kSteepestUp) return std::nullopt;
  const double towards = (region.centre - at).dot(inwards);
  const double aside = (region.centre - at).squaredNorm() - towards * towards;
  const double back = std::sqrt(std::max(0.0, region.outside() * region.outside() - aside)) - towards;
  Line out{at - back * inwards, inwards};
  return out.origin.z() > 0.0 ? std::optional(out) : std::nullopt;
}

/// Appends the lines of `from` for which `accepted` is true.
void append(const Candidates& from, const Eigen::Array<bool, Eigen::Dynamic, 1>& accepted,
            const std::vector<bool>& anywhere, SampledLines& out) {
  Candidates& to = out.lines;
  for (Eigen::Index i = 0; i < from.size(); ++i) {
    if (!accepted(i)) continue;
    const auto row = static_cast<Eigen::Index>(out.anywhere.size());
    to.starts.row(row) = from.starts.row(i);
    to.directions.row(row) = from.directions.row(i);
    out.anywhere.push_back(anywhere[static_cast<std::size_t>(i)]);
  }
}

}  // namespace

SearchBall::SearchBall(const Area& area) {
  constexpr double kShare = 0.46;  // radius as a share of the longer side, along which objects may be anywhere
  constexpr double kHeight = 0.65;
  radius = kShare * std::max(area.width, area.depth);
  centre = {area.width / 2, area.depth / 2, kHeight * radius};
}

SampledLines sample_lines(const SearchBall& region, double desk, std::size_t count, const Assembly* surface,
                          Random& random, const LineFilter& filter) {
  constexpr std::size_t kTries = 20;
  SampledLines out;
  out.lines.fixed = false;
  out.lines.lengths = Eigen::VectorXd::Constant(1, 2.0 * region.outside());
  out.lines.starts.resize(static_cast<Eigen::Index>(count), 3);
  out.lines.directions.resize(static_cast<Eigen::Index>(count), 3);
  for (std::size_t tries = 0; out.anywhere.size() < count;) {
    if (tries >= kTries * count)
      throw Error("backend", "rejects every tap from any side that was tried",
                  "use belief=height_map for an arm that taps from above");
    const std::size_t batch = count - out.anywhere.size();
    Candidates drawn;
    drawn.lengths = out.lines.lengths;
    drawn.fixed = false;
    drawn.starts.resize(static_cast<Eigen::Index>(batch), 3);
    drawn.directions.resize(static_cast<Eigen::Index>(batch), 3);
    std::vector<bool> anywhere(batch);
    auto balance = 2 * std::count(out.anywhere.begin(), out.anywhere.end(), true) -
                   static_cast<std::ptrdiff_t>(out.anywhere.size());
    for (std::size_t i = 0; i < batch; ++i) {
      std::optional<Line> line;
      anywhere[i] = balance <= 0;
      balance += anywhere[i] ? 1 : -1;
      if (surface != nullptr && !anywhere[i]) line = along_normal(region, *surface, random);
      if (!line) line = random_line(region, random);
      drawn.starts.row(static_cast<Eigen::Index>(i)) = line->origin + Vector3d(0.0, 0.0, desk);
      drawn.directions.row(static_cast<Eigen::Index>(i)) = line->direction;
    }
    Eigen::Array<bool, Eigen::Dynamic, 1> accepted(drawn.size());
    accepted.setConstant(true);
    filter(drawn, accepted);
    append(drawn, accepted, anywhere, out);
    tries += batch;
  }
  return out;
}

}  // namespace palpate
