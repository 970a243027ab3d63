// SPDX-License-Identifier: MIT
#include "solids/surface_errors.hpp"

#include <algorithm>

namespace palpate {
namespace {

// Lines from 150 directions, 6 mm apart: some of them meet every patch of a surface that a finger can touch.
constexpr int kDirections = 150;
constexpr double kPitch = 0.006;
constexpr double kSide = 0.001;  // metres: side of the cubes that keep one point of a surface each
// Metres. A cube is solid if its centre is in a solid, so a wall of 3 mm has about the right volume only on average.
constexpr double kCube = 0.004;

}  // namespace

Cloud surface_points(const LineBundle& lines, double side, const AssemblySampler& solids,
                     const ResidualGp& residual_gp) {
  const Assembly& best = solids.best();
  Cloud points;
  for (const Line& line : lines.lines) {
    const double hit = best.first_intersection(line);
    if (hit < distance_down_to(0.0, line)) points.emplace_back(line.origin + hit * line.direction);
  }
  ResidualGp::Places places;
  for (const Eigen::Vector3d& at : thinned(points, side)) places.push_back({at, best.normal(at)});
  const Eigen::VectorXd means = residual_gp.means(places);
  Cloud out;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Eigen::Vector3d moved = places[i].at + means(static_cast<Eigen::Index>(i)) * places[i].normal;
    moved.z() = std::max(0.0, moved.z());  // nothing lies below the desk
    out.push_back(moved);
  }
  return out;
}

Eigen::VectorXd surface_std(const Cloud& points, const AssemblySampler& solids, const ResidualGp& residual_gp) {
  ResidualGp::Places places;
  for (const Eigen::Vector3d& at : points) places.push_back({at, solids.best().normal(at)});
  Eigen::VectorXd squares = residual_gp.posterior(places).variance;
  const auto assemblies = static_cast<double>(solids.assemblies().size());
  for (std::size_t i = 0; i < points.size(); ++i)
    squares(static_cast<Eigen::Index>(i)) += solids.offsets(points[i]).squaredNorm() / assemblies;
  return squares.cwiseSqrt();
}

SurfaceErrors::SurfaceErrors(const SearchBall& region)
    : lines_(region.centre, region.outside(), kDirections, kPitch), cubes_(region.centre, region.outside(), kCube) {}

void SurfaceErrors::set_truth(const Scene* scene) {
  scene_ = scene;
  truth_.reset();
}

const SurfaceErrors::Truth& SurfaceErrors::truth() {
  if (truth_) return *truth_;
  truth_.emplace();
  if (scene_ == nullptr) return *truth_;
  const Eigen::Vector3d desk(0.0, 0.0, scene_->desk());
  for (const Line& line : lines_.lines) {
    const double hit = scene_->first_intersection({line.origin + desk, line.direction});
    if (hit < distance_down_to(0.0, line)) truth_->points.push_back(line.origin + hit * line.direction);
  }
  truth_->points = thinned(truth_->points, kSide);
  truth_->cubes = cubes_.of(*scene_);
  return *truth_;
}

Errors SurfaceErrors::compare(const AssemblySampler* solids, const ResidualGp& residual_gp) {
  if (truth().points.empty()) return {};
  const Cloud points = solids != nullptr ? surface_points(lines_, kSide, *solids, residual_gp) : Cloud();
  const CloudErrors errors = compare_clouds(points, truth().points);
  Errors out;
  out.rms_surface_distance = errors.rms;
  out.rmse_object = errors.rms_of_truth;
  out.surface_distance = errors.mean;
  out.f_score = errors.f_score;
  if (solids != nullptr) out.coverage = coverage(points, *solids, residual_gp);
  const Cubes::Held& cubes = truth().cubes;
  if (std::find(cubes.begin(), cubes.end(), true) == cubes.end()) return out;  // the objects are thinner than a cube
  out.volume_iou = solids != nullptr ? intersection_over_union(cubes_.of(solids->best(), residual_gp), cubes) : 0.0;
  return out;
}

std::optional<double> SurfaceErrors::coverage(const Cloud& points, const AssemblySampler& solids,
                                              const ResidualGp& residual_gp) {
  if (points.empty()) return std::nullopt;
  constexpr double kOf95Percent = 1.96;
  constexpr double kApart = 0.006;
  const Cloud some = thinned(points, kApart);
  const Eigen::VectorXd deviations = surface_std(some, solids, residual_gp);
  const std::vector<double> distances = nearest_distances(some, truth().points);
  const auto within =
      Eigen::Map<const Eigen::ArrayXd>(distances.data(), deviations.size()) <= kOf95Percent * deviations.array();
  return within.cast<double>().mean();
}

}  // namespace palpate
