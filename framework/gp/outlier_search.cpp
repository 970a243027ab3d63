// SPDX-License-Identifier: MIT
#include "gp/outlier_search.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Smallest distance of a prior from 0 and 1. With a prior of 0 or 1, the height of the tap would have no influence.
constexpr double kLeastPrior = 1e-9;

constexpr std::size_t kBits = 64;

}  // namespace

InlierGp::InlierGp(const OutlierProblem& problem, double surface_signal, double tap_noise)
    : signal(surface_signal), mean_deviation(problem.mean_deviation) {
  const Eigen::Index n = problem.heights.size();
  Eigen::MatrixXd covariance = signal * signal * problem.covariance;
  if (problem.broad_covariance.size() > 0)
    covariance += problem.broad_signal * problem.broad_signal * problem.broad_covariance;
  const double least =
      n > 0 ? kInverseNoise * static_cast<double>(n) * kEpsilon * covariance.diagonal().maxCoeff() : 0.0;
  const double square = tap_noise * tap_noise;
  covariance.diagonal().array() += std::max(square, least);
  if (problem.extra_variance.size() > 0) covariance.diagonal() += problem.extra_variance;
  RegularFactor factor;
  factor.factorise(covariance);
  report = factor.report();
  if (square < least) {
    report.jitter += least - square;
    ++report.raised;
  }
  inverse = factor.inverse();
  solved_heights = inverse * problem.heights;
  solved_ones = inverse.rowwise().sum();
  log_evidence = -0.5 * problem.heights.dot(solved_heights) - factor.half_log_determinant();
  const Eigen::ArrayXd pi = problem.prior.array().max(kLeastPrior).min(1.0 - kLeastPrior);
  const Eigen::ArrayXd outlier = problem.heights.array() / problem.outlier_deviation;
  log_odds = (pi / (1.0 - pi)).unaryExpr(&math::log) - 0.5 * outlier.square() - math::log(problem.outlier_deviation);
}

InlierGp::ConstantPosterior InlierGp::constant(double ones, double heights) const {
  ConstantPosterior out;
  if (!(mean_deviation > 0.0)) return out;
  const double prior = mean_deviation * mean_deviation;
  out.precision = 1.0 / prior + ones;
  out.mean = heights / out.precision;
  out.log_weight = 0.5 * (out.mean * heights - math::log(out.precision * prior));
  return out;
}

OutlierSearch::OutlierSearch(const InlierGp& gp, const OutlierSearchLimits& limits)
    : gp_(gp),
      words_((static_cast<std::size_t>(gp.taps()) + kBits - 1) / kBits),
      log_min_summed_(math::log(limits.min_summed)),
      log_min_expanded_(math::log(limits.min_expanded)),
      remainders_(gp.taps(), Eigen::Index{kParts} * (limits.expansions + 1)),
      log_weights_(static_cast<std::size_t>(limits.expansions) + 1),
      scratch_(limits.expansions) {
  search(limits);
}

int OutlierSearch::remainder_of(const OutlierSet& set) {
  if (set.remainder >= 0) return set.remainder;
  compute_remainder(set, scratch_);
  return scratch_;
}

/// Computes the remainder of a set from the remainder of its parent.
void OutlierSearch::compute_remainder(const OutlierSet& set, int to) {
  double& log_weight = log_weights_[static_cast<std::size_t>(to)];
  auto u = part(to, 0);
  if (set.parent < 0) {
    part(to, 1) = gp_.solved_heights;
    part(to, 2) = gp_.solved_ones;
    part(to, 3) = gp_.inverse.diagonal();
    log_weight = gp_.log_evidence;
    return;
  }
  const int before = set_at(set.parent).remainder;
  u = gp_.inverse.col(set.tap);
  for (int k = set.parent; set_at(k).parent >= 0; k = set_at(k).parent) {
    const auto earlier = column(set_at(k).remainder);
    u -= earlier(set.tap) * earlier;
  }
  for (int k = set.parent; set_at(k).parent >= 0; k = set_at(k).parent) u(set_at(k).tap) = 0.0;
  const double root = std::sqrt(u(set.tap));
  u /= root;
  const double height = solved_heights(before)(set.tap) / root;
  part(to, 1) = solved_heights(before) - height * u;
  part(to, 2) = solved_ones(before) - solved_ones(before)(set.tap) / root * u;
  part(to, 3) = diagonal(before) - u.cwiseAbs2();
  part(to, 1)(set.tap) = part(to, 2)(set.tap) = 0.0;
  log_weight =
      log_weights_[static_cast<std::size_t>(before)] + gp_.log_odds(set.tap) + 0.5 * height * height - math::log(root);
}

/// Computes for each tap the log weight of the set that consists of this tap and the taps of the present set. The
/// values of taps that are already in the present set are meaningless.
void OutlierSearch::weigh_extensions(int remainder, Eigen::ArrayXd& out) const {
  const auto h = solved_heights(remainder).array();
  const auto o = solved_ones(remainder).array();
  const auto own = diagonal(remainder).array();
  out = gp_.log_odds + log_weights_[static_cast<std::size_t>(remainder)];
  if (!(gp_.mean_deviation > 0.0)) {
    out += 0.5 * (h.square() / own - own.unaryExpr(&math::log));
    return;
  }
  const double prior = gp_.mean_deviation * gp_.mean_deviation;
  const double all_heights = h.sum();
  const double without_any = 1.0 / prior + o.sum();
  // without_any * own - o^2 is the precision of the constant times `own`, so a single logarithm covers both factors.
  out += 0.5 * ((h.square() + (all_heights * own - o * h).square() / (without_any * own - o.square())) / own -
                ((without_any * own - o.square()) * prior).unaryExpr(&math::log));
}

void OutlierSearch::add(const OutlierSet& set, const std::uint64_t* bits) {
  sets_.push_back(set);
  bits_.insert(bits_.end(), bits, bits + words_);
  largest_ = std::max(largest_, set.log_weight);
  const auto is_larger = [&](double weight, int other) { return weight > set_at(other).log_weight; };
  waiting_.insert(std::upper_bound(waiting_.begin(), waiting_.end(), set.log_weight, is_larger),
                  static_cast<int>(sets_.size()) - 1);
}

bool OutlierSearch::contains(const std::uint64_t* bits) const {
  for (std::size_t first = 0; first < bits_.size(); first += words_) {
    if (bits_[first] == bits[0] && std::equal(bits, bits + words_, &bits_[first])) return true;
  }
  return false;
}

void OutlierSearch::search(const OutlierSearchLimits& limits) {
  const std::vector<std::uint64_t> none(words_, 0);
  largest_ = gp_.log_evidence + gp_.constant(gp_.solved_ones.sum(), gp_.solved_heights.sum()).log_weight;
  add({-1, -1, -1, largest_}, none.data());
  Eigen::ArrayXd log_weights(gp_.taps());
  for (int expansion = 0; !waiting_.empty(); ++expansion) {
    const int first = waiting_.front();
    if (set_at(first).log_weight - largest_ < log_min_expanded_) return;
    if (expansion == limits.expansions) {
      next_weight_ = math::exp(set_at(first).log_weight - largest_);
      return;
    }
    waiting_.erase(waiting_.begin());
    compute_remainder(set_at(first), expansion);
    sets_[static_cast<std::size_t>(first)].remainder = expansion;
    weigh_extensions(expansion, log_weights);
    extend(first, log_weights, static_cast<std::size_t>(limits.expansions - expansion));
  }
}

/// Adds all sets that consist of the taps of `parent` and one more tap, except sets that are known or too improbable.
void OutlierSearch::extend(int parent, const Eigen::ArrayXd& log_weights, std::size_t expansions_left) {
  std::vector<std::uint64_t> bits(words_);
  for (int i = 0; i < gp_.taps(); ++i) {
    const double weight = log_weights(i);
    if (!(weight - largest_ >= log_min_expanded_)) continue;
    // A set whose weight is too small for the sum is useful only if it will be expanded.
    const bool is_summed = !(weight - largest_ < log_min_summed_);
    if (!is_summed && waiting_.size() >= expansions_left && weight <= set_at(waiting_.back()).log_weight) continue;
    std::copy_n(&bits_[static_cast<std::size_t>(parent) * words_], words_, bits.begin());
    const std::uint64_t bit = std::uint64_t{1} << static_cast<std::size_t>(i) % kBits;
    std::uint64_t& word = bits[static_cast<std::size_t>(i) / kBits];
    if ((word & bit) != 0) continue;
    word |= bit;
    if (contains(bits.data())) continue;
    add({parent, i, -1, weight}, bits.data());
    if (waiting_.size() > expansions_left) waiting_.pop_back();
  }
}

}  // namespace palpate
