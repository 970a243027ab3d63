// SPDX-License-Identifier: MIT
#include "launch/mounts.hpp"

#include "support/testing.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate::test {
namespace {

// Lines of Linux 6 for a root on ext4, four exports of one server, and a disk below one of them.
constexpr const char* kMounts =
    R"(22 1 8:1 / / rw,relatime shared:1 - ext4 /dev/sda1 rw
90 22 0:52 / /home rw,relatime shared:40 - nfs4 server:/home rw,vers=4.2,proto=tcp,local_lock=none,addr=10.0.0.1
91 22 0:53 / /scratch rw,relatime shared:41 - nfs server:/scratch rw,vers=3,nolock,proto=tcp,local_lock=all,addr=10.0.0.1
92 22 0:54 / /data\040of\040all rw,relatime - nfs server:/data rw,vers=3,local_lock=posix,addr=10.0.0.1
93 22 0:55 / /old rw,relatime shared:42 master:7 - nfs server:/old rw,vers=3,local_lock=flock,addr=10.0.0.1
94 91 8:2 / /scratch/local rw,relatime shared:43 - ext4 /dev/sdb1 rw
95 22 0:56 / /twice rw - nfs4 server:/a rw,local_lock=all
96 95 0:57 / /twice rw - nfs4 server:/b rw,local_lock=none
a line that nobody understands -
)";

std::string refusal(const std::string& folder) {
  return error_of([&] { check_shared_locks(folder, kMounts); });
}

TEST(Mounts, OfNfsWithLocksThatStayOnEachNodeAreRefused) {
  EXPECT_EQ(refusal("/scratch/me/runs"),
            "/scratch/me/runs: NFS at /scratch is mounted with 'nolock': nodes do not see each other's locks, and two "
            "could run the same job, mount it without this option, or put --runs on another file system");
  EXPECT_THAT(refusal("/data of all/runs"), testing::HasSubstr("'local_lock=posix'"));
}

TEST(Mounts, WhoseLocksAllNodesSeeAreAccepted) {
  EXPECT_EQ(refusal("/home/me/runs"), "accepted");
  EXPECT_EQ(refusal("/old/runs"), "accepted") << "flock() alone stays there, and is not used";
  EXPECT_EQ(refusal("/var/runs"), "accepted") << "no NFS: one node has it, or Lustre's own check finds out";
}

TEST(Mounts, CountOnlyWhereTheFolderLiesOnThem) {
  EXPECT_EQ(refusal("/scratch/local/runs"), "accepted") << "a disk below";
  EXPECT_EQ(refusal("/scratchpad/runs"), "accepted") << "another name";
  EXPECT_EQ(refusal("/twice/runs"), "accepted") << "the later mount hides the one before";
  EXPECT_NO_THROW(check_shared_locks("/"));
}

}  // namespace
}  // namespace palpate::test
