// SPDX-License-Identifier: MIT
// The plugin in a child process as in the program: loaded, created, destroyed, created again.
#include "child_run.hpp"
#include "children/arm_lock.hpp"
#include "command_lines.hpp"
#include "record/fields.hpp"
#include "robot_lab.hpp"
#include "support/plugins.hpp"
#include "support/testing.hpp"

#include <palpate/backend.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <optional>

#include <unistd.h>

namespace palpate::test {
namespace {

constexpr const char* kOptions =
    "{motion: {type: continuous, speed: 2 cm/s, threshold: 6 N}, tool: {tip: [0 cm, 0 cm, 15 cm]}, "
    "scene_pose: {corner: [50.7 cm, 6.7 cm], height: -17 cm, rotation: 10 deg}, force_sign: negative}";

TEST(RobotPlugin, MadeAndDestroyedTwiceInAProcessLeavesNoThreadAndNoNode) {
  RobotLab lab(robot_arguments());
  const ChildResult process = run_in_child(lab.environment(), [&] {
    const PluginHost host({plugin_folder()});
    std::string report;
    for (int i = 0; i < 2; ++i) {
      auto backend = make<Backend>(host, "baxter", kOptions);
      const long connected = threads();
      TapRequest request;
      request.number = i + 1;
      request.line = line_from_above({0.04, 0.07});
      const TapResult contact = backend->tap(request);
      report += outcome_name(contact.outcome) + contact.reason;
      const bool listed = lab.nodes().size() == 3;
      backend.reset();
      report +=
          " on the net " + std::to_string(listed) + ", gone with it " + std::to_string(connected - threads()) + "\n";
    }
    return report + "left " + std::to_string(threads());
  });
  EXPECT_EQ(process.status, 0);
  // The test's own thread and roscpp's threads remain until the process ends.
  const ChildResult roscpp_alone = run_in_child(lab.environment(), [&] {
    const PluginHost host({plugin_folder()});
    make<Backend>(host, "baxter", kOptions).reset();
    return "left " + std::to_string(threads());
  });
  EXPECT_EQ(process.printed,
            "contact on the net 1, gone with it 1\ncontact on the net 1, gone with it 1\n" + roscpp_alone.printed);
  EXPECT_THAT(lab.nodes(), ::testing::ElementsAre("/end_effector_publisher", "/realtime_loop"));
}

TEST(RobotPlugin, DoesNotConnectToAnArmThatAnotherProcessHasInHand) {
  RobotLab lab(robot_arguments());
  const std::string master = lab.environment().front();  // ROS_MASTER_URI=http://...
  const std::string uri = master.substr(master.find('=') + 1);
  const auto attempt = [&](const std::string& more) {
    return run_in_child(
               lab.environment(),
               [&] {
                 const PluginHost host({plugin_folder()});
                 return error_of([&] { make<Backend>(host, "baxter", std::string(kOptions).insert(1, more)); });
               })
        .printed;
  };
  std::optional<ArmLock> other;
  other.emplace("backend", "left of " + uri);
  EXPECT_EQ(attempt(""), master + ": the arm left of " + uri + " is used by process " + std::to_string(::getpid()) +
                             ", wait until that process has ended, or end it");
  EXPECT_EQ(attempt("dry_run: true, "), "accepted") << "that moves nothing";
  other.reset();
  EXPECT_EQ(attempt(""), "accepted");
}

}  // namespace
}  // namespace palpate::test
