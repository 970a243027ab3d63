// SPDX-License-Identifier: MIT
#include "gp/outlier_posterior.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace palpate {
namespace {

/// A suspicion of 0 or 1 would settle a tap for good, whatever the others say.
constexpr double kLeastSuspicion = 1e-9;

/// What the unknown constant has to do with it: its precision, its mean, and what it adds to a set's weight.
struct Constant {
  double precision = 0.0;
  double mean = 0.0;
  double log_weight = 0.0;
};

/// All about one signal and one noise.
class Court {
 public:
  Court(const OutlierProblem& problem, double signal, double noise) : signal_(signal), level_(problem.mean_deviation) {
    const Eigen::Index n = problem.heights.size();
    Eigen::MatrixXd covariance = signal * signal * problem.covariance;
    if (problem.broad_covariance.size() > 0)
      covariance += problem.broad_signal * problem.broad_signal * problem.broad_covariance;
    const double least =
        n > 0 ? kInverseNoise * static_cast<double>(n) * kEpsilon * covariance.diagonal().maxCoeff() : 0.0;
    const double square = noise * noise;
    covariance.diagonal().array() += std::max(square, least);
    if (problem.extra_variance.size() > 0) covariance.diagonal() += problem.extra_variance;
    RegularFactor factor;
    factor.factorise(covariance);
    report_ = factor.report();
    if (square < least) {
      report_.jitter += least - square;
      ++report_.raised;
    }
    inverse_ = factor.inverse();
    heights_ = inverse_ * problem.heights;
    ones_ = inverse_.rowwise().sum();
    log_evidence_ = -0.5 * problem.heights.dot(heights_) - factor.half_log_determinant();
    const Eigen::ArrayXd pi = problem.prior.array().max(kLeastSuspicion).min(1.0 - kLeastSuspicion);
    const Eigen::ArrayXd lie = problem.heights.array() / problem.outlier_deviation;
    log_odds_ = (pi / (1.0 - pi)).unaryExpr(&math::log) - 0.5 * lie.square() - math::log(problem.outlier_deviation);
  }

  int taps() const { return static_cast<int>(heights_.size()); }
  double signal() const { return signal_; }
  const Eigen::MatrixXd& inverse() const { return inverse_; }
  const Eigen::VectorXd& heights() const { return heights_; }
  const Eigen::VectorXd& ones() const { return ones_; }
  double log_evidence() const { return log_evidence_; }
  const Eigen::ArrayXd& log_odds() const { return log_odds_; }
  double level() const { return level_; }
  const FactorReport& report() const { return report_; }
  std::vector<int> redundant_taps() const {
    std::vector<int> out;
    for (int i = 0; i < taps(); ++i) {
      if (inverse_(i, i) == 0.0) out.push_back(i);
    }
    return out;
  }

  /// `ones` and `heights`: 1^T A' 1 and 1^T A' y.
  Constant constant(double ones, double heights) const {
    Constant out;
    if (!(level_ > 0.0)) return out;
    const double prior = level_ * level_;
    out.precision = 1.0 / prior + ones;
    out.mean = heights / out.precision;
    out.log_weight = 0.5 * (out.mean * heights - math::log(out.precision * prior));
    return out;
  }

 private:
  double signal_;
  double level_;
  FactorReport report_;
  Eigen::MatrixXd inverse_;    ///< A; 0 in rows that were set aside
  Eigen::VectorXd heights_;    ///< A y
  Eigen::VectorXd ones_;       ///< A 1
  double log_evidence_ = 0.0;  ///< of all heights, the constant and a factor common to all courts aside
  Eigen::ArrayXd log_odds_;    ///< of a lie against the truth, but for what the others say of its height
};

/// The likeliest sets of one court, found by their neighbours. A set has one tap i more than another one, and with A'
/// and p = A'_ii of that one its own is A' - u u^T, u = A'_:i / sqrt(p): a set's A' is A less one such column for each
/// of its taps, which it has in common with those that it came from.
class Sets {
 public:
  struct One {
    int of = -1;   ///< the set that it has one tap more than; -1: it is empty
    int tap = -1;  ///< that tap
    int rest = -1;
    double log_weight = 0.0;
  };

  Sets(const Court& court, const OutlierSearchLimits& limits)
      : court_(court),
        words_((static_cast<std::size_t>(court.taps()) + kBits - 1) / kBits),
        rests_(court.taps(), Eigen::Index{kParts} * (limits.expansions + 1)),
        log_weights_(static_cast<std::size_t>(limits.expansions) + 1),
        spare_(limits.expansions) {
    find(limits);
  }

  const std::vector<One>& all() const { return all_; }
  double most() const { return most_; }  ///< of their log weights
  double next() const { return next_; }  ///< see OutlierPosterior
  int looks() const { return spare_; }

  /// What is left without a set: the place of its parts, until it is asked about another set that was not looked at.
  int rest_of(const One& one) {
    if (one.rest >= 0) return one.rest;
    leave_out(one, spare_);
    return spare_;
  }
  auto column(int rest) const { return part(rest, 0); }   ///< u of the set's own tap
  auto heights(int rest) const { return part(rest, 1); }  ///< A' y
  auto ones(int rest) const { return part(rest, 2); }     ///< A' 1

 private:
  static constexpr int kParts = 4;
  static constexpr std::size_t kBits = 64;

  Eigen::MatrixXd::ColXpr part(int rest, int which) { return rests_.col(Eigen::Index{kParts} * rest + which); }
  Eigen::MatrixXd::ConstColXpr part(int rest, int which) const {
    return rests_.col(Eigen::Index{kParts} * rest + which);
  }
  auto diagonal(int rest) const { return part(rest, 3); }  ///< of A'

  void leave_out(const One& one, int to) {
    double& log_weight = log_weights_[static_cast<std::size_t>(to)];
    auto u = part(to, 0);
    if (one.of < 0) {
      part(to, 1) = court_.heights();
      part(to, 2) = court_.ones();
      part(to, 3) = court_.inverse().diagonal();
      log_weight = court_.log_evidence();
      return;
    }
    const int before = all_[static_cast<std::size_t>(one.of)].rest;
    u = court_.inverse().col(one.tap);
    for (int k = one.of; all_[static_cast<std::size_t>(k)].of >= 0; k = all_[static_cast<std::size_t>(k)].of) {
      const auto earlier = column(all_[static_cast<std::size_t>(k)].rest);
      u -= earlier(one.tap) * earlier;
    }
    for (int k = one.of; all_[static_cast<std::size_t>(k)].of >= 0; k = all_[static_cast<std::size_t>(k)].of)
      u(all_[static_cast<std::size_t>(k)].tap) = 0.0;
    const double root = std::sqrt(u(one.tap));
    u /= root;
    const double height = heights(before)(one.tap) / root;
    part(to, 1) = heights(before) - height * u;
    part(to, 2) = ones(before) - ones(before)(one.tap) / root * u;
    part(to, 3) = diagonal(before) - u.cwiseAbs2();
    part(to, 1)(one.tap) = part(to, 2)(one.tap) = 0.0;
    log_weight = log_weights_[static_cast<std::size_t>(before)] + court_.log_odds()(one.tap) + 0.5 * height * height -
                 math::log(root);
  }

  /// Log weights of the set with each other tap; those of its own mean nothing.
  void weigh_neighbours(int rest, Eigen::ArrayXd& out) const {
    const auto h = heights(rest).array();
    const auto o = ones(rest).array();
    const auto own = diagonal(rest).array();
    out = court_.log_odds() + log_weights_[static_cast<std::size_t>(rest)];
    if (!(court_.level() > 0.0)) {
      out += 0.5 * (h.square() / own - own.unaryExpr(&math::log));
      return;
    }
    const double prior = court_.level() * court_.level();
    const double all_heights = h.sum();
    const double without_any = 1.0 / prior + o.sum();
    // With q = precision of the constant times `own`, one logarithm does.
    out += 0.5 * ((h.square() + (all_heights * own - o * h).square() / (without_any * own - o.square())) / own -
                  ((without_any * own - o.square()) * prior).unaryExpr(&math::log));
  }

  void add(const One& one, const std::uint64_t* bits) {
    all_.push_back(one);
    bits_.insert(bits_.end(), bits, bits + words_);
    most_ = std::max(most_, one.log_weight);
    const auto later = [&](double weight, int other) { return weight > weight_of(other); };
    waiting_.insert(std::upper_bound(waiting_.begin(), waiting_.end(), one.log_weight, later),
                    static_cast<int>(all_.size()) - 1);
  }

  bool known(const std::uint64_t* bits) const {
    for (std::size_t first = 0; first < bits_.size(); first += words_) {
      if (bits_[first] == bits[0] && std::equal(bits, bits + words_, &bits_[first])) return true;
    }
    return false;
  }

  double weight_of(int set) const { return all_[static_cast<std::size_t>(set)].log_weight; }

  void find(const OutlierSearchLimits& limits) {
    const double hopeless = math::log(limits.min_expanded);
    const double negligible = math::log(limits.min_summed);
    std::vector<std::uint64_t> bits(words_, 0);
    most_ = court_.log_evidence() + court_.constant(court_.ones().sum(), court_.heights().sum()).log_weight;
    add({-1, -1, -1, most_}, bits.data());
    Eigen::ArrayXd weights(court_.taps());
    for (int look = 0; !waiting_.empty(); ++look) {
      const int first = waiting_.front();
      if (weight_of(first) - most_ < hopeless) return;
      if (look == limits.expansions) {
        next_ = math::exp(weight_of(first) - most_);
        return;
      }
      waiting_.erase(waiting_.begin());
      const auto to_come = static_cast<std::size_t>(limits.expansions - look);
      leave_out(all_[static_cast<std::size_t>(first)], look);
      all_[static_cast<std::size_t>(first)].rest = look;
      weigh_neighbours(look, weights);
      for (int i = 0; i < court_.taps(); ++i) {
        const double weight = weights(i);
        if (!(weight - most_ >= hopeless)) continue;
        // What is not summed is of use only where its neighbours come to be looked at.
        if (weight - most_ < negligible && waiting_.size() >= to_come && weight <= weight_of(waiting_.back())) continue;
        std::copy_n(&bits_[static_cast<std::size_t>(first) * words_], words_, bits.begin());
        const std::uint64_t bit = std::uint64_t{1} << static_cast<std::size_t>(i) % kBits;
        std::uint64_t& word = bits[static_cast<std::size_t>(i) / kBits];
        if ((word & bit) != 0) continue;
        word |= bit;
        if (known(bits.data())) continue;
        add({first, i, -1, weight}, bits.data());
        if (waiting_.size() > to_come) waiting_.pop_back();
      }
    }
  }

  const Court& court_;
  std::size_t words_;  ///< of a set: a bit a tap
  std::vector<One> all_;
  std::vector<std::uint64_t> bits_;
  std::vector<int> waiting_;         ///< the likeliest first
  Eigen::MatrixXd rests_;            ///< parts of what is left without each set that was looked at
  std::vector<double> log_weights_;  ///< of these, but for what the constant adds
  int spare_;
  double most_ = 0.0;
  double next_ = 0.0;
};

/// Sums of w v v^T over many v, which are kept until they are summed up together.
class Squares {
 public:
  explicit Squares(Eigen::Index size) : sum_(Eigen::MatrixXd::Zero(size, size)), kept_(size, kTogether) {}

  auto next() { return kept_.col(count_); }
  /// Takes what next() was made.
  void take() {
    if (++count_ == kTogether) settle();
  }
  /// The lower half.
  Eigen::MatrixXd& sum() {
    settle();
    return sum_;
  }

 private:
  static constexpr Eigen::Index kTogether = 64;
  void settle() {
    if (count_ > 0) sum_.selfadjointView<Eigen::Lower>().rankUpdate(kept_.leftCols(count_));
    count_ = 0;
  }
  Eigen::MatrixXd sum_, kept_;
  Eigen::Index count_ = 0;
};

}  // namespace

OutlierPosterior infer_outliers(const OutlierProblem& problem, const OutlierSearchLimits& limits) {
  OutlierPosterior out;
  std::vector<Court> courts;
  courts.reserve(problem.signals.size() * problem.noises.size());
  std::vector<Sets> sets;
  sets.reserve(courts.capacity());
  double most = -std::numeric_limits<double>::infinity();
  for (const double signal : problem.signals) {
    for (const double noise : problem.noises) {
      sets.emplace_back(courts.emplace_back(problem, signal, noise), limits);
      most = std::max(most, sets.back().most());
      out.report.add(courts.back().report());
    }
  }
  const Eigen::Index n = problem.heights.size();
  out.probability = Eigen::VectorXd::Zero(n);
  out.a = Eigen::VectorXd::Zero(1 + 2 * n);
  out.b = Eigen::MatrixXd::Zero(1 + 2 * n, 1 + 2 * n);
  const double broad = problem.broad_signal * problem.broad_signal;
  double sum = 0.0;
  std::vector<double> with(static_cast<std::size_t>(limits.expansions));
  for (std::size_t first = 0; first < courts.size(); first += problem.noises.size()) {
    // Over (1, c), c the covariances of this signal with the broad one.
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(n + 1);
    Squares squares(n + 1);
    double of_signal = 0.0;
    for (std::size_t i = first; i < first + problem.noises.size(); ++i) {
      const Court& court = courts[i];
      double all = 0.0;
      std::fill(with.begin(), with.end(), 0.0);  // weight of the sets that have a column
      for (const Sets::One& set : sets[i].all()) {
        const double weight = math::exp(set.log_weight - most);
        if (weight < limits.min_summed) continue;
        const int rest = sets[i].rest_of(set);
        const auto ones = sets[i].ones(rest);
        const auto heights = sets[i].heights(rest);
        const Constant constant = court.constant(ones.sum(), heights.sum());
        all += weight;
        ++out.summed_sets;
        auto one = squares.next();
        one << constant.mean, heights - constant.mean * ones;
        mean += weight * one;
        one *= std::sqrt(weight);
        squares.take();
        if (constant.precision > 0.0) {
          squares.next() << 1.0, -ones;
          squares.next() *= std::sqrt(weight / constant.precision);
          squares.take();
        }
        if (set.rest < 0) {
          squares.next() << 0.0, std::sqrt(weight) * sets[i].column(rest);
          squares.take();
        }
        for (const Sets::One* its = &set; its->of >= 0; its = &sets[i].all()[static_cast<std::size_t>(its->of)]) {
          out.probability(its->tap) += weight;
          if (its->rest >= 0) with[static_cast<std::size_t>(its->rest)] += weight;
        }
      }
      out.next_weight = std::max(out.next_weight, sets[i].next() * math::exp(sets[i].most() - most));
      for (int rest = 0; rest < sets[i].looks(); ++rest) {
        const double weight = with[static_cast<std::size_t>(rest)];
        if (!(weight > 0.0)) continue;
        squares.next() << 0.0, std::sqrt(weight) * sets[i].column(rest);
        squares.take();
      }
      // Nothing was found about those that were set aside.
      for (const int row : court.redundant_taps()) out.probability(row) += all * problem.prior(row);
      of_signal += all;
      if (all > 0.0) squares.sum().bottomRightCorner(n, n).triangularView<Eigen::Lower>() -= all * court.inverse();
    }
    if (!(of_signal > 0.0)) continue;
    const Eigen::MatrixXd form = squares.sum().selfadjointView<Eigen::Lower>();
    const double signal = courts[first].signal() * courts[first].signal();
    const double shares[] = {signal, broad};
    out.s2 += of_signal * (signal + broad);
    sum += of_signal;
    out.a(0) += mean(0);
    out.b(0, 0) += form(0, 0);
    for (int k = 0; k < 2; ++k) {
      const Eigen::Index at = 1 + k * n;
      out.a.segment(at, n) += shares[k] * mean.tail(n);
      out.b.block(0, at, 1, n) += shares[k] * form.block(0, 1, 1, n);
      out.b.block(at, 0, n, 1) += shares[k] * form.block(1, 0, n, 1);
      for (int l = 0; l < 2; ++l)
        out.b.block(at, 1 + l * n, n, n) += shares[k] * shares[l] * form.bottomRightCorner(n, n);
    }
  }
  out.probability /= sum;
  out.a /= sum;
  out.b /= sum;
  out.s2 /= sum;
  out.b.noalias() -= out.a * out.a.transpose();
  out.log_evidence = most + math::log(sum / static_cast<double>(courts.size()));
  return out;
}

}  // namespace palpate
