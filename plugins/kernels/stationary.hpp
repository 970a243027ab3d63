// SPDX-License-Identifier: MIT
// What the stationary kernels share: length scales, and a covariance that is a function of the scaled distance.
#pragma once

#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <optional>

namespace palpate::kernels {

struct StationaryOptions : Options {
  double length_scale = 0.017;
  std::optional<double> length_scale_y;

  void list(Fields& fields) override {
    fields.real(length_scale,
                Field("length_scale", "distance over which heights stay alike")
                    .in(Unit::metre)
                    .above(0)
                    .from("Sun and Min 2021 give 'sigma^2 = 0.017' without unit; 1.7 cm reproduces their counts"));
    fields.real(length_scale_y,
                Field("length_scale_y", "the same along y, where it differs; length_scale is then that along x")
                    .in(Unit::metre)
                    .above(0));
  }
};

/// A piece of a column of a covariance matrix, small enough for the stack and the first cache.
constexpr Eigen::Index kChunk = 128;
using Chunk = Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, kChunk, 1>;

/// A kernel of unit variance, k(a, b) = f(r^2) with r^2 = ((a_x - b_x) / l_x)^2 + ((a_y - b_y) / l_y)^2.
///
/// `Shape` is f and its parameters beyond the length scales, of which there may be none:
///     using Options;                             derived from StationaryOptions
///     static constexpr double kFarthest;         squares of scaled distances end here in slopes, so that no infinity
///                                                meets a covariance of 0 and becomes NaN
///     explicit Shape(const Options&);
///     void apply(r2) const;                      f, in place; r2 up to infinity
///     void slopes(r2, k, g) const;               k = f and g = -2 df/dr^2; r2 up to 2 kFarthest
///     std::vector<KernelParameter> parameters() const;
///     void set_parameters(values);
///     void own_slopes(r2, k, out) const;         out(i, p) = dk/d log parameter p
///     static constexpr bool kSeparable;          f(a + b) = f(a) f(b)
template <class Shape>
class Stationary final : public Kernel {
 public:
  using Options = typename Shape::Options;

  Stationary(const Options& options, const Context&)
      : shape_(options),
        along_x_(options.length_scale),
        along_y_(options.length_scale_y.value_or(options.length_scale)),
        per_axis_(options.length_scale_y.has_value()) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    for (Eigen::Index j = 0; j < b.rows(); ++j) {
      auto column = out.col(j).array();
      // Dividing before squaring keeps r^2 finite for any representable pair of length scale and distance.
      column = ((a.col(0).array() - b(j, 0)) / along_x_).square() + ((a.col(1).array() - b(j, 1)) / along_y_).square();
      shape_.apply(column);
    }
  }

  void variance(const PointsView& a, VectorOut out) const override { out.head(a.rows()).setOnes(); }

  bool separable() const override { return Shape::kSeparable; }

  void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const override {
    const double length_scale = axis == 0 ? along_x_ : along_y_;
    for (Eigen::Index j = 0; j < b.size(); ++j) {
      auto column = out.col(j).array();
      column = ((a.array() - b(j)) / length_scale).square();
      shape_.apply(column);
    }
  }

  std::vector<KernelParameter> parameters() const override {
    std::vector<KernelParameter> out{{"length_scale", along_x_, Unit::metre}};
    if (per_axis_) out.push_back({"length_scale_y", along_y_, Unit::metre});
    const std::vector<KernelParameter> own = shape_.parameters();
    out.insert(out.end(), own.begin(), own.end());
    return out;
  }

  bool differentiable() const override { return true; }

  void set_parameters(const VectorView& values) override {
    along_x_ = values(0);
    along_y_ = per_axis_ ? values(1) : values(0);
    shape_.set_parameters(values.tail(values.size() - axes()));
  }

  void derivatives(const PointsView& a, const PointsView& b, VectorOut value, MatrixOut slopes) const override {
    for (Eigen::Index from = 0; from < a.rows(); from += kChunk) {
      const Eigen::Index count = std::min(kChunk, a.rows() - from);
      const Chunk x2 = ((a.col(0).segment(from, count).array() - b(0, 0)) / along_x_).square().min(Shape::kFarthest);
      const Chunk y2 = ((a.col(1).segment(from, count).array() - b(0, 1)) / along_y_).square().min(Shape::kFarthest);
      const Chunk r2 = x2 + y2;
      Chunk k(count);
      Chunk g(count);
      shape_.slopes(r2, k, g);
      value.segment(from, count) = k;
      auto out = slopes.middleRows(from, count);
      if (per_axis_) {
        out.col(0) = g * x2;
        out.col(1) = g * y2;
      } else {
        out.col(0) = g * r2;
      }
      shape_.own_slopes(r2, k, out.rightCols(out.cols() - axes()));
    }
  }

 private:
  Eigen::Index axes() const { return per_axis_ ? 2 : 1; }

  Shape shape_;
  double along_x_;
  double along_y_;
  bool per_axis_;
};

/// The part of a shape that has no parameters of its own.
struct PlainShape {
  using Options = StationaryOptions;
  /// Exponentials of it are 0, or the smallest normal number, where Eigen's packets stop: 0 also times this.
  static constexpr double kFarthest = 1e8;
  static constexpr bool kSeparable = false;
  explicit PlainShape(const Options&) {}
  std::vector<KernelParameter> parameters() const { return {}; }
  void set_parameters(const VectorView&) {}
  void own_slopes(const Chunk&, const Chunk&, const MatrixOut&) const {}
};

}  // namespace palpate::kernels
