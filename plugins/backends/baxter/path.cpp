// SPDX-License-Identifier: MIT
#include "baxter/path.hpp"

#include "baxter/error_texts.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::baxter {
namespace {

/// Distance in metres between inverse kinematics solutions on a path. Between the solutions, interpolation deviates
/// from the path by less than 0.1 mm.
constexpr double kColumnStep = 0.005;
constexpr double kLineStep = 0.01;
/// Largest rotation of the hand in rad between two solutions on a line.
constexpr double kTurnStep = 0.05;
/// Largest rotation of a joint in rad between two solutions, several times the usual value within reach. A larger
/// rotation means that the arm switches to another posture or is near a singular one.
constexpr double kJump = 0.15;

std::string place_text(const Pose& pose) {
  const Eigen::Vector3d at = 100 * pose.position;
  return fmt::format("({:.1f}, {:.1f}, {:.1f}) cm of base", at.x(), at.y(), at.z());
}

int steps(double length, double step) { return std::max(1, static_cast<int>(std::ceil(length / step - 1e-9))); }

}  // namespace

void Path::add(const Joints& joints, double distance) {
  at_.push_back(joints_.empty() ? 0.0 : at_.back() + distance);
  joints_.push_back(joints);
}

/// Returns the index of the end point of the segment that contains `distance`.
std::size_t Path::segment(double distance) const {
  const auto after = std::upper_bound(at_.begin(), at_.end(), distance);
  const auto index = static_cast<std::size_t>(after - at_.begin());
  return std::clamp<std::size_t>(index, 1, at_.size() - 1);
}

/// Returns the largest rotation of a joint per metre in a segment, rad/m.
double Path::slope(std::size_t segment) const {
  const Joints turn = joints_[segment] - joints_[segment - 1];
  return turn.cwiseAbs().maxCoeff() / (at_[segment] - at_[segment - 1]);
}

Joints Path::at(double distance) const {
  if (at_.size() == 1 || distance <= 0.0) return joints_.front();
  if (distance >= at_.back()) return joints_.back();
  const std::size_t i = segment(distance);
  const double share = (distance - at_[i - 1]) / (at_[i] - at_[i - 1]);
  return (1.0 - share) * joints_[i - 1] + share * joints_[i];
}

double Path::advance(double distance, double speed, double seconds) const {
  if (distance >= length()) return length();
  const double turn = slope(segment(distance));
  const double fastest = turn > 0.0 ? std::min(speed, kJointSpeed / turn) : speed;
  return std::min(length(), distance + fastest * seconds);
}

Path Path::back(double distance) const {
  Path out;
  const double from = std::clamp(distance, 0.0, length());
  out.add(at(from), 0.0);
  double last = from;
  for (std::size_t i = at_.size(); i-- > 0;) {
    if (at_[i] >= last) continue;
    out.add(joints_[i], last - at_[i]);
    last = at_[i];
  }
  return out;
}

double Path::steepest() const {
  double out = 0.0;
  for (std::size_t i = 1; i < at_.size(); ++i) out = std::max(out, slope(i));
  return out;
}

Joints Planner::solve(const Pose& tip, const Joints& seed, const char* what) const {
  const std::optional<Joints> found = inverse_(tip, seed);
  if (!found) throw NoPath{"no joint position within the limits puts the tool upright at " + place_text(tip)};
  if (what != nullptr && (*found - seed).cwiseAbs().maxCoeff() > kJump)
    throw NoPath{std::string("the joints would jump ") + what + " at " + place_text(tip)};
  return *found;
}

Path Planner::vertical(const Joints& from, Pose tip, double rise, const char* way) const {
  Path out;
  out.add(from, 0.0);
  const double start = tip.position.z();
  const int count = rise != 0.0 ? steps(std::abs(rise), kColumnStep) : 0;
  for (int i = 1; i <= count; ++i) {
    tip.position.z() = start + rise * i / count;
    out.add(solve(tip, out.end(), way), std::abs(rise) / count);
  }
  return out;
}

Path Planner::column(const Target& place, const Target& middle, double hover, double floor, double speed) const {
  const Joints seed = solve(pose(middle, hover), untucked(), nullptr);
  const Pose top = pose(place, hover);
  Path out = vertical(solve(top, seed, nullptr), top, floor - hover, "on the way down");
  if (out.steepest() * speed > kJointSpeed)
    throw NoPath{"a joint would have to turn faster than 0.4 rad/s on the way down to " +
                 place_text(pose(place, floor)) + " at the speed of the motion: lower it"};
  return out;
}

Path Planner::line(const Joints& from, const Joints& to) const {
  const Pose start = arm_.tip(from);
  const Pose end = arm_.tip(to);
  const double length = (end.position - start.position).norm();
  const double turn = start.rotation.angularDistance(end.rotation);
  const double posture = (to - from).cwiseAbs().maxCoeff();
  const int count = std::max({steps(length, kLineStep), steps(turn, kTurnStep), steps(posture, kTurnStep)});
  // A rotation on the spot takes as long as a translation by the angle times a lever of 20 cm.
  const double step = std::max({length, 0.2 * turn, 0.2 * posture}) / count;
  Path out;
  out.add(from, 0.0);
  if (!(step > 0.0)) return out;
  Joints last = from;
  for (int i = 1; i <= count; ++i) {
    const double share = static_cast<double>(i) / count;
    const Pose between{(1.0 - share) * start.position + share * end.position,
                       start.rotation.slerp(share, end.rotation)};
    // The seed is interpolated between both ends, so that the path does not end in another posture with the same tip.
    const Joints joints = i == count ? to : solve(between, (1.0 - share) * from + share * to, nullptr);
    if ((joints - last).cwiseAbs().maxCoeff() > kJump)
      throw NoPath{"the joints would jump on the way at " + place_text(between) +
                   ": bring the arm over the area with its elbow out, as it is when untucked"};
    out.add(joints, step);
    last = joints;
  }
  return out;
}

Path Planner::up(const Joints& from, double rise) const {
  return vertical(from, arm_.tip(from), std::max(0.0, rise), "on the way up");
}

int check_reach(const Area& area, double spacing, const std::function<void(const Target&)>& plan) {
  const auto count = [&](double length) { return static_cast<int>(std::ceil(length / spacing)) + 1; };
  const int nx = count(area.width);
  const int ny = count(area.depth);
  int missed = 0;
  std::string first;
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) {
      const Target place{area.width * i / (nx - 1), area.depth * j / (ny - 1)};
      try {
        plan(place);
      } catch (const NoPath& none) {
        if (missed++ > 0) continue;
        first = fmt::format("({:.2f} cm, {:.2f} cm): {}", 100.0 * place.x, 100.0 * place.y, none.reason);
      }
    }
  }
  if (missed == 0) return nx * ny;
  throw robot_error(
      "scene_pose",
      fmt::format("{} of {} places of the area cannot be reached, the first at {}", missed, nx * ny, first),
      "move the middle of the area near x = 60 cm, y = 20 cm of base");
}

}  // namespace palpate::baxter
