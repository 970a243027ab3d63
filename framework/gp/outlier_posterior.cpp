// SPDX-License-Identifier: MIT
#include "gp/outlier_posterior.hpp"

#include "gp/outlier_search.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

/// Sum of outer products v v^T, added in batches of vectors.
class OuterProducts {
 public:
  explicit OuterProducts(Eigen::Index size) : sum_(Eigen::MatrixXd::Zero(size, size)), batch_(size, kBatch) {}

  /// Returns the memory for the next vector; commit() adds the vector to the sum.
  auto next() { return batch_.col(count_); }
  void commit() {
    if (++count_ == kBatch) flush();
  }
  /// Returns the sum; only its lower half is computed.
  Eigen::MatrixXd& sum() {
    flush();
    return sum_;
  }

 private:
  static constexpr Eigen::Index kBatch = 64;
  void flush() {
    if (count_ > 0) sum_.selfadjointView<Eigen::Lower>().rankUpdate(batch_.leftCols(count_));
    count_ = 0;
  }
  Eigen::MatrixXd sum_, batch_;
  Eigen::Index count_ = 0;
};

/// Moments of the coefficients for one signal, summed over the sets with their weights. The coefficients belong to (1,
/// c), where c is the vector of covariances with the taps, the broad signal included.
struct Moments {
  explicit Moments(Eigen::Index taps) : mean(Eigen::VectorXd::Zero(taps + 1)), squares(taps + 1) {}

  Eigen::VectorXd mean;
  OuterProducts squares;
  double weight = 0.0;
};

/// Adds to `moments`, times `weight`: the mean of the coefficients if `set` is the set of outliers, the outer product
/// of this mean with itself, and the part of the coefficients' covariance due to the unknown constant of f
/// (OutlierProblem::mean_deviation). Returns the index of the set's remainder, which is the GP without the set (see
/// OutlierSearch).
int add_set(OutlierSearch& search, const InlierGp& gp, const OutlierSet& set, double weight, Moments& moments) {
  const int remainder = search.remainder_of(set);
  const auto ones = search.solved_ones(remainder);
  const auto heights = search.solved_heights(remainder);
  const InlierGp::ConstantPosterior constant = gp.constant(ones.sum(), heights.sum());
  auto mean = moments.squares.next();
  mean << constant.mean, heights - constant.mean * ones;
  moments.mean += weight * mean;
  mean *= std::sqrt(weight);
  moments.squares.commit();
  if (constant.precision > 0.0) {
    moments.squares.next() << 1.0, -ones;
    moments.squares.next() *= std::sqrt(weight / constant.precision);
    moments.squares.commit();
  }
  return remainder;
}

/// Adds u u^T for the vector u of a remainder (see OutlierSearch), times `weight`, the total weight of all sets that
/// share u.
void add_column(const OutlierSearch& search, int remainder, double weight, Moments& moments) {
  moments.squares.next() << 0.0, std::sqrt(weight) * search.column(remainder);
  moments.squares.commit();
}

/// Adds all sets of one signal and one noise. `largest` is the log weight of the most probable set over all signals and
/// noises.
void add_sets(OutlierSearch& search, const InlierGp& gp, const OutlierProblem& problem, double min_summed,
              double largest, Moments& moments, OutlierPosterior& out) {
  double all = 0.0;
  std::vector<double> column_weights(static_cast<std::size_t>(search.expansions()), 0.0);
  for (const OutlierSet& set : search.sets()) {
    const double weight = math::exp(set.log_weight - largest);
    if (weight < min_summed) continue;
    all += weight;
    ++out.summed_sets;
    const int remainder = add_set(search, gp, set, weight, moments);
    if (set.remainder < 0) add_column(search, remainder, weight, moments);
    for (const OutlierSet* one = &set; one->parent >= 0; one = &search.sets()[static_cast<std::size_t>(one->parent)]) {
      out.probability(one->tap) += weight;
      if (one->remainder >= 0) column_weights[static_cast<std::size_t>(one->remainder)] += weight;
    }
  }
  out.next_weight = std::max(out.next_weight, search.next_weight() * math::exp(search.largest_log_weight() - largest));
  for (int remainder = 0; remainder < search.expansions(); ++remainder) {
    const double weight = column_weights[static_cast<std::size_t>(remainder)];
    if (weight > 0.0) add_column(search, remainder, weight, moments);
  }
  // Redundant taps, whose rows of the inverse are 0, keep their prior probability.
  for (int i = 0; i < gp.taps(); ++i) {
    if (gp.inverse(i, i) == 0.0) out.probability(i) += all * problem.prior(i);
  }
  moments.weight += all;
  const Eigen::Index n = gp.taps();
  if (all > 0.0) moments.squares.sum().bottomRightCorner(n, n).triangularView<Eigen::Lower>() -= all * gp.inverse;
}

/// Adds the moments of one signal to the coefficients of the surface. `signal` and `broad` are variances.
void add_signal(Moments& moments, double signal, double broad, OutlierPosterior& out) {
  const Eigen::Index n = out.probability.size();
  const Eigen::MatrixXd form = moments.squares.sum().selfadjointView<Eigen::Lower>();
  const double shares[] = {signal, broad};
  out.s2 += moments.weight * (signal + broad);
  out.a(0) += moments.mean(0);
  out.b(0, 0) += form(0, 0);
  for (int k = 0; k < 2; ++k) {
    const Eigen::Index at = 1 + k * n;
    out.a.segment(at, n) += shares[k] * moments.mean.tail(n);
    out.b.block(0, at, 1, n) += shares[k] * form.block(0, 1, 1, n);
    out.b.block(at, 0, n, 1) += shares[k] * form.block(1, 0, n, 1);
    for (int l = 0; l < 2; ++l)
      out.b.block(at, 1 + l * n, n, n) += shares[k] * shares[l] * form.bottomRightCorner(n, n);
  }
}

}  // namespace

OutlierPosterior infer_outliers(const OutlierProblem& problem, const OutlierSearchLimits& limits) {
  OutlierPosterior out;
  std::vector<InlierGp> gps;
  gps.reserve(problem.signals.size() * problem.noises.size());
  std::vector<OutlierSearch> searches;
  searches.reserve(gps.capacity());
  double largest = -std::numeric_limits<double>::infinity();
  for (const double signal : problem.signals) {
    for (const double noise : problem.noises) {
      searches.emplace_back(gps.emplace_back(problem, signal, noise), limits);
      largest = std::max(largest, searches.back().largest_log_weight());
      out.report.add(gps.back().report);
    }
  }
  const Eigen::Index n = problem.heights.size();
  out.probability = Eigen::VectorXd::Zero(n);
  out.a = Eigen::VectorXd::Zero(1 + 2 * n);
  out.b = Eigen::MatrixXd::Zero(1 + 2 * n, 1 + 2 * n);
  double sum = 0.0;
  for (std::size_t first = 0; first < gps.size(); first += problem.noises.size()) {
    Moments moments(n);
    for (std::size_t i = first; i < first + problem.noises.size(); ++i)
      add_sets(searches[i], gps[i], problem, limits.min_summed, largest, moments, out);
    if (!(moments.weight > 0.0)) continue;
    const double signal = gps[first].signal;
    add_signal(moments, signal * signal, problem.broad_signal * problem.broad_signal, out);
    sum += moments.weight;
  }
  out.probability /= sum;
  out.a /= sum;
  out.b /= sum;
  out.s2 /= sum;
  out.b.noalias() -= out.a * out.a.transpose();
  out.log_evidence = largest + math::log(sum / static_cast<double>(gps.size()));
  return out;
}

}  // namespace palpate
