// SPDX-License-Identifier: MIT
#include "launch/local_launcher.hpp"
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

namespace palpate {
namespace {

TEST(LocalLauncher, AJobThatIsKilledBeforeItsAttemptIsNotedIsNotBegunForEver) {
  const test::TemporaryFolder folder;
  folder.write("jobs/000000000000/config.yaml", "");
  const Sweep sweep{folder.path(), {}, {Job{0, "000000000000", {}}}};
  const Installation installation;
  const PluginHost host({});
  const Workshop workshop{host, installation, {}, nullptr};
  const auto dies = [](std::size_t) -> ResolvedConfig {
    std::raise(SIGKILL);
    throw std::logic_error("survived");
  };
  LocalLauncher launcher({workshop, sweep, dies, {1, {}, 3, true}, {}});
  launcher.submit({0});
  Launcher::State state;
  int polls = 0;
  do state = launcher.poll(10.0);
  while (!state.empty_handed() && ++polls < 20);
  EXPECT_TRUE(state.empty_handed());
  EXPECT_THAT(state.returned, testing::ElementsAre(0));
  EXPECT_THAT(read_ending(job_directory(sweep, sweep.jobs[0])).stop_reason, testing::EndsWith("in attempt 3"));
}

}  // namespace
}  // namespace palpate
