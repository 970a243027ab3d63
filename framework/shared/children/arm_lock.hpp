// SPDX-License-Identifier: MIT
// A lock for each arm, whatever runs move it: the lock of a record keeps two processes from one run, but not two runs
// from one arm.
#pragma once

#include "children/child_process.hpp"

#include <filesystem>
#include <string>

namespace palpate {

/// The folder of this user's locks of arms: `palpate` in XDG_RUNTIME_DIR where that is an absolute path, else
/// `palpate-UID` in the system's folder for temporary files.
std::filesystem::path arm_lock_folder();

/// Holds the lock of an arm while it lives, and no longer than its process does. Users have locks of their own, and so
/// have machines: two users, or two machines, are not kept from one arm.
class ArmLock {
 public:
  /// Holds nothing.
  ArmLock() = default;
  /// Locks `arm`, which names one arm of one robot; `owner`, the folder of a record, is what others are told who want
  /// it. The file in arm_lock_folder() is named like the arm, with each byte but letters, digits, '.', '_' and '-' as
  /// %XX. Throws Error: of kind `busy`, with `where` and the process that holds it, where another has it; of kind `run`
  /// where folder or file cannot be made, or others may write there.
  ArmLock(const std::string& where, const std::string& arm, const std::string& owner);

 private:
  Descriptor file_;
};

}  // namespace palpate
