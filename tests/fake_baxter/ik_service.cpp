// SPDX-License-Identifier: MIT
#include "fake_baxter/ik_service.hpp"

#include <algorithm>

namespace palpate::fake_baxter {
namespace {

baxter::Pose pose_of(const geometry_msgs::Pose& pose) {
  const auto& q = pose.orientation;
  return {{pose.position.x, pose.position.y, pose.position.z}, Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized()};
}

}  // namespace

baxter::Joints overlaid(baxter::Joints joints, const std::vector<std::string>& names,
                        const std::vector<double>& values) {
  for (std::size_t i = 0; i < std::min(names.size(), values.size()); ++i) {
    const auto joint = std::find(baxter::kJointNames.begin(), baxter::kJointNames.end(), names[i]);
    if (joint != baxter::kJointNames.end()) joints(joint - baxter::kJointNames.begin()) = values[i];
  }
  return joints;
}

IkService::IkService(const baxter::ArmKinematics& arm) : arm_(arm) {
  node_.setCallbackQueue(&queue_);
  server_ = node_.advertiseService("/ExternalTools/left/PositionKinematicsNode/IKService", &IkService::answer, this);
  spinner_.start();
}

IkService::~IkService() {
  stopping_ = true;
  server_.shutdown();
  spinner_.stop();
}

void IkService::set(const Now& now) {
  const std::lock_guard<std::mutex> lock(mutex_);
  now_ = now;
}

bool IkService::answer(Call::Request& request, Call::Response& response) {
  std::unique_lock<std::mutex> lock(mutex_);
  const Now now = now_;
  lock.unlock();
  // The fault ik_slow delays the answer.
  for (double waited = 0.0; waited < now.slow && !stopping_; waited += 0.01) ros::WallDuration(0.01).sleep();
  for (std::size_t i = 0; i < request.pose_stamp.size(); ++i) {
    const bool user = request.seed_mode != Call::Request::SEED_CURRENT && i < request.seed_angles.size();
    const baxter::Joints seed =
        user ? overlaid(now.joints, request.seed_angles[i].name, request.seed_angles[i].position) : now.joints;
    std::optional<baxter::Joints> found;
    if (!now.invalid && request.pose_stamp[i].header.frame_id == "base") {
      const baxter::Pose pose = pose_of(request.pose_stamp[i].pose);
      found = arm_.solve(pose, seed);
      if (!found) found = arm_.solve(pose, baxter::untucked());
    }
    sensor_msgs::JointState solution;
    if (found) {
      solution.name.assign(baxter::kJointNames.begin(), baxter::kJointNames.end());
      solution.position.assign(found->data(), found->data() + found->size());
    }
    response.joints.push_back(solution);
    response.isValid.push_back(found.has_value());
    const std::uint8_t seeded = user ? Call::Request::SEED_USER : Call::Request::SEED_CURRENT;
    const std::uint8_t invalid = Call::Response::RESULT_INVALID;
    response.result_type.push_back(found ? seeded : invalid);
  }
  return true;
}

}  // namespace palpate::fake_baxter
