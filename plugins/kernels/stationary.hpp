// SPDX-License-Identifier: MIT
// What the stationary kernels share: length scales, and a covariance that is a function of the scaled distance.
#pragma once

#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>
#include <palpate/simd.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace palpate::kernels {

struct StationaryOptions : Options {
  double length_scale = 0.017;
  std::optional<double> length_scale_y;

  void list(Fields& fields) override {
    fields.real(length_scale,
                Field("length_scale", "length scale, the distance over which heights are correlated")
                    .in(Unit::metre)
                    .above(0)
                    .from("Sun and Min 2021 give 'sigma^2 = 0.017' without unit; 1.7 cm reproduces their counts"));
    fields.real(length_scale_y,
                Field("length_scale_y",
                      "length scale along y; not given: length_scale. If given, length_scale applies along x only")
                    .in(Unit::metre)
                    .above(0));
  }
};

/// A kernel of unit variance, k(a, b) = f(r^2) with r^2 = ((a_x - b_x) / l_x)^2 + ((a_y - b_y) / l_y)^2.
///
/// `Shape` is f and its parameters beyond the length scales, of which there may be none; for the loops
/// of simd.hpp:
///     using Options;                             derived from StationaryOptions
///     static constexpr double kFarthest;         squares of scaled distances end here, so that none is infinite and no
///                                                product with a covariance near 0 is no number
///     explicit Shape(const Options&);
///     double value(r2) const;                    f; r2 up to 2 kFarthest
///     double slope(r2, k) const;                 k = f and -2 df/dr^2, which is returned
///     std::vector<KernelParameter> parameters() const;
///     void set_parameters(values);
///     static constexpr bool kOwn;                one parameter beyond the length scales, or none, and of that
///     double own_slope(r2, k) const;              dk/d log parameter
///     static constexpr bool kSeparable;          f(a + b) = f(a) f(b)
///     static constexpr bool kSlopes;             f has two derivatives by r everywhere, and of these
///     double bend(r2) const;                     -d^2 f / dr^2, its limit at r = 0; slope(0) is finite, too
template <class Shape>
class Stationary final : public Kernel {
 public:
  using Options = typename Shape::Options;

  Stationary(const Options& options, const Context& context)
      : shape_(options),
        lanes_(context.lanes),
        along_x_(options.length_scale),
        along_y_(options.length_scale_y.value_or(options.length_scale)),
        per_axis_(options.length_scale_y.has_value()) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    // Two loops: one would be a chain of instructions too long for a processor to work on many of them at once.
    const Columns to(out);
    simd::for_each(lanes_, a.rows(), b.rows(),
                   [to, x = Scaled(a.col(0), b.col(0), along_x_), y = Scaled(a.col(1), b.col(1), along_y_)](
                       Eigen::Index i, Eigen::Index j) { to(i, j) = x(i, j) + y(i, j); });
    simd::for_each(lanes_, a.rows(), b.rows(),
                   [to, shape = shape_](Eigen::Index i, Eigen::Index j) { to(i, j) = shape.value(to(i, j)); });
  }

  void variance(const PointsView& a, VectorOut out) const override { out.head(a.rows()).setOnes(); }

  bool separable() const override { return Shape::kSeparable; }

  void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const override {
    simd::for_each(lanes_, a.size(), b.size(),
                   [x = Scaled(a, b, axis == 0 ? along_x_ : along_y_), shape = shape_, to = Columns(out)](
                       Eigen::Index i, Eigen::Index j) { to(i, j) = shape.value(x(i, j)); });
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

  bool has_gradient() const override { return Shape::kSlopes && !per_axis_; }

  void gradient_covariance(const VectorView& distances, VectorOut across, VectorOut along) const override {
    if constexpr (Shape::kSlopes) {
      const double per_length = std::min(1.0 / along_x_, kLargestWithSquare);
      for (Eigen::Index i = 0; i < distances.size(); ++i) {
        const double scaled = std::min(distances(i) * per_length, kLargestWithSquare);
        const double r2 = std::min(scaled * scaled, Shape::kFarthest);
        double value = 0.0;
        across(i) = shape_.slope(r2, value) * per_length * per_length;
        along(i) = shape_.bend(r2) * per_length * per_length;
      }
    }
  }

  void derivatives(const PointsView& a, const PointsView& b, MatrixOut value, MatrixOut slopes) const override {
    const Eigen::Index m = b.rows();
    const Columns along(slopes);
    const Columns along_y(slopes.rightCols(slopes.cols() - (axes() - 1) * m));
    const Columns own(slopes.rightCols(slopes.cols() - axes() * m));
    const auto pair = [=, x = Scaled(a.col(0), b.col(0), along_x_), y = Scaled(a.col(1), b.col(1), along_y_),
                       shape = shape_, to = Columns(value)](Eigen::Index i, Eigen::Index j, bool per_axis) {
      const double x2 = x(i, j);
      const double y2 = y(i, j);
      const double g = shape.slope(x2 + y2, to(i, j));
      along(i, j) = per_axis ? g * x2 : g * (x2 + y2);
      if (per_axis) along_y(i, j) = g * y2;
      if constexpr (Shape::kOwn) own(i, j) = shape.own_slope(x2 + y2, to(i, j));
    };
    if (per_axis_) {
      simd::for_each(lanes_, a.rows(), m, [pair](Eigen::Index i, Eigen::Index j) { pair(i, j, true); });
    } else {
      simd::for_each(lanes_, a.rows(), m, [pair](Eigen::Index i, Eigen::Index j) { pair(i, j, false); });
    }
  }

 private:
  Eigen::Index axes() const { return per_axis_ ? 2 : 1; }

  /// Squares of the distances along an axis, in length scales. A multiplication is a quarter of a division's work.
  struct Scaled {
    template <class Column, class Other>
    Scaled(const Column& a, const Other& b, double scale)
        : places(a.data()), others(b.data()), per_length(std::min(1.0 / scale, kLargest)) {}

    PALPATE_INLINE double operator()(Eigen::Index i, Eigen::Index j) const {
      const double scaled = (places[i] - others[j]) * per_length;
      return simd::min(scaled * scaled, Shape::kFarthest);
    }
    const double* places;
    const double* others;
    double per_length;
  };
  /// Of a length scale so small that it has no reciprocal.
  static constexpr double kLargest = std::numeric_limits<double>::max();
  static constexpr double kLargestWithSquare = 1e150;

  /// What is written to.
  struct Columns {
    explicit Columns(MatrixOut matrix) : numbers(matrix.data()), stride(matrix.outerStride()) {}
    PALPATE_INLINE double& operator()(Eigen::Index i, Eigen::Index j) const { return numbers[i + j * stride]; }

    double* numbers;
    Eigen::Index stride;
  };

  Shape shape_;
  simd::Lanes lanes_;
  double along_x_;
  double along_y_;
  bool per_axis_;
};

/// The part of a shape that has no parameters of its own.
struct PlainShape {
  using Options = StationaryOptions;
  /// Exponentials of it, and of its root, are the smallest that there are: as good as 0 also times this.
  static constexpr double kFarthest = 1e8;
  static constexpr bool kSeparable = false;
  static constexpr bool kOwn = false;
  static constexpr bool kSlopes = false;
  explicit PlainShape(const Options&) {}
  std::vector<KernelParameter> parameters() const { return {}; }
  void set_parameters(const VectorView&) {}
};

}  // namespace palpate::kernels
