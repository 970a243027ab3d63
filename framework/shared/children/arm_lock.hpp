// SPDX-License-Identifier: MIT
// A lock per arm, which prevents two runs from moving the same arm at the same time. The lock of a record does not
// suffice: it only prevents two processes from executing the same run.
#pragma once

#include "children/child_process.hpp"

#include <string>

namespace palpate {

/// Holds the lock of an arm for its lifetime. The lock is an abstract socket name of the kernel (unix(7)). The lock is
/// independent of environment, folder and user, cannot be removed, and always ends with the process. Forked children do
/// not hold the lock. The lock does not exclude processes on other machines or in containers with their own network.
class ArmLock {
 public:
  /// Creates an object without a lock.
  ArmLock() = default;
  /// Locks `arm`, the name of one arm of one robot. Only the first 95 bytes of the name count, so arms with longer
  /// names may share a lock. Throws Error with the place `where`. The kind is `busy` if another process holds the lock;
  /// the message then gives the process id. The kind is `run` if the system cannot create the socket.
  ArmLock(const std::string& where, const std::string& arm);
  ArmLock(ArmLock&&) = default;
  ArmLock& operator=(ArmLock&&) = default;
  ~ArmLock();

 private:
  FileDescriptor socket_;
};

}  // namespace palpate
