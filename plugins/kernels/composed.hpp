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

/// The parts of a sum or a product; parameters are named kernels.0.length_scale, in the order of the parts.
class Parts {
 public:
  Parts(const PartsOptions& options, const Context& context) {
    for (const PluginChoice& choice : options.kernels) {
      kernels_.push_back(context.create<Kernel>(choice));
      counts_.push_back(static_cast<Eigen::Index>(kernels_.back()->parameters().size()));
    }
  }

  std::size_t size() const { return kernels_.size(); }
  const Kernel& operator[](std::size_t i) const { return *kernels_[i]; }
  /// How many parameters part i has.
  Eigen::Index parameters_of(std::size_t i) const { return counts_[i]; }

  bool differentiable() const {
    return std::all_of(kernels_.begin(), kernels_.end(), [](const auto& one) { return one->differentiable(); });
  }

  std::vector<KernelParameter> parameters() const {
    std::vector<KernelParameter> out;
    for (std::size_t i = 0; i < size(); ++i) {
      for (KernelParameter one : kernels_[i]->parameters()) {
        one.name = "kernels." + std::to_string(i) + "." + one.name;
        out.push_back(std::move(one));
      }
    }
    return out;
  }

  void set_parameters(const VectorView& values) {
    Eigen::Index from = 0;
    for (std::size_t i = 0; i < size(); ++i) {
      kernels_[i]->set_parameters(values.segment(from, counts_[i]));
      from += counts_[i];
    }
  }

 private:
  std::vector<std::shared_ptr<Kernel>> kernels_;
  std::vector<Eigen::Index> counts_;
};

/// A kernel of parts. Join::apply(whole, part) takes the covariances of one more part into those of the parts before.
/// What is left to the derived kernel is derivatives().
template <class Join>
class Composed : public Kernel {
 public:
  using Options = PartsOptions;

  Composed(const Options& options, const Context& context) : parts_(options, context) {}

  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    parts_[0].covariance(a, b, out);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      for (Eigen::Index j = 0; j < b.rows(); ++j) {
        for_pieces(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
          Piece part(count);
          parts_[i].covariance(a.middleRows(from, count), b.row(j), part.matrix());
          Join::apply(out.col(j).segment(from, count).array(), part);
        });
      }
    }
  }

  void variance(const PointsView& a, VectorOut out) const override {
    parts_[0].variance(a, out);
    for (std::size_t i = 1; i < parts_.size(); ++i) {
      for_pieces(a.rows(), [&](Eigen::Index from, Eigen::Index count) {
        Piece part(count);
        parts_[i].variance(a.middleRows(from, count), part.matrix());
        Join::apply(out.segment(from, count).array(), part);
      });
    }
  }

  std::vector<KernelParameter> parameters() const override { return parts_.parameters(); }
  bool differentiable() const override { return parts_.differentiable(); }
  void set_parameters(const VectorView& values) override { parts_.set_parameters(values); }

 protected:
  const Parts& parts() const { return parts_; }

 private:
  Parts parts_;
};

}  // namespace palpate::kernels
