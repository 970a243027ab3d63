// SPDX-License-Identifier: MIT
// IKService of the simulated robot. It runs in its own thread, so that a slow answer delays nothing else.
#pragma once

#include "baxter/kinematics.hpp"

#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include <baxter_core_msgs/SolvePositionIK.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>

namespace palpate::fake_baxter {

/// Returns `joints` with the values of those left-arm joints that are in `names`.
baxter::Joints overlaid(baxter::Joints joints, const std::vector<std::string>& names,
                        const std::vector<double>& values);

class IkService {
 public:
  /// Input of the answers.
  struct Now {
    baxter::Joints joints = baxter::untucked();  ///< current joints, from which the search starts
    bool invalid = false;                        ///< whether the service reports that there is no solution
    double slow = 0.0;                           ///< s of real time before an answer
  };

  /// Advertises the service for poses of the tip of `arm` (left_gripper) in the frame `base`. `arm` must outlive the
  /// object, and no other code may call its solve(). Needs a running node.
  explicit IkService(const baxter::ArmKinematics& arm);
  ~IkService();

  void set(const Now& now);

 private:
  using Call = baxter_core_msgs::SolvePositionIK;
  bool answer(Call::Request& request, Call::Response& response);

  const baxter::ArmKinematics& arm_;
  std::mutex mutex_;
  Now now_;  ///< guarded by mutex_
  std::atomic<bool> stopping_{false};
  ros::NodeHandle node_;
  ros::CallbackQueue queue_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_{1, &queue_};
};

}  // namespace palpate::fake_baxter
