// SPDX-License-Identifier: MIT
#include "baxter/preflight.hpp"

#include "baxter/words.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace palpate::baxter {
namespace {

constexpr double kAboveTravel = 0.3;   ///< m that the arm may be above the height of travel
constexpr double kBelowFloor = 0.01;   ///< m that the tip may be below the end of a descent
constexpr double kAgreement = 0.005;   ///< m between kinematics and endpoint_state: both come from the same joints
constexpr double kAgreedTurn = 0.035;  ///< rad, likewise
constexpr double kUpright = 0.35;      ///< rad that the tool may lean before the first motion puts it upright

/// Of set_speed_ratio: 0.27 of 1.5 rad/s is the 0.4 rad/s that a joint is asked for.
constexpr double kLeastRatio = 0.27;
constexpr double kAnyRatio = std::numeric_limits<double>::infinity();
constexpr double kLeastTimeout = 0.05;  ///< s: five set-points
constexpr double kMostTimeout = 0.5;    ///< s for which an arm goes on that nobody leads any more

std::string centimetres(double length) { return fmt::format("{:.2f} cm", 100.0 * length); }

/// Own kinematics against the robot's: they must agree on left_gripper, but for a gripper that the config does not
/// know.
void check_gripper(const JointReading& joints, const EndpointReading& endpoint, double gripper) {
  const Pose hand = Arm(Eigen::Vector3d::Zero()).tip(joints.position);
  const Eigen::Vector3d seen = hand.rotation.inverse() * (endpoint.pose.position - hand.position);
  const double aside = std::hypot(seen.x(), seen.y());
  const double turned = hand.rotation.angularDistance(endpoint.pose.rotation);
  if (aside <= kAgreement && std::abs(seen.z() - gripper) <= kAgreement && turned <= kAgreedTurn) return;
  if (aside <= kAgreement && turned <= kAgreedTurn) {
    throw trouble("tool.gripper",
                  fmt::format("the robot has left_gripper {} from left_hand, the config has it at {}",
                              centimetres(seen.z()), centimetres(gripper)),
                  "a gripper is configured on the robot that the config does not know: see what is mounted, then "
                  "correct tool.gripper and tool.tip");
  }
  throw trouble("tool.gripper",
                fmt::format("joints and endpoint_state disagree by {} about where left_gripper is",
                            centimetres((seen - Eigen::Vector3d(0, 0, gripper)).norm())),
                "this is another arm than the Baxter whose lengths are known, or its gripper is mounted askew");
}

}  // namespace

Workspace workspace_of(const BaxterOptions& options, const Scene& scene) {
  const Area area = scene.area();
  return {area.width, area.depth, scene.desk() - options.motion.overrun - kBelowFloor,
          scene.desk() + options.motion.hover + kAboveTravel};
}

void check_plan(const BaxterOptions& options, const Scene& scene) {
  if (!options.calibration) return;
  const Area area = scene.area();
  const auto [x, y] = std::tie(options.calibration->at[0], options.calibration->at[1]);
  if (x < 0.0 || y < 0.0 || x > area.width || y > area.depth) {
    throw trouble("calibration.at", "lies outside of the area", "take a bare place within");
  }
}

void check_before_flight(const Snapshot& seen, const BaxterOptions& options, const Planner& planner,
                         const Workspace& workspace, bool moving) {
  if (const std::optional<Fault> fault = Watch::fit(seen, moving)) throw trouble("", fault->reason);
  if (const int joint = beyond_limits(seen.joints->position, 0.0); joint >= 0 && moving) {
    throw trouble("", fmt::format("{} is beyond its limit", kJointNames[static_cast<std::size_t>(joint)]),
                  "move the arm by hand");
  }
  check_gripper(*seen.joints, *seen.endpoint, options.tool.gripper);
  if (!moving) return;
  const Pose tip = Arm(Eigen::Map<const Eigen::Vector3d>(options.tool.tip)).tip(seen.joints->position);
  const std::string breach = workspace.breach(planner.to_scene(tip.position));
  if (!breach.empty()) {
    throw trouble("", breach,
                  "bring the tool by hand to a place above the area; palpate moves the arm there and nowhere else");
  }
  const Eigen::Vector3d down = tip.rotation * Eigen::Vector3d::UnitZ();
  if (std::acos(std::clamp(-down.z(), -1.0, 1.0)) > kUpright) {
    throw trouble("", "the tool does not point down", "turn it by hand, within 20 degrees of the vertical");
  }
}

std::vector<std::string> check_settings(const Snapshot& seen) {
  const struct {
    const char* topic;
    const std::optional<Setting>& setting;
    const char* own;
    double least, most;
    const char* reason;
    const char* remedy;
  } settings[] = {
      {"set_speed_ratio", seen.speed_ratio, "0.3", kLeastRatio, kAnyRatio, ", at which the arm cannot follow",
       "set it to 0.3, on /robot/limb/left/set_speed_ratio"},
      {"joint_command_timeout", seen.command_timeout, "0.2 s", kLeastTimeout, kMostTimeout,
       " s; palpate counts on an arm that holds by itself soon after the last set-point, and not before the next",
       "set it to 0.2, on /robot/limb/left/joint_command_timeout"},
  };
  std::vector<std::string> out;
  for (const auto& [topic, setting, own, least, most, reason, remedy] : settings) {
    if (!setting) {
      out.push_back(fmt::format("{}: nobody says it now, taken for the robot's own {}", topic, own));
      continue;
    }
    out.push_back(fmt::format("{}: {:g} from {}", topic, setting->value, setting->sender));
    if (setting->value >= least && setting->value <= most) continue;
    throw trouble(topic, fmt::format("{} has set it to {:g}{}", setting->sender, setting->value, reason), remedy);
  }
  if (seen.avoidance && (seen.avoidance->other_arm || !seen.avoidance->objects.empty())) {
    std::vector<std::string> from = seen.avoidance->objects;
    if (seen.avoidance->other_arm) from.insert(from.begin(), "the other arm");
    throw trouble("collision_avoidance_state", "the robot pushes the arm away from " + listed(from),
                  "move the other arm away, or the area forward");
  }
  const EndEffector& mounted = seen.end_effector;
  out.push_back(fmt::format(
      "mounted, as the robot has it: {}, {}; a tool of another mass moves the zero of the force with the posture",
      mounted.product.empty() ? "no gripper that it knows" : mounted.product,
      mounted.mass ? fmt::format("{:g} kg beyond the flange", *mounted.mass) : "of unknown mass"));
  return out;
}

int check_reach(const Planner& planner, const Area& area, double hover, double floor, double speed, double spacing) {
  const auto count = [&](double length) { return static_cast<int>(std::ceil(length / spacing)) + 1; };
  const int nx = count(area.width);
  const int ny = count(area.depth);
  const Target middle{0.5 * area.width, 0.5 * area.depth};
  int missed = 0;
  std::string first;
  for (int i = 0; i < nx; ++i) {
    for (int j = 0; j < ny; ++j) {
      const Target place{area.width * i / (nx - 1), area.depth * j / (ny - 1)};
      try {
        planner.column(place, middle, hover, floor, speed);
      } catch (const NoPath& none) {
        if (missed++ > 0) continue;
        first = fmt::format("({}, {}): {}", centimetres(place.x), centimetres(place.y), none.reason);
      }
    }
  }
  if (missed == 0) return nx * ny;
  throw trouble("place",
                fmt::format("{} of {} places of the area cannot be reached, the first at {}", missed, nx * ny, first),
                "put the middle of the area near x = 60 cm, y = 20 cm of base");
}

}  // namespace palpate::baxter
