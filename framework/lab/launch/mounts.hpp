// SPDX-License-Identifier: MIT
// Whether a file system that nodes of a cluster share lets them see each other's locks.
#pragma once

#include <filesystem>
#include <string_view>

namespace palpate {

/// Throws Error, with the mount and its option, where `folder`, an absolute path without links, lies on NFS that was
/// mounted with `nolock`, `local_lock=posix` or `local_lock=all`: each node then has locks of its own, and two could
/// run one job. `mountinfo` is the text of /proc/self/mountinfo (proc_pid_mountinfo(5)).
void check_shared_locks(const std::filesystem::path& folder, std::string_view mountinfo);

/// The same with the mounts of this process; `folder` exists. Checks nothing where /proc/self/mountinfo cannot be read,
/// or is longer than kMostSystemBytes.
void check_shared_locks(const std::filesystem::path& folder);

}  // namespace palpate
