// SPDX-License-Identifier: MIT
// Common part of the kernels that combine other kernels.
#pragma once

#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <memory>
#include <vector>

namespace palpate::kernels {

struct PartsOptions : Options {
  std::vector<PluginChoice> kernels;

  void list(Fields& fields) override {
    fields.plugins(kernels, "kernel",
                   Field("kernels", "list of the kernels to combine, each {type: ..., ...}").needed());
    fields.require(!kernels.empty(), "kernels", "needs at least one kernel");
  }
};

/// A kernel of several parts. Its parameters have names such as kernels.0.length_scale, in the order of the parts.
/// `Join` defines the combination:
///     static constexpr double kNothing;          value of a combination of no parts
///     static void apply(whole, part);            combines the covariances of a part with those of the previous parts
///     static void join_slopes(before, own, whole, part);   combines derivatives, one matrix per parameter
/// In join_slopes(), `before` has the derivatives of the previous parts, and `own` those of the part. It is called
/// before apply().
template <class Join>
class ComposedKernel : public Kernel {
 public:
  using Options = PartsOptions;

  ComposedKernel(const Options& options, const Context& context) {
    for (const PluginChoice& choice : options.kernels) {
      parts_.push_back(context.create<Kernel>(choice));
      counts_.push_back(static_cast<Eigen::Index>(parts_.back()->parameters().size()));
    }
  }

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    parts_[0]->covariance(a, b, out);
    // Views go by value. NOLINTNEXTLINE(performance-unnecessary-value-param)
    join_others(out, [&](const Kernel& part, Eigen::Index j, VectorOut own) { part.covariance(a, b.row(j), own); });
  }

  void variance(const PointsView& a, VectorOut out) const override {
    parts_[0]->variance(a, out);
    // NOLINTNEXTLINE(performance-unnecessary-value-param)
    join_others(out, [&](const Kernel& part, Eigen::Index, VectorOut own) { part.variance(a, own); });
  }

  std::vector<KernelParameter> parameters() const override {
    std::vector<KernelParameter> out;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      for (KernelParameter one : parts_[i]->parameters()) {
        one.name = "kernels." + std::to_string(i) + "." + one.name;
        out.push_back(std::move(one));
      }
    }
    return out;
  }

  bool differentiable() const override {
    return std::all_of(parts_.begin(), parts_.end(), [](const auto& one) { return one->differentiable(); });
  }

  void set_parameters(const VectorView& values) override {
    Eigen::Index from = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      parts_[i]->set_parameters(values.segment(from, counts_[i]));
      from += counts_[i];
    }
  }

  void derivatives(const PointsView& a, const PointsView& b, MatrixOut value, MatrixOut slopes) const override {
    Eigen::Index first = 0;
    Eigen::MatrixXd part(a.rows(), b.rows());
    value.setConstant(Join::kNothing);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      auto own = slopes.middleCols(first, counts_[i] * b.rows());
      parts_[i]->derivatives(a, b, part, own);
      Join::join_slopes(slopes.leftCols(first), own, value, part);
      Join::apply(value.array(), part.array());
      first += own.cols();
    }
  }

 protected:
  /// Combines all parts except the first with `out`, which already has the values of the first part. `fill(part, j,
  /// own)` computes column j of a part.
  template <class Fill>
  void join_others(MatrixOut out, const Fill& fill) const {
    Eigen::VectorXd own(out.rows());
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      for (Eigen::Index j = 0; j < out.cols(); ++j) {
        fill(*parts_[i], j, own);
        Join::apply(out.col(j).array(), own.array());
      }
    }
  }

  std::vector<std::shared_ptr<Kernel>> parts_;

 private:
  std::vector<Eigen::Index> counts_;  ///< number of parameters of each part
};

}  // namespace palpate::kernels
