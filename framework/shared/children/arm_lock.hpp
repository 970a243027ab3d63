// SPDX-License-Identifier: MIT
// A lock per arm, which prevents two runs from moving the same arm. The lock of a record only prevents two processes
// from executing the same run.
#pragma once

#include "children/child_process.hpp"

#include <string>

namespace palpate {

/// Holds the lock of an arm for its lifetime. The lock is an abstract socket name of the kernel (unix(7)). It is
/// independent of environment, folder and user, cannot be removed, and always ends with the process. Forked children do
/// not hold it. It does not exclude processes on other machines or in containers with their own network.
class ArmLock {
 public:
  /// Creates an object without a lock.
  ArmLock() = default;
  /// Locks `arm`, the name of one arm of one robot. Only the first 95 bytes count, so arms with longer names may share
  /// a lock. Throws Error with the place `where`: of kind `busy`, with the process that holds the lock; of kind `run`
  /// if the system cannot create the socket.
  ArmLock(const std::string& where, const std::string& arm);
  ArmLock(ArmLock&&) = default;
  ArmLock& operator=(ArmLock&&) = default;
  ~ArmLock();

 private:
  Descriptor socket_;
};

}  // namespace palpate
