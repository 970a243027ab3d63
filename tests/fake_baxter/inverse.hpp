// SPDX-License-Identifier: MIT
// The robot's IKService, in a thread of its own: a slow answer holds up nothing else.
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

/// `joints` with those of the left arm that are among the names.
baxter::Joints overlaid(baxter::Joints joints, const std::vector<std::string>& names,
                        const std::vector<double>& values);

class InverseKinematics {
 public:
  /// What it answers from.
  struct Now {
    baxter::Joints joints =
        baxter::untucked();  ///< where they are; a solution is looked for from there, or from others
    bool invalid = false;    ///< it says that there is no solution
    double slow = 0.0;       ///< seconds of real time before an answer
  };

  /// Advertises the service; poses are those of the tip of `arm`, left_gripper, in the frame `base`. `arm` must outlive
  /// it and have no other user that solves. Needs a node.
  explicit InverseKinematics(const baxter::Arm& arm);
  ~InverseKinematics();

  void set(const Now& now);

 private:
  using Call = baxter_core_msgs::SolvePositionIK;
  bool answer(Call::Request& request, Call::Response& response);

  const baxter::Arm& arm_;
  std::mutex mutex_;
  Now now_;  ///< guarded by mutex_
  std::atomic<bool> stopping_{false};
  ros::NodeHandle node_;
  ros::CallbackQueue queue_;
  ros::ServiceServer server_;
  ros::AsyncSpinner spinner_{1, &queue_};
};

}  // namespace palpate::fake_baxter
