// SPDX-License-Identifier: MIT
#include "baxter/ros/solver.hpp"

#include "baxter/ros/arm_part.hpp"
#include "baxter/ros/link.hpp"

#include <algorithm>

#include <baxter_core_msgs/SolvePositionIK.h>
#include <ros/time.h>

namespace palpate::baxter {
namespace {

namespace msgs = baxter_core_msgs;

/// For an answer, with room in the promised second.
constexpr std::chrono::milliseconds kSolve(900);

}  // namespace

std::string Solver::answer(const std::string& request, Deadline deadline) {
  const char* md5 = ros::service_traits::MD5Sum<msgs::SolvePositionIK>::value();
  if (address_) {
    try {
      return call_service(*address_, kSolverService, md5, request, deadline);
    } catch (const Unreached& reason) {
      address_.reset();
      if (reason.why() != Unreached::Why::refused) throw;
      // It may have been started again, elsewhere.
    }
  }
  const auto uri = master_.service(kSolverService, deadline);
  if (!uri) throw Unreached(Unreached::Why::refused, "nobody offers it");
  const auto place = parse_uri(*uri, "rosrpc");
  if (!place) throw Unreached(Unreached::Why::nonsense, "the master has it at " + *uri);
  address_ = look_up(place->host, place->port, deadline);
  return call_service(*address_, kSolverService, md5, request, deadline);
}

Robot::Answer Solver::solve(const Pose& gripper, const Joints& seed) {
  msgs::SolvePositionIKRequest request;
  request.seed_mode = msgs::SolvePositionIKRequest::SEED_USER;
  request.pose_stamp.resize(1);
  geometry_msgs::PoseStamped& pose = request.pose_stamp[0];
  pose.header.stamp = ros::Time::now();
  pose.header.frame_id = "base";
  pose.pose.position.x = gripper.position.x();
  pose.pose.position.y = gripper.position.y();
  pose.pose.position.z = gripper.position.z();
  pose.pose.orientation.x = gripper.rotation.x();
  pose.pose.orientation.y = gripper.rotation.y();
  pose.pose.orientation.z = gripper.rotation.z();
  pose.pose.orientation.w = gripper.rotation.w();
  request.seed_angles.resize(1);
  request.seed_angles[0].header = pose.header;
  request.seed_angles[0].name.assign(kJointNames.begin(), kJointNames.end());
  request.seed_angles[0].position.assign(seed.begin(), seed.end());

  const auto trouble = [](const std::string& words) {
    return Robot::Answer{{}, std::string(kSolverService) + ": " + words};
  };
  msgs::SolvePositionIKResponse response;
  try {
    const ros::SerializedMessage asked = ros::serialization::serializeMessage(request);
    std::string bytes =
        answer({reinterpret_cast<const char*>(asked.buf.get()), asked.num_bytes}, Steady::now() + kSolve);
    ros::serialization::IStream stream(reinterpret_cast<std::uint8_t*>(bytes.data()),
                                       static_cast<std::uint32_t>(bytes.size()));
    ros::serialization::deserialize(stream, response);
  } catch (const Unreached& reason) {
    return trouble(reason.what());
  } catch (const ros::Exception& exception) {
    return trouble(std::string("its answer cannot be read: ") + exception.what());
  }
  if (response.isValid.size() != 1 || response.joints.size() != 1 || response.result_type.size() != 1) {
    return trouble("its answer has not one part for one pose");
  }
  if (response.isValid[0] == 0 || response.result_type[0] == msgs::SolvePositionIKResponse::RESULT_INVALID) return {};
  const ArmPart part = arm_part(response.joints[0]);
  if (!part.whole) return trouble("its answer has " + part.words);
  return {part.position, {}};
}

}  // namespace palpate::baxter
