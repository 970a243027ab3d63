// SPDX-License-Identifier: MIT
// What kernels made of kernels share: their parts, and whose parameters are whose.
#pragma once

#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <memory>
#include <vector>

namespace palpate::kernels {

/// A piece of a column, small enough for the stack.
constexpr Eigen::Index kPiece = 128;
using Piece = Eigen::Array<double, Eigen::Dynamic, 1, Eigen::ColMajor, kPiece, 1>;

/// Calls visit(from, count) for the pieces of `size` rows.
template <class Visit>
void for_pieces(Eigen::Index size, Visit visit) {
  for (Eigen::Index from = 0; from < size; from += kPiece) visit(from, std::min(kPiece, size - from));
}

struct PartsOptions : Options {
  std::vector<PluginChoice> kernels;

  void list(Fields& fields) override {
    fields.plugins(kernels, "kernel", Field("kernels", "the parts, each {type: ..., ...}").needed());
    fields.require(!kernels.empty(), "kernels", "needs at least one kernel");
  }
};

/// A kernel of parts; parameters are named kernels.0.length_scale, in the order of the parts. `Join` says how parts
/// make a whole:
///     static constexpr double kNothing;          the whole of no part
///     static void apply(whole, part);            takes the covariances of one more part into those of the parts before
///     static void join_slopes(before, own, whole, part);   the same of the slopes of the parts before, and of its own;
///                                                `whole` is that before apply()
template <class Join>
class Composed : public Kernel {
 public:
  using Options = PartsOptions;

  Composed(const Options& options, const Context& context) {
    for (const PluginChoice& choice : options.kernels) {
      parts_.push_back(context.create<Kernel>(choice));
      counts_.push_back(static_cast<Eigen::Index>(parts_.back()->parameters().size()));
    }
  }

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    parts_[0]->covariance(a, b, out);
    join_others(out, [&](const Kernel& part, Eigen::Index from, Eigen::Index column, VectorOut piece) {
      part.covariance(a.middleRows(from, piece.size()), b.row(column), piece);
    });
  }

  void variance(const PointsView& a, VectorOut out) const override {
    parts_[0]->variance(a, out);
    join_others(out, [&](const Kernel& part, Eigen::Index from, Eigen::Index, VectorOut piece) {
      part.variance(a.middleRows(from, piece.size()), piece);
    });
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

  void derivatives(const PointsView& a, const PointsView& b, VectorOut value, MatrixOut slopes) const override {
    for_pieces(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
      Eigen::Index first = 0;
      Piece part(count);
      auto whole = value.segment(from, count).array();
      whole.setConstant(Join::kNothing);
      auto rows = slopes.middleRows(from, count);
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        auto own = rows.middleCols(first, counts_[i]);
        parts_[i]->derivatives(a.middleRows(from, count), b, part.matrix(), own);
        Join::join_slopes(rows.leftCols(first), own, whole, part);
        Join::apply(whole, part);
        first += counts_[i];
      }
    });
  }

 protected:
  /// Takes all parts but the first into `out`, which has that one: piece by piece of each column, which
  /// fill(part, from, column, piece) fills from the row `from` on.
  template <class Fill>
  void join_others(MatrixOut out, const Fill& fill) const {
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      for (Eigen::Index column = 0; column < out.cols(); ++column) {
        for_pieces(out.rows(), [&](Eigen::Index from, Eigen::Index count) {
          Piece piece(count);
          fill(*parts_[i], from, column, piece.matrix());
          Join::apply(out.col(column).segment(from, count).array(), piece);
        });
      }
    }
  }

  std::vector<std::shared_ptr<Kernel>> parts_;

 private:
  std::vector<Eigen::Index> counts_;  ///< of the parameters of each
};

}  // namespace palpate::kernels
