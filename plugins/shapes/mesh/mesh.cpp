// SPDX-License-Identifier: MIT
// Objects from a file of triangles. The file is read when the config is resolved, for its hash, and when the scene is
// built.
#include "file.hpp"
#include "options.hpp"
#include "rays.hpp"
#include "triangles.hpp"

#include <palpate/plugin.hpp>
#include <palpate/shape.hpp>

#include <algorithm>
#include <vector>

namespace palpate::shapes {

/// The largest scalar product with some of many points, without looking at all: a box around each few that follow one
/// another tells whether one of them can be the best.
class Extremes {
 public:
  explicit Extremes(const std::vector<Eigen::Vector3d>& points) : points_(points) {
    for (std::size_t i = 0; i < points_.size(); i += kFew) {
      Box box{points_[i], points_[i]};
      for (std::size_t j = i; j < std::min(i + kFew, points_.size()); ++j) {
        box.least = box.least.cwiseMin(points_[j]);
        box.most = box.most.cwiseMax(points_[j]);
      }
      boxes_.push_back(box);
    }
  }

  double support(const Eigen::Vector3d& direction) const {
    double best = direction.dot(points_.front());
    for (std::size_t i = 0; i < boxes_.size(); ++i) {
      const Box& box = boxes_[i];
      const double bound = direction.cwiseProduct(box.least).cwiseMax(direction.cwiseProduct(box.most)).sum();
      if (bound <= best) continue;
      const std::size_t end = std::min((i + 1) * kFew, points_.size());
      for (std::size_t j = i * kFew; j < end; ++j) best = std::max(best, direction.dot(points_[j]));
    }
    return best;
  }

 private:
  static constexpr std::size_t kFew = 64;
  struct Box {
    Eigen::Vector3d least, most;
  };

  std::vector<Eigen::Vector3d> points_;
  std::vector<Box> boxes_;
};

class Mesh final : public Shape {
 public:
  using Options = MeshOptions;
  Mesh(const Options& options, const Context&) : Mesh(load(options)) {}

  double first_hit(const Line& line) const override { return rays_.first_hit(line); }
  double support(const Eigen::Vector3d& direction) const override { return extremes_.support(direction); }

 private:
  explicit Mesh(Triangles mesh) : extremes_(mesh.points), rays_(std::move(mesh)) {}

  static Triangles load(const Options& options) {
    const Frame frame{options.unit, options.up == MeshOptions::Up::y};
    Triangles mesh = join(import_triangles(read_file(options.file), options.file), frame, options.file);
    check_surface(mesh, options.holes == MeshOptions::Holes::allow, options.file);
    return mesh;
  }

  Extremes extremes_;
  Rays rays_;
};

}  // namespace palpate::shapes

PALPATE_PLUGIN(palpate::Shape, palpate::shapes::Mesh, "mesh", "triangles from an STL, OBJ or PLY file")
