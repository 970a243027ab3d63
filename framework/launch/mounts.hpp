// SPDX-License-Identifier: MIT
// Checks that the nodes of a cluster see each other's file locks.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpate {

/// Throws Error, with the mount and its option, if `folder` (absolute, without links) is on NFS mounted with `nolock`,
/// `local_lock=posix` or `local_lock=all`. With these mounts, each node has its own locks, and two nodes could run the
/// same job. `mountinfo`: the text of /proc/self/mountinfo (proc_pid_mountinfo(5)).
void check_shared_locks(const std::filesystem::path& folder, std::string_view mountinfo);

/// Performs the same check with the mounts of this process. `folder` must exist. Does nothing if /proc/self/mountinfo
/// cannot be read or is longer than kMostSystemBytes.
void check_shared_locks(const std::filesystem::path& folder);

}  // namespace palpate
