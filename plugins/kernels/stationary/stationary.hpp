// SPDX-License-Identifier: MIT
// Common part of the stationary kernels: length scales, and the covariance as a function of the scaled distance.
#pragma once

#include "kernels/stationary/squared_distances.hpp"

#include <palpate/kernel.hpp>
#include <palpate/math.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
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

/// View of consecutive numbers of a matrix, at most kBlock of them.
using Numbers = Eigen::Map<Eigen::ArrayXd>;
constexpr Eigen::Index kBlock = 256;
/// Temporary numbers on the stack, at most kBlock of them.
using Block = Eigen::Array<double, Eigen::Dynamic, 1, 0, kBlock, 1>;

/// Replaces each number x by e^x.
inline void take_exponentials(Numbers numbers) { math::exp(numbers.data(), numbers.size(), numbers.data()); }

/// A kernel of unit variance, k(a, b) = f(z) with z = kScale * (((a_x - b_x) / l_x)^2 + ((a_y - b_y) / l_y)^2).
///
/// `Shape` defines f and its parameters other than the length scales. Below, r^2 is z / kScale:
///     using Options;                             derived from StationaryOptions
///     static constexpr double kScale;
///     static constexpr double kFarthest;         upper limit of squared scaled distances, to avoid infinity and NaN
///     explicit Shape(const Options&);
///     void values(Numbers z) const;              z -> f, in place; r^2 up to 2 * kFarthest
///     void slopes(Numbers z, Numbers slope) const;            z -> f, in place; slope = -2 df / d(r^2)
///     std::vector<KernelParameter> parameters() const;
///     void set_parameters(values);
///     static constexpr bool kOwn;                whether there is one parameter other than length scales; if so:
///     void own_slopes(z, k, Numbers slope) const;             dk / d log parameter
///     static constexpr bool kSeparable;          f(a + b) = f(a) * f(b)
///     static constexpr bool kSlopes;             whether f has two derivatives by r everywhere; if so:
///     void bends(Numbers z) const;               z -> -d^2 f / dr^2, in place; at r = 0 the limit. slopes() must be
///                                                finite at r = 0, too
template <class Shape>
class StationaryKernel final : public Kernel {
 public:
  using Options = typename Shape::Options;

  StationaryKernel(const Options& options, const Context&)
      : shape_(options),
        along_x_(options.length_scale),
        along_y_(options.length_scale_y.value_or(options.length_scale)),
        per_axis_(options.length_scale_y.has_value()) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    take_values(of_both_axes(a, b), b.rows(), out);
  }

  void variance(const PointsView& a, VectorOut out) const override { out.head(a.rows()).setOnes(); }

  bool separable() const override { return Shape::kSeparable; }

  void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const override {
    take_values({a.size(), 1, {a.data()}, {b.data()}, {per_length(axis == 0 ? along_x_ : along_y_)}}, b.size(), out);
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
      constexpr double kLargestWithSquare = 1e150;
      const double scale = std::min(1.0 / along_x_, kLargestWithSquare);
      for (Eigen::Index first = 0; first < distances.size(); first += kBlock) {
        const Eigen::Index count = std::min(kBlock, distances.size() - first);
        const Block r2 =
            (distances.segment(first, count).array() * scale).min(kLargestWithSquare).square().min(Shape::kFarthest);
        Block z = Shape::kScale * r2;
        Numbers bend(along.data() + first, count);
        bend = z;
        shape_.bends(bend);
        shape_.slopes(Numbers(z.data(), count), Numbers(across.data() + first, count));
      }
      across *= scale * scale;
      along *= scale * scale;
    }
  }

  void derivatives(const PointsView& a, const PointsView& b, MatrixOut value, MatrixOut slopes) const override {
    // Distance in memory between the derivatives by one parameter and those by the next parameter.
    const Eigen::Index next = b.rows() * slopes.outerStride();
    const Pairs both = of_both_axes(a, b);
    for_blocks(a.rows(), b.rows(), {&value, &slopes}, [&](Eigen::Index first, Eigen::Index count) {
      Numbers k(place(value, first), count);
      squared_distances(both, first, count, Shape::kFarthest, Shape::kScale, k.data());
      const Block z = k;
      Block slope(count);
      shape_.slopes(k, Numbers(slope.data(), count));
      double* const by = place(slopes, first);
      if (per_axis_) {
        for (int axis = 0; axis < 2; ++axis) {
          const Pairs one{both.n, 1, {both.places[axis]}, {both.others[axis]}, {both.per_length[axis]}};
          squared_distances(one, first, count, Shape::kFarthest, 1.0, by + axis * next);
          Numbers(by + axis * next, count) *= slope;
        }
      } else {
        Numbers(by, count) = slope * z * (1.0 / Shape::kScale);
      }
      if constexpr (Shape::kOwn) shape_.own_slopes(z, k, Numbers(by + axes() * next, count));
    });
  }

 private:
  Eigen::Index axes() const { return per_axis_ ? 2 : 1; }

  /// Calls use(first, count) for blocks of the pairs of n positions with m other positions, in column order. The
  /// numbers of a block are contiguous in all of `outs`. They begin at place(out, first).
  template <class Use>
  static void for_blocks(Eigen::Index n, Eigen::Index m, std::initializer_list<const MatrixOut*> outs, const Use& use) {
    const bool gapless =
        std::all_of(outs.begin(), outs.end(), [n](const MatrixOut* out) { return out->outerStride() == n; });
    const Eigen::Index length = gapless ? n * m : n;
    for (Eigen::Index run = 0; run < n * m; run += length) {
      for (Eigen::Index from = 0; from < length; from += kBlock) use(run + from, std::min(kBlock, length - from));
    }
  }
  static double* place(MatrixOut& out, Eigen::Index pair) {
    return out.data() + pair / out.rows() * out.outerStride() + pair % out.rows();
  }

  /// Returns the reciprocal of a length scale, or the largest number if the reciprocal overflows.
  static double per_length(double scale) { return std::min(1.0 / scale, std::numeric_limits<double>::max()); }

  Pairs of_both_axes(const PointsView& a, const PointsView& b) const {
    return {a.rows(),
            2,
            {a.col(0).data(), a.col(1).data()},
            {b.col(0).data(), b.col(1).data()},
            {per_length(along_x_), per_length(along_y_)}};
  }

  void take_values(const Pairs& pairs, Eigen::Index others, MatrixOut out) const {
    for_blocks(pairs.n, others, {&out}, [&](Eigen::Index first, Eigen::Index count) {
      double* const to = place(out, first);
      squared_distances(pairs, first, count, Shape::kFarthest, Shape::kScale, to);
      shape_.values(Numbers(to, count));
    });
  }

  Shape shape_;
  double along_x_;
  double along_y_;
  bool per_axis_;
};

/// Base class of shapes that have no parameters except the length scales.
struct PlainShape {
  using Options = StationaryOptions;
  /// For z of this size, exp(-z) and exp(-sqrt(z)) underflow to 0, even after multiplication by z.
  static constexpr double kFarthest = 1e8;
  static constexpr bool kSeparable = false;
  static constexpr bool kOwn = false;
  static constexpr bool kSlopes = false;
  explicit PlainShape(const Options&) {}
  std::vector<KernelParameter> parameters() const { return {}; }
  void set_parameters(const VectorView&) {}
};

}  // namespace palpate::kernels
