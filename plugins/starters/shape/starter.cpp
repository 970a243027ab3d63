// Form of an object, here an ellipsoid on the desk. Intersections are computed in coordinates in which the ellipsoid is
// the unit sphere.
#include <palpate/plugin.hpp>
#include <palpate/shape.hpp>

#include <cmath>
#include <limits>

using namespace palpate;

struct MyShapeOptions : Options {
  double length = 0.12;
  double width = 0.08;
  double height = 0.05;

  void list(Fields& fields) override {
    fields.real(length, Field("length", "size along x, before the object is rotated").in(Unit::metre).above(0));
    fields.real(width, Field("width", "size along y, before the object is rotated").in(Unit::metre).above(0));
    fields.real(height, Field("height", "height of the top above the desk").in(Unit::metre).above(0));
  }
};

class MyShape final : public Shape {
 public:
  using Options = MyShapeOptions;
  MyShape(const Options& options, const Context&) : half_(options.length / 2, options.width / 2, options.height / 2) {}

  double first_intersection(const Line& line) const override {
    const Eigen::Vector3d origin = (line.origin - Eigen::Vector3d(0, 0, half_.z())).cwiseQuotient(half_);
    const Eigen::Vector3d direction = line.direction.cwiseQuotient(half_);
    const double nearest = -origin.dot(direction) / direction.squaredNorm();
    const double inside = 1 - (origin + nearest * direction).squaredNorm();
    if (inside < 0) return std::numeric_limits<double>::infinity();
    return nearest - std::sqrt(inside / direction.squaredNorm());
  }

  double support(const Eigen::Vector3d& direction) const override {
    return direction.z() * half_.z() + direction.cwiseProduct(half_).norm();
  }

 private:
  Eigen::Vector3d half_;
};

PALPATE_PLUGIN(Shape, MyShape, "starter", "custom shape: an ellipsoid")
