// SPDX-License-Identifier: MIT
// Objects from files of triangles. The file is read twice: first for its checksum when the config is resolved, then
// when the scene is built. Embree finds the first intersection with a line. No other file uses Embree.
#include "triangles.hpp"

#include <palpate/error.hpp>
#include <palpate/plugin.hpp>
#include <palpate/shape.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#if PALPATE_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

namespace palpate::shapes {

using Box = Eigen::AlignedBox3d;
using Eigen::Vector3d;

class Mesh final : public Shape {
 public:
  using Options = MeshOptions;
  Mesh(const Options& options, const Context&) : mesh_(read_surface(options)) {
    Box all;
    for (std::size_t i = 0; i < mesh_.points.size(); ++i) {
      if (i % kFew == 0) boxes_.emplace_back();
      boxes_.back().extend(mesh_.points[i]);
      all.extend(mesh_.points[i]);
    }
    centre_ = all.center();
    radius_ = 1.001 * (all.max() - centre_).norm();

    device_.reset(rtcNewDevice("threads=1,verbose=0"), rtcReleaseDevice);
    check_embree();
    scene_.reset(rtcNewScene(device_.get()), rtcReleaseScene);
    // Without this flag a line could pass between two adjacent triangles.
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                               3 * sizeof(float), mesh_.points.size()));
    auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), mesh_.corners.size()));
    check_embree();
    for (const Vector3d& point : mesh_.points) {
      for (Eigen::Index k = 0; k < 3; ++k) *points++ = static_cast<float>(point(k) - centre_(k));
    }
    for (const auto& triangle : mesh_.corners) corners = std::copy(triangle.begin(), triangle.end(), corners);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_.get());
    check_embree();
  }

  /// Embree finds the triangle in single precision, relative to the centre of the mesh. Its error is at most 1e-6 of
  /// the mesh size. The position on the triangle is then computed in double precision.
  double first_intersection(const Line& line) const override {
    const RTCRayHit ray = cast(line, 0.0F);
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? kInfinity : hit_at(line, ray.hit.primID).at;
  }

  /// Parts of a mesh may overlap. A point is therefore inside if the line has entered more surfaces than it has left.
  /// If the triangles are not oriented consistently, the surfaces count alternately as entry and exit.
  std::vector<LineInterval> intervals(const Line& line) const override {
    std::call_once(orientation_checked_, [this] { oriented_ = is_oriented(); });
    // The hits of adjacent triangles differ only by rounding. A single step passes over all of them.
    const auto step = static_cast<float>(4e-6 * radius_);
    std::vector<Hit> hits;
    int balance = 0;
    for (float from = 0.0F;;) {
      const RTCRayHit ray = cast(line, from);
      if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) break;
      hits.push_back(hit_at(line, ray.hit.primID));
      balance += hits.back().enters ? 1 : -1;
      from = ray.ray.tfar + step;
    }
    std::vector<LineInterval> out;
    int depth = 0;
    for (const Hit& one : hits) {
      const bool was = depth != 0;
      // The balance (entries minus exits) is not 0 if a step passed over only one of two close surfaces, as at a sharp
      // edge.
      depth = oriented_ && balance == 0 ? depth + (one.enters ? 1 : -1) : 1 - depth;
      if (!was) out.push_back({one.at, one.at});
      if (depth == 0) out.back().end = one.at;
    }
    if (depth != 0) out.pop_back();
    return out;
  }

  /// Bounding boxes of groups of points make it unnecessary to test most points.
  double support(const Vector3d& direction) const override {
    const std::vector<Vector3d>& points = mesh_.points;
    double best = direction.dot(points.front());
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      const Vector3d low = direction.cwiseProduct(boxes_[i].min());
      const Vector3d high = direction.cwiseProduct(boxes_[i].max());
      if (low.cwiseMax(high).sum() <= best) continue;
      const std::size_t end = std::min((i + 1) * kFew, points.size());
      for (std::size_t j = i * kFew; j < end; ++j) best = std::max(best, direction.dot(points[j]));
    }
    return best;
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  /// Returns the first hit of a ray. The ray starts where the line enters a sphere around the mesh, which keeps its
  /// coordinates small. Hits closer than `from` are ignored.
  RTCRayHit cast(const Line& line, float from) const {
    const double begin = (centre_ - line.origin).dot(line.direction) - radius_;
    const Eigen::Vector3f origin = (line.origin + begin * line.direction - centre_).cast<float>();
    const Eigen::Vector3f along = line.direction.cast<float>();
    const auto length = static_cast<float>(2.1 * radius_);
    RTCRayHit ray{{origin.x(), origin.y(), origin.z(), from, along.x(), along.y(), along.z(), 0, length, ~0U, 0, 0},
                  {}};
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if PALPATE_EMBREE == 3
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.get(), &context, &ray);
#else
    rtcIntersect1(scene_.get(), &ray);
#endif
    return ray;
  }

  /// Returns whether each edge occurs equally often in both directions, so that the triangles are oriented
  /// consistently.
  bool is_oriented() const {
    std::vector<std::uint64_t> forth, back;
    for (const auto& triangle : mesh_.corners) {
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint64_t a = triangle[i];
        const std::uint64_t b = triangle[(i + 1) % 3];
        forth.push_back(a << 32 | b);
        back.push_back(b << 32 | a);
      }
    }
    std::sort(forth.begin(), forth.end());
    std::sort(back.begin(), back.end());
    return forth == back;
  }

  struct Hit {
    double at;
    bool enters;  ///< whether the line enters the solid, if corners are counter-clockwise as seen from outside
  };
  Hit hit_at(const Line& line, unsigned number) const {
    const auto& triangle = mesh_.corners[number];
    const Vector3d a = mesh_.points[triangle[0]] - line.origin;
    const Vector3d b = mesh_.points[triangle[1]] - line.origin;
    const Vector3d c = mesh_.points[triangle[2]] - line.origin;
    const Vector3d normal = (b - a).cross(c - a);
    // A triangle parallel to the line has no unique intersection. The result is then clamped to the ends of the
    // triangle.
    const auto [least, most] = std::minmax({a.dot(line.direction), b.dot(line.direction), c.dot(line.direction)});
    const double slope = normal.dot(line.direction);
    return {slope == 0.0 ? least : std::clamp(normal.dot(a) / slope, least, most), slope < 0.0};
  }

  void check_embree() const {
    const RTCError code = rtcGetDeviceError(device_.get());
    if (code == RTC_ERROR_NONE) return;
    throw Error("", "Embree failed with code " + std::to_string(static_cast<int>(code)),
                code == RTC_ERROR_OUT_OF_MEMORY ? "the mesh does not fit into memory" : "", Error::Kind::run);
  }

  static constexpr std::size_t kFew = 64;

  Triangles mesh_;
  std::vector<Box> boxes_;  ///< bounding box of each group of kFew consecutive points
  Vector3d centre_;
  double radius_;  ///< radius of a sphere around all points
  mutable std::once_flag orientation_checked_;
  mutable bool oriented_ = false;
  std::shared_ptr<RTCDeviceTy> device_;
  std::shared_ptr<RTCSceneTy> scene_;
};

PALPATE_PLUGIN(Shape, Mesh, "mesh", "triangle mesh from an STL, OBJ or PLY file")

}  // namespace palpate::shapes
