// SPDX-License-Identifier: MIT
// The robot's IKService, in a thread of its own: a slow answer holds up nothing else.
#pragma once

#include "baxter/kinematics.hpp"

#include <atomic>
#include <memory>
#include <mutex>

namespace palpate::fake_baxter {

class InverseKinematics {
 public:
  /// Advertises the service; poses are those of the tip of `arm`, left_gripper, in the frame `base`. `arm` must outlive
  /// it and have no other user that solves. Needs a node.
  explicit InverseKinematics(const baxter::Arm& arm);
  ~InverseKinematics();

  /// Where the joints are, from which a solution is looked for unless the caller names others.
  void standing(const baxter::Joints& joints);
  /// What is wrong with it: no solutions, and seconds of real time before an answer.
  void spoil(bool invalid, double slow);

 private:
  struct Service;
  std::unique_ptr<Service> service_;
};

}  // namespace palpate::fake_baxter
