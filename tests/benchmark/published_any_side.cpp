// SPDX-License-Identifier: MIT
// The published way to touch from any side, against which palpate's is measured: a Gaussian process over an implicit
// surface and pokes where it varies most (GPAtlasRRT, RIL 2016), on palpate's scenes, seen and touched as palpate's
// runs see and touch them. From the folder that holds configs/:
//     published_any_side --rule poke --labels own --seeds 15000:15010
//
// As published: known points have the value 0, eight anchors on a sphere of twice their extent the value 1, points of
// the free path of a poke their distance; the thin-plate covariance 2 r^3 - 3 R r^2 + R^3, in units of the largest
// distance of a known point from their centroid, computed again after every touch; a poke begins 0.7 of these outside
// of its target, along the normal, and goes 1.5.
//
// Different, and better so: R = 4 and a variance of 0.005 of each value instead of R = 2 and 0.05, because anchors are
// up to 4 apart, and beyond R the covariance is not definite. Free points stay where they are when the units change,
// and are dropped beyond the anchors; a target where nothing was met is not tried again. Contacts are exact, a tool
// comes only from where palpate's may, and the surface is compared where palpate's is: flood-filled from the known
// points, brought to the value 0 by two steps of Newton's, without the part that no tool could reach.
#include "experiment/experiment_options.hpp"
#include "solids/camera_rays.hpp"
#include "solids/candidate_lines.hpp"
#include "solids/cloud_distances.hpp"
#include "support/runs.hpp"

#include <CLI/CLI.hpp>

#include <Eigen/Dense>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <vector>

namespace palpate {
namespace {

using Eigen::ArrayXd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

struct Settings {
  std::string rule = "poke";
  std::string labels = "true";
  double elevation = 10.0;  ///< of the camera, degrees, as in configs/benchmark/any_side_view.yaml
};

/// The implicit surface: positive outside. Points given and taken in metres.
class Implicit {
 public:
  void know(const Vector3d& at) { known_.push_back(at); }
  void free(const Vector3d& at, double distance) { free_.push_back({at, distance}); }
  const Cloud& known() const { return known_; }
  double scale() const { return scale_; }

  void fit() {
    centre_.setZero();
    for (const Vector3d& at : known_) centre_ += at / static_cast<double>(known_.size());
    scale_ = 0.0;
    for (const Vector3d& at : known_) scale_ = std::max(scale_, (at - centre_).norm());
    std::vector<std::pair<Vector3d, double>> data;
    for (const Vector3d& at : known_) data.emplace_back((at - centre_) / scale_, 0.0);
    constexpr int kAround = 4;
    for (const double height : {-1.0, 1.0}) {
      for (int i = 0; i < kAround; ++i) {
        const double angle = 2.0 * kHalfTurn * i / kAround;
        const double level = std::sqrt(3.0);
        data.emplace_back(Vector3d(level * std::cos(angle), level * std::sin(angle), height), 1.0);
      }
    }
    for (const auto& [at, distance] : free_) {
      const Vector3d q = (at - centre_) / scale_;
      // Beyond the anchors points are farther apart than the covariance is meant for.
      if (q.norm() < 2.0) data.emplace_back(q, distance / scale_);
    }
    const auto n = static_cast<Eigen::Index>(data.size());
    x_.resize(n);
    y_.resize(n);
    z_.resize(n);
    VectorXd values(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto& [at, value] = data[static_cast<std::size_t>(i)];
      x_(i) = at.x();
      y_(i) = at.y();
      z_(i) = at.z();
      values(i) = value;
    }
    radius_ = kRadius;
    const auto fill = [&] {
      covariance_.resize(n, n);
      for (Eigen::Index i = 0; i < n; ++i) covariance_.col(i) = covariances({x_(i), y_(i), z_(i)});
      covariance_.diagonal().array() += kNoise;
      cholesky_.compute(covariance_);
    };
    fill();
    // Where points are nearly R apart it is not quite definite either: then a larger R.
    while (cholesky_.info() != Eigen::Success) {
      radius_ *= 1.1;
      fill();
    }
    weights_ = cholesky_.solve(values).array();
  }

  /// Value and gradient, in units of the scale.
  double value(const Vector3d& at, Vector3d& gradient) const {
    const Vector3d q = (at - centre_) / scale_;
    const ArrayXd dx = q.x() - x_, dy = q.y() - y_, dz = q.z() - z_;
    const ArrayXd squared = dx.square() + dy.square() + dz.square();
    const ArrayXd r = squared.sqrt();
    const double radius = radius_;
    const ArrayXd slope = 6.0 * weights_ * (r - radius);
    gradient = {(slope * dx).sum(), (slope * dy).sum(), (slope * dz).sum()};
    return (weights_ * (squared * (2.0 * r - 3.0 * radius) + radius * radius * radius)).sum();
  }

  VectorXd variances(const Cloud& at) const {
    MatrixXd with(x_.size(), static_cast<Eigen::Index>(at.size()));
    for (std::size_t i = 0; i < at.size(); ++i)
      with.col(static_cast<Eigen::Index>(i)) = covariances((at[i] - centre_) / scale_);
    const double prior = std::pow(radius_, 3);
    cholesky_.matrixL().solveInPlace(with);
    return prior - with.colwise().squaredNorm().transpose().array();
  }

  const Vector3d& centre() const { return centre_; }

 private:
  static constexpr double kRadius = 4.0;
  static constexpr double kNoise = 0.005;  ///< variance

  VectorXd covariances(const Vector3d& q) const {
    const ArrayXd squared = (q.x() - x_).square() + (q.y() - y_).square() + (q.z() - z_).square();
    const double radius = radius_;
    return squared * (2.0 * squared.sqrt() - 3.0 * radius) + radius * radius * radius;
  }

  Cloud known_;
  std::vector<std::pair<Vector3d, double>> free_;
  Vector3d centre_ = Vector3d::Zero();
  double scale_ = 1.0;
  double radius_ = 0.0;
  ArrayXd x_, y_, z_, weights_;
  MatrixXd covariance_;
  Eigen::LLT<MatrixXd> cholesky_;
};

/// The surface about the known points, on a grid: sheets that nothing connects with them do not count.
class Sheet {
 public:
  struct Point {
    Vector3d at, normal;
  };
  std::vector<Point> points;

  /// As far as `reach` from the centre along each axis; `step` and `reach` in units of the scale. As published a node
  /// is on it where the value is at most half a step off 0: a wall with free space on either side is one where the
  /// value comes to 0 and goes through it nowhere.
  Sheet(const Implicit& implicit, double step, double reach) : step_(step * implicit.scale()) {
    half_ = static_cast<int>(reach / step);
    side_ = 2 * half_ + 1;
    centre_ = implicit.centre();
    distances_.assign(
        static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), kUnseen);
    std::vector<Eigen::Array3i> open;
    const auto open_around = [&](const Eigen::Array3i& node) {
      for (int i = -1; i <= 1; ++i) {
        for (int j = -1; j <= 1; ++j) {
          for (int k = -1; k <= 1; ++k) {
            const Eigen::Array3i other = node + Eigen::Array3i(i, j, k);
            float* const seen = slot(other);
            if (seen == nullptr || *seen != kUnseen) continue;
            *seen = kOpen;
            open.push_back(other);
          }
        }
      }
    };
    for (const Vector3d& known : implicit.known()) {
      Vector3d at = known, gradient;
      for (int i = 0; i < 2; ++i) approach(implicit, at, gradient);
      open_around(node_of(at));
    }
    while (!open.empty()) {
      const Eigen::Array3i node = open.back();
      open.pop_back();
      Vector3d at = place(node), gradient;
      const double value = implicit.value(at, gradient);
      const double away = value / std::max(1e-9, gradient.norm()) * implicit.scale();
      *slot(node) = static_cast<float>(away);
      if (std::abs(away) > 0.6 * step_ && std::abs(value) > 0.5 * step) continue;
      open_around(node);
      if (at.z() < -step_) continue;  // within the desk
      Vector3d moved = at;
      for (int i = 0; i < 2; ++i) approach(implicit, moved, gradient);
      if ((moved - at).norm() <= step_ && std::abs(implicit.value(moved, gradient)) < std::abs(value)) at = moved;
      if (at.z() < 0.0 || !(gradient.norm() > 1e-9)) continue;
      points.push_back({at, gradient.normalized()});
    }
  }

  /// What a tool could touch that comes in one of these directions.
  Cloud reachable(const std::vector<Vector3d>& directions) const {
    Cloud out;
    for (const Point& point : points) {
      const bool seen = std::any_of(directions.begin(), directions.end(), [&](const Vector3d& direction) {
        return direction.dot(point.normal) < -0.1 && is_clear(point.at, -direction);
      });
      if (seen) out.push_back(point.at);
    }
    return out;
  }

 private:
  static constexpr float kUnseen = 1e30F;
  static constexpr float kOpen = 2e30F;

  void approach(const Implicit& implicit, Vector3d& at, Vector3d& gradient) const {
    const double value = implicit.value(at, gradient);
    Vector3d move = -value * implicit.scale() / std::max(1e-12, gradient.squaredNorm()) * gradient;
    if (move.norm() > step_) move *= step_ / move.norm();
    at += move;
  }
  bool is_clear(const Vector3d& from, const Vector3d& outwards) const {
    for (double way = 2.0 * step_;; way += 0.7 * step_) {
      const Vector3d at = from + way * outwards;
      if (at.z() < 0.0) return false;
      const float* const distance = const_cast<Sheet*>(this)->slot(node_of(at));
      if (distance == nullptr) return true;
      if (*distance < -0.5 * step_) return false;
    }
  }
  Eigen::Array3i node_of(const Vector3d& at) const {
    return ((at - centre_) / step_).array().round().cast<int>() + half_;
  }
  Vector3d place(const Eigen::Array3i& node) const { return centre_ + step_ * (node - half_).cast<double>().matrix(); }
  float* slot(const Eigen::Array3i& node) {
    if ((node < 0).any() || (node >= side_).any()) return nullptr;
    return &distances_[(static_cast<std::size_t>(node.x()) * static_cast<std::size_t>(side_) +
                        static_cast<std::size_t>(node.y())) *
                           static_cast<std::size_t>(side_) +
                       static_cast<std::size_t>(node.z())];
  }

  double step_;
  int half_ = 0, side_ = 0;
  Vector3d centre_;
  std::vector<float> distances_;  ///< to the surface, by the gradient, of nodes that were looked at
};

/// One run: a scene as a seed turns it.
class Run {
 public:
  Run(const Settings& settings, const std::string& scene, int seed)
      : settings_(settings),
        config_(test::shipped_config("any_side.yaml", {"scene=" + scene, "seed=" + std::to_string(seed)})),
        scene_(build_scene(config_.options.scene, static_cast<std::uint64_t>(seed), test::shared_host())),
        region_(scene_->area()),
        bundle_(region_.centre, region_.outside(), 150, 0.006),
        random_(static_cast<std::uint64_t>(seed), "published") {
    for (const Line& line : bundle_.lines) {
      if (directions_.empty() || directions_.back() != line.direction) directions_.push_back(line.direction);
      const double hit = scene_->first_intersection(line);
      if (hit < distance_down_to(0.0, line)) truth_.push_back(line.origin + hit * line.direction);
    }
    fine_truth_ = thinned(truth_, 0.001);
    truth_ = thinned(truth_, kSide);
    // The view that palpate's runs have of this seed.
    SideViewOptions view;
    view.elevation = settings.elevation / 180.0 * kHalfTurn;
    Cloud seen;
    for (const SurfaceTouch& ray : side_view(view, *scene_, region_.centre, region_.radius,
                                             Random(static_cast<std::uint64_t>(seed), "space/view"))) {
      if (ray.contact && !ray.desk) seen.push_back(ray.end());
    }
    for (const Vector3d& at : thinned(seen, 0.006)) implicit_.know(at);
    implicit_.fit();
  }

  int touches() const { return touches_; }

  void touch() {
    const std::optional<Sheet::Point> target = next_target();
    if (!target) {
      touch_at_random();
    } else {
      const double scale = implicit_.scale();
      const Vector3d start = target->at + 0.7 * scale * target->normal;
      if (!poke({start, -target->normal}, 1.5 * scale)) failed_.push_back(target->at);
    }
    implicit_.fit();
  }

  CloudErrors errors() const {
    const Sheet sheet(implicit_, 0.02, 1.5);
    return compare_clouds(sheet.reachable(directions_), fine_truth_);
  }

 private:
  static constexpr double kSide = 0.003;

  std::optional<Sheet::Point> next_target() {
    std::vector<Sheet::Point> targets;
    const double scale = implicit_.scale();
    for (const Sheet::Point& point : Sheet(implicit_, 0.06, 1.1).points) {
      const Vector3d start = point.at + 0.7 * scale * point.normal;
      const bool tried = std::any_of(failed_.begin(), failed_.end(),
                                     [&](const Vector3d& at) { return (at - point.at).norm() < 0.1 * scale; });
      if (point.normal.z() >= -0.5 && start.z() > 0.0 && !tried) targets.push_back(point);
    }
    if (targets.empty()) return std::nullopt;
    if (settings_.rule == "random") return targets[random_.index(targets.size())];
    Cloud at;
    for (const Sheet::Point& point : targets) at.push_back(point.at);
    Eigen::Index best = 0;
    implicit_.variances(at).maxCoeff(&best);
    return targets[static_cast<std::size_t>(best)];
  }

  /// Whether an object was met.
  bool poke(const Line& line, double length) {
    ++touches_;
    // The tool comes along the whole line: what stands before its start is met there.
    const double hit = scene_->first_intersection(line);
    const double end = std::min({hit, distance_down_to(0.0, line), length});
    const bool met = hit == end;
    if (met) implicit_.know(line.origin + hit * line.direction);
    const double scale = implicit_.scale();
    const double step = 0.03 * scale;
    int waits = 0;
    for (double way = 0.0; way < end; way += step) {
      if (waits-- > 0) continue;
      const Vector3d at = line.origin + way * line.direction;
      const double distance = distance_to(settings_.labels == "true" ? truth_ : implicit_.known(), at);
      if (distance < 0.2 * scale || distance > scale) continue;
      implicit_.free(at, distance);
      waits = 20;
    }
    return met;
  }

  void touch_at_random() {
    while (true) {
      const Vector3d direction = directions_[random_.index(directions_.size())];
      const double away = region_.radius * std::sqrt(random_.uniform());
      const double turn = 2.0 * kHalfTurn * random_.uniform();
      const Vector3d aside = direction.unitOrthogonal();
      const Vector3d through =
          region_.centre + away * (std::cos(turn) * aside + std::sin(turn) * direction.cross(aside));
      const Line line{through - region_.outside() * direction, direction};
      if (line.origin.z() <= 0.0) continue;
      poke(line, 2.0 * region_.outside());
      return;
    }
  }

  static double distance_to(const Cloud& cloud, const Vector3d& at) {
    double least = kNoHit;
    for (const Vector3d& one : cloud) least = std::min(least, (one - at).squaredNorm());
    return std::sqrt(least);
  }

  const Settings& settings_;
  ResolvedConfig config_;
  std::unique_ptr<const Scene> scene_;
  SearchBall region_;
  LineBundle bundle_;
  Random random_;
  Implicit implicit_;
  std::vector<Vector3d> directions_;
  Cloud truth_, fine_truth_, failed_;
  int touches_ = 0;
};

struct Sums {
  int runs = 0;
  double mean = 0.0, missing = 0.0, extra = 0.0, f_score = 0.0;
  void add(const CloudErrors& errors) {
    ++runs;
    mean += errors.mean;
    missing += errors.of_truth;
    extra += errors.of_belief;
    f_score += errors.f_score;
  }
  void print(const std::string& name, int touches) const {
    const double n = runs;
    fmt::print("| {} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.2f} |\n", name, touches, runs, 1e3 * mean / n,
               1e3 * missing / n, 1e3 * extra / n, f_score / n);
    std::fflush(stdout);
  }
};

int table(const Settings& settings, const std::vector<std::string>& scenes, int first, int last,
          const std::vector<int>& marks) {
  fmt::print("| scene | touches | runs | nearest mm | missing mm | extra mm | F at 5 mm |\n");
  fmt::print("|---|---:|---:|---:|---:|---:|---:|\n");
  std::vector<Sums> all(marks.size());
  for (const std::string& scene : scenes) {
    std::vector<Sums> here(marks.size());
    for (int seed = first; seed < last; ++seed) {
      Run run(settings, scene, seed);
      for (std::size_t i = 0; i < marks.size(); ++i) {
        while (run.touches() < marks[i]) run.touch();
        const CloudErrors errors = run.errors();
        here[i].add(errors);
        all[i].add(errors);
      }
    }
    for (std::size_t i = 0; i < marks.size(); ++i) here[i].print(scene, marks[i]);
  }
  for (std::size_t i = 0; i < marks.size(); ++i) all[i].print("all", marks[i]);
  return 0;
}

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
  palpate::Settings settings;
  std::string seeds = "15000:15010";
  std::vector<std::string> scenes{"any_bowl",   "any_jug",     "any_mug",     "any_lidded_box",
                                  "any_bottle", "any_bracket", "any_leaning", "any_two"};
  std::vector<int> marks{0, 8, 19, 40};
  CLI::App app{"The published way to touch from any side, on palpate's scenes"};
  app.add_option("--rule", settings.rule, "poke: where the variance is largest; random: anywhere on the surface")
      ->check(CLI::IsMember({"poke", "random"}));
  app.add_option("--labels", settings.labels, "of free points: true, as published, or own, to the nearest contact")
      ->check(CLI::IsMember({"true", "own"}));
  app.add_option("--elevation", settings.elevation, "of the camera, degrees");
  app.add_option("--seeds", seeds, "FIRST:BEHIND_THE_LAST");
  app.add_option("--scenes", scenes, "of configs/scene")->delimiter(',');
  app.add_option("--at", marks, "touches")->delimiter(',');
  CLI11_PARSE(app, count, words);
  try {
    const std::size_t colon = seeds.find(':');
    return palpate::table(settings, scenes, std::stoi(seeds), std::stoi(seeds.substr(colon + 1)), marks);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
