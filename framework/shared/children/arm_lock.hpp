// SPDX-License-Identifier: MIT
// A lock for each arm, whatever runs move it: the lock of a record keeps two processes from one run, but not two runs
// from one arm.
#pragma once

#include "children/child_process.hpp"

#include <string>

namespace palpate {

/// Holds the lock of an arm while it lives. The kernel keeps the lock as the name of a socket ("abstract", unix(7)). It
/// depends on no environment, folder or user, nobody can remove it, and it ends with the process, however that ends.
/// Children that the process forks do not hold it. Not excluded are processes of other machines, and of containers with
/// a network of their own.
class ArmLock {
 public:
  /// Holds nothing.
  ArmLock() = default;
  /// Locks `arm`, which names one arm of one robot. Only the first 95 bytes count, so that two arms with longer names
  /// may wait for each other. Throws Error: of kind `busy`, with `where` and the process that holds the lock, where
  /// another one does; of kind `run` where the system makes no such socket.
  ArmLock(const std::string& where, const std::string& arm);
  ArmLock(ArmLock&&) = default;
  ArmLock& operator=(ArmLock&&) = default;
  ~ArmLock();

 private:
  Descriptor socket_;
};

}  // namespace palpate
