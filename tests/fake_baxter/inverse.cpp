// SPDX-License-Identifier: MIT
#include "fake_baxter/inverse.hpp"

#include "fake_baxter/body.hpp"

#include <baxter_core_msgs/SolvePositionIK.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

#include <algorithm>

namespace palpate::fake_baxter {
namespace {

using Request = baxter_core_msgs::SolvePositionIK::Request;
using Response = baxter_core_msgs::SolvePositionIK::Response;

baxter::Pose pose_of(const geometry_msgs::Pose& pose) {
  const auto& q = pose.orientation;
  return {{pose.position.x, pose.position.y, pose.position.z}, Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized()};
}

/// `joints` with those of the left arm that `message` names.
baxter::Joints overlaid(baxter::Joints joints, const sensor_msgs::JointState& message) {
  for (std::size_t i = 0; i < std::min(message.name.size(), message.position.size()); ++i) {
    for (std::size_t j = 0; j < baxter::kJointNames.size(); ++j) {
      if (message.name[i] == baxter::kJointNames[j]) joints(static_cast<Eigen::Index>(j)) = message.position[i];
    }
  }
  return joints;
}

}  // namespace

struct InverseKinematics::Service {
  explicit Service(const baxter::Arm& the_arm) : arm(the_arm), spinner(1, &queue) {
    node.setCallbackQueue(&queue);
    server = node.advertiseService("/ExternalTools/left/PositionKinematicsNode/IKService", &Service::answer, this);
    spinner.start();
  }
  ~Service() {
    stopping = true;
    server.shutdown();
    spinner.stop();
  }

  bool answer(Request& request, Response& response) {
    std::unique_lock<std::mutex> lock(mutex);
    const baxter::Joints current = joints;
    const bool none = invalid;
    const double wait = slow;
    lock.unlock();
    // Being late is what was asked for.
    for (double waited = 0.0; waited < wait && !stopping; waited += 0.01) ros::WallDuration(0.01).sleep();
    for (std::size_t i = 0; i < request.pose_stamp.size(); ++i) {
      const bool user = request.seed_mode != Request::SEED_CURRENT && i < request.seed_angles.size();
      const baxter::Joints seed = user ? overlaid(current, request.seed_angles[i]) : current;
      const geometry_msgs::PoseStamped& pose = request.pose_stamp[i];
      std::optional<baxter::Joints> found;
      if (!none && pose.header.frame_id == "base") found = solve(pose_of(pose.pose), seed);
      sensor_msgs::JointState solution;
      if (found) {
        solution.name.assign(baxter::kJointNames.begin(), baxter::kJointNames.end());
        solution.position.assign(found->data(), found->data() + found->size());
      }
      response.joints.push_back(solution);
      response.isValid.push_back(found.has_value());
      const std::uint8_t seeded = user ? Request::SEED_USER : Request::SEED_CURRENT;
      const std::uint8_t invalid_result = Response::RESULT_INVALID;
      response.result_type.push_back(found ? seeded : invalid_result);
    }
    return true;
  }

  std::optional<baxter::Joints> solve(const baxter::Pose& pose, const baxter::Joints& seed) const {
    std::optional<baxter::Joints> found = arm.solve(pose, seed);
    return found ? found : arm.solve(pose, untucked());
  }

  const baxter::Arm& arm;
  std::mutex mutex;
  baxter::Joints joints = untucked();
  bool invalid = false;
  double slow = 0.0;
  std::atomic<bool> stopping{false};
  ros::NodeHandle node;
  ros::CallbackQueue queue;
  ros::ServiceServer server;
  ros::AsyncSpinner spinner;
};

InverseKinematics::InverseKinematics(const baxter::Arm& arm) : service_(std::make_unique<Service>(arm)) {}
InverseKinematics::~InverseKinematics() = default;

void InverseKinematics::standing(const baxter::Joints& joints) {
  const std::lock_guard<std::mutex> lock(service_->mutex);
  service_->joints = joints;
}

void InverseKinematics::spoil(bool invalid, double slow) {
  const std::lock_guard<std::mutex> lock(service_->mutex);
  service_->invalid = invalid;
  service_->slow = slow;
}

}  // namespace palpate::fake_baxter
