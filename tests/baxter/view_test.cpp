// SPDX-License-Identifier: MIT
// Messages for RViz.
#include "baxter/ros/connect.hpp"

#include "child_run.hpp"
#include "command_lines.hpp"
#include "robot_lab.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <visualization_msgs/MarkerArray.h>

namespace palpate::test {
namespace {

using baxter::SpectatorDisplay;
using sensor_msgs::PointCloud2;
using ::testing::StartsWith;
using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

/// A view with the scene's corner at (0.5, 0.1, -0.2) in the robot's base, rotated by 90 degrees: x of the scene is y
/// of the base.
std::unique_ptr<SpectatorDisplay> turned_view(baxter::Robot& robot) {
  baxter::ScenePoseOptions place;
  place.corner[0] = 0.5;
  place.corner[1] = 0.1;
  place.height = -0.2;
  place.rotation = std::acos(0.0);
  return baxter::make_view(robot, place, {0.3, 0.2}, 0.01);
}

/// Returns the latched message as a late subscriber receives it; "nothing" if none arrives within 20 s.
template <class Message>
std::string seen_late(const std::string& topic, const std::function<std::string(const Message&)>& tell) {
  ros::CallbackQueue queue;
  ros::NodeHandle handle;
  handle.setCallbackQueue(&queue);
  std::string seen;
  const boost::function<void(const Message&)> hear = [&](const Message& message) { seen = tell(message); };
  const ros::Subscriber subscriber = handle.subscribe<const Message&>(topic, 1, hear);
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(5);
  while (seen.empty() && std::chrono::steady_clock::now() < end) queue.callAvailable(ros::WallDuration(0.1));
  return seen.empty() ? "nothing" : seen;
}

std::string describe(const geometry_msgs::Point& point) {
  return fmt::format("({:.3f} {:.3f} {:.3f})", point.x, point.y, point.z);
}

std::string describe(const MarkerArray& array) {
  std::string text;
  for (const Marker& marker : array.markers) {
    text += fmt::format("{} {} in {} at {}{}:", marker.ns, marker.id, marker.header.frame_id,
                        marker.header.stamp.toSec(), marker.action == Marker::DELETE ? ", gone" : "");
    for (const geometry_msgs::Point& point : marker.points) text += " " + describe(point);
    text += "\n";
  }
  return text;
}

std::string describe(const PointCloud2& cloud) {
  std::string text = cloud.header.frame_id + (cloud.is_dense ? "" : ", not dense") + "\n";
  sensor_msgs::PointCloud2ConstIterator<float> value(cloud, "x");
  sensor_msgs::PointCloud2ConstIterator<float> intensity(cloud, "intensity");
  for (; value != value.end(); ++value, ++intensity) {
    text += fmt::format("{:.3f} {:.3f} {:.3f}: {:.3f}\n", value[0], value[1], value[2], *intensity);
  }
  return text;
}

/// Returns the message that a late subscriber receives after `show`.
template <class Message>
std::string seen(const RobotLab& lab, const std::string& topic, const std::function<void(SpectatorDisplay&)>& show) {
  return run_in_child(lab.environment(),
                      [&] {
                        const auto robot = baxter::connect({false, false});
                        const std::unique_ptr<SpectatorDisplay> view = turned_view(*robot);
                        show(*view);
                        return seen_late<Message>(topic, [](const Message& message) { return describe(message); });
                      })
      .printed;
}

std::vector<std::string> in_real_time() { return {object_i(), "backend=fake_baxter", "scene=object_i_arm"}; }

TEST(Shown, AreTheAreaTheTapsOnAndOffTheObjectAndTheNextAboveTheDeskInTheRobotsFrame) {
  const RobotLab lab(in_real_time());
  const std::string area =
      "area 0 in base at 0: (0.500 0.100 -0.190) (0.500 0.400 -0.190) (0.300 0.400 -0.190) (0.300 0.100 -0.190) "
      "(0.500 0.100 -0.190)\n";
  EXPECT_EQ(seen<MarkerArray>(lab, "palpate/taps", [](SpectatorDisplay&) {}),
            area + "on object 0 in base at 0, gone:\noff object 0 in base at 0, gone:\nnext 0 in base at 0, gone:\n");
  const auto contact = [&](const Target& place, double height, bool on_object) {
    TapReading out;
    out.position = Eigen::Vector3d(place.x, place.y, 0.01 + height);
    out.on_object = on_object;
    return out;
  };
  const auto show = [&](SpectatorDisplay& view) {
    view.target({0.1, 0.0});
    view.contacts({contact({0.1, 0.0}, 0.07, false)});
    view.target({0.2, 0.0});
    view.contacts({contact({0.1, 0.0}, 0.07, true), contact({0.2, 0.0}, 0.0, false)});  // the first contact was changed
    view.target({0.0, 0.1});
  };
  EXPECT_EQ(seen<MarkerArray>(lab, "palpate/taps", show),
            area +
                "on object 0 in base at 0: (0.500 0.200 -0.120)\n"
                "off object 0 in base at 0: (0.500 0.300 -0.190)\n"
                "next 0 in base at 0: (0.400 0.100 -0.110) (0.400 0.100 -0.190)\n");
}

TEST(Shown, TheSurfaceHasItsStandardDeviationForIntensity) {
  const RobotLab lab(in_real_time());
  const auto show = [](double second) {
    return [second](SpectatorDisplay& view) {
      Points places(2, 2);
      places << 0.0, 0.0, 0.1, 0.2;
      view.surface(places, Eigen::Vector2d(0.05, second), Eigen::Vector2d(0.002, 0.01));
    };
  };
  EXPECT_EQ(seen<PointCloud2>(lab, "palpate/surface", show(0.07)),
            "base\n0.500 0.100 -0.150: 0.002\n0.300 0.200 -0.130: 0.010\n");
  EXPECT_THAT(seen<PointCloud2>(lab, "palpate/surface", show(std::numeric_limits<double>::quiet_NaN())),
              StartsWith("base, not dense\n"));
}

}  // namespace
}  // namespace palpate::test
