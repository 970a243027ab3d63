// SPDX-License-Identifier: MIT
#include "rays.hpp"

#include <palpate/error.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>

#if PALPATE_EMBREE == 3
#include <embree3/rtcore.h>
#else
#include <embree4/rtcore.h>
#endif

namespace palpate::shapes {

using Eigen::Vector3d;

struct Rays::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Embree() {
    if (scene != nullptr) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }

  void check() const {
    const RTCError code = rtcGetDeviceError(device);
    if (code == RTC_ERROR_NONE) return;
    throw Error("", "Embree failed with code " + std::to_string(static_cast<int>(code)),
                code == RTC_ERROR_OUT_OF_MEMORY ? "the memory does not suffice for the mesh" : "", Error::Kind::run);
  }
};

Rays::Rays(Triangles mesh) : mesh_(std::move(mesh)), embree_(std::make_unique<Embree>()) {
  Vector3d least = mesh_.points.front();
  Vector3d most = least;
  for (const Vector3d& point : mesh_.points) {
    least = least.cwiseMin(point);
    most = most.cwiseMax(point);
  }
  centre_ = (least + most) / 2;
  radius_ = 1.001 * (most - centre_).norm();

  embree_->device = rtcNewDevice("threads=1,verbose=0");
  embree_->check();
  embree_->scene = rtcNewScene(embree_->device);
  // Else a line could slip through between two triangles.
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                             3 * sizeof(float), mesh_.points.size()));
  auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), mesh_.corners.size()));
  embree_->check();
  for (const Vector3d& point : mesh_.points) {
    for (Eigen::Index k = 0; k < 3; ++k) *points++ = static_cast<float>(point(k) - centre_(k));
  }
  for (const auto& triangle : mesh_.corners) corners = std::copy(triangle.begin(), triangle.end(), corners);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(embree_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(embree_->scene);
  embree_->check();
}

Rays::~Rays() = default;

double Rays::first_hit(const Line& line) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  // The ray begins where the line enters a ball around the mesh, so that its numbers are small.
  const double begin = (centre_ - line.origin).dot(line.direction) - radius_;
  const Vector3d origin = line.origin + begin * line.direction - centre_;
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(origin.x());
  ray.ray.org_y = static_cast<float>(origin.y());
  ray.ray.org_z = static_cast<float>(origin.z());
  ray.ray.dir_x = static_cast<float>(line.direction.x());
  ray.ray.dir_y = static_cast<float>(line.direction.y());
  ray.ray.dir_z = static_cast<float>(line.direction.z());
  ray.ray.tfar = static_cast<float>(2.1 * radius_);
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if PALPATE_EMBREE == 3
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(embree_->scene, &context, &ray);
#else
  rtcIntersect1(embree_->scene, &ray);
#endif
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return kInfinity;

  const auto& triangle = mesh_.corners[ray.hit.primID];
  const Vector3d a = mesh_.points[triangle[0]] - line.origin;
  const Vector3d b = mesh_.points[triangle[1]] - line.origin;
  const Vector3d c = mesh_.points[triangle[2]] - line.origin;
  const Vector3d normal = (b - a).cross(c - a);
  // A triangle along the line, a wall, has no single point on it, but the hit lies between its ends.
  const auto [least, most] = std::minmax({a.dot(line.direction), b.dot(line.direction), c.dot(line.direction)});
  const double slope = normal.dot(line.direction);
  return slope == 0.0 ? least : std::clamp(normal.dot(a) / slope, least, most);
}

}  // namespace palpate::shapes
