// SPDX-License-Identifier: MIT
#include "baxter/ros/connection.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>

#include <ros/node_handle.h>
#include <sensor_msgs/PointCloud2.h>
#include <sensor_msgs/point_cloud2_iterator.h>
#include <visualization_msgs/MarkerArray.h>

namespace palpate::baxter {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr double kTapSize = 0.008;     ///< m, size of a tap's marker
constexpr double kLineWidth = 0.002;   ///< m, width of the area's border
constexpr double kArrowLength = 0.08;  ///< m, from the arrow's start to the desk
constexpr double kArrowWidth = 0.006;
constexpr const char* kFrame = "base";

class RvizDisplay final : public SpectatorDisplay {
 public:
  RvizDisplay(std::shared_ptr<Bag> bag, const ScenePoseOptions& place, const Area& area, double desk)
      : frame_(place.frame()), area_(area), desk_(desk), bag_(std::move(bag)) {
    surface_publisher_ = handle_.advertise<sensor_msgs::PointCloud2>("palpate/surface", 1, true);
    taps_publisher_ = handle_.advertise<MarkerArray>("palpate/taps", 1, true);
    show_taps();
  }

  ~RvizDisplay() override {
    forget_silent_master();
    run_on_connection_thread([this] {
      surface_publisher_.shutdown();
      taps_publisher_.shutdown();
    });
  }

  void target(const Target& place) override {
    next_ = place;
    show_taps();
  }

  void contacts(const std::vector<TapReading>& readings) override {
    on_.clear();
    off_.clear();
    for (const TapReading& one : readings)
      (one.on_object ? on_ : off_).push_back(in_base(one.position.x(), one.position.y(), one.position.z()));
    next_.reset();
    show_taps();
  }

  void surface(const Points& places, const VectorView& height, const VectorView& deviation) override {
    const auto count = static_cast<std::size_t>(std::min({places.rows(), height.size(), deviation.size()}));
    sensor_msgs::PointCloud2 cloud;
    // The cloud has no stamp, because RViz drops messages that are older than its transforms.
    cloud.header.frame_id = kFrame;
    cloud.height = 1;
    cloud.is_dense = height.allFinite() && deviation.allFinite();
    sensor_msgs::PointCloud2Modifier modifier(cloud);
    const auto real = sensor_msgs::PointField::FLOAT32;
    modifier.setPointCloud2Fields(4, "x", 1, real, "y", 1, real, "z", 1, real, "intensity", 1, real);
    modifier.resize(count);
    sensor_msgs::PointCloud2Iterator<float> value(cloud, "x");
    for (std::size_t i = 0; i < count; ++i, ++value) {
      const auto row = static_cast<Eigen::Index>(i);
      const geometry_msgs::Point point = in_base(places(row, 0), places(row, 1), height[row]);
      value[0] = static_cast<float>(point.x);
      value[1] = static_cast<float>(point.y);
      value[2] = static_cast<float>(point.z);
      value[3] = static_cast<float>(deviation[row]);
    }
    publish(surface_publisher_, cloud);
  }

 private:
  geometry_msgs::Point in_base(double x, double y, double z) const {
    const Eigen::Vector3d at = frame_ * Eigen::Vector3d(x, y, z);
    geometry_msgs::Point point;
    point.x = at.x();
    point.y = at.y();
    point.z = at.z();
    return point;
  }

  /// Returns a marker with a fixed id in its own namespace, so that each message replaces the previous one.
  static Marker marker(const char* name, int type, double width, const std::array<float, 3>& color,
                       std::vector<geometry_msgs::Point> points) {
    Marker result;
    result.header.frame_id = kFrame;
    result.ns = name;
    result.id = 0;
    result.type = type;
    result.action = points.empty() ? Marker::DELETE : Marker::ADD;
    result.pose.orientation.w = 1.0;
    result.scale.x = result.scale.y = result.scale.z = width;
    std::tie(result.color.r, result.color.g, result.color.b) = std::tie(color[0], color[1], color[2]);
    result.color.a = 1.0F;
    result.points = std::move(points);
    return result;
  }

  void show_taps() {
    MarkerArray array;
    array.markers.push_back(
        marker("area", Marker::LINE_STRIP, kLineWidth, {0.8F, 0.8F, 0.8F},
               {in_base(0, 0, desk_), in_base(area_.width, 0, desk_), in_base(area_.width, area_.depth, desk_),
                in_base(0, area_.depth, desk_), in_base(0, 0, desk_)}));
    array.markers.push_back(marker("on object", Marker::SPHERE_LIST, kTapSize, {0.1F, 0.7F, 0.2F}, on_));
    array.markers.push_back(marker("off object", Marker::CUBE_LIST, kTapSize, {0.3F, 0.4F, 0.8F}, off_));
    std::vector<geometry_msgs::Point> arrow;
    if (next_) arrow = {in_base(next_->x, next_->y, desk_ + kArrowLength), in_base(next_->x, next_->y, desk_)};
    Marker next = marker("next", Marker::ARROW, kArrowWidth, {0.9F, 0.5F, 0.1F}, arrow);
    next.scale.y = 2 * kArrowWidth;  // width of the head
    next.scale.z = 4 * kArrowWidth;  // length of the head
    array.markers.push_back(next);
    publish(taps_publisher_, array);
  }

  template <class Message>
  void publish(ros::Publisher& publisher, const Message& message) {
    publisher.publish(message);
    bag_->write_own(publisher.getTopic(), message, true);
  }

  Eigen::Isometry3d frame_;
  Area area_;
  double desk_;
  std::shared_ptr<Bag> bag_;
  ros::NodeHandle handle_;
  ros::Publisher surface_publisher_;
  ros::Publisher taps_publisher_;
  std::vector<geometry_msgs::Point> on_, off_;
  std::optional<Target> next_;
};

}  // namespace

std::unique_ptr<SpectatorDisplay> make_view(Robot& robot, const ScenePoseOptions& place, const Area& area,
                                            double desk) {
  return std::make_unique<RvizDisplay>(dynamic_cast<RosConnection&>(robot).bag(), place, area, desk);
}

}  // namespace palpate::baxter
