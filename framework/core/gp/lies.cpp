// SPDX-License-Identifier: MIT
#include "gp/lies.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <vector>

namespace palpate {
namespace {

/// A suspicion of 0 or 1 would settle a tap for good, whatever the others say.
constexpr double kLeastSuspicion = 1e-9;

using Set = std::vector<int>;  ///< of taps, ascending

/// What is left when a set is left out.
struct Rest {
  Eigen::MatrixXd rows;     ///< A_S:, |S| x n
  Eigen::MatrixXd removed;  ///< (A_SS)^-1 A_S:
  Eigen::VectorXd heights;  ///< A' y
  Eigen::VectorXd ones;     ///< A' 1
  double log_weight = 0.0;  ///< of the set, but for what the constant adds
};

/// What the unknown constant has to do with it: its precision, its mean, and what it adds to a set's weight.
struct Constant {
  double precision = 0.0;
  double mean = 0.0;
  double log_weight = 0.0;
};

/// All about one signal and one noise.
class Court {
 public:
  Court(const Testimony& testimony, double signal, double noise) : signal_(signal), level_(testimony.level) {
    const Eigen::Index n = testimony.heights.size();
    Eigen::MatrixXd covariance = signal * signal * testimony.covariance;
    if (testimony.broad.size() > 0) covariance += testimony.broad_signal * testimony.broad_signal * testimony.broad;
    covariance.diagonal().array() += noise * noise;
    if (testimony.roughness.size() > 0) covariance.diagonal() += testimony.roughness;
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    inverse_ = factor.solve(Eigen::MatrixXd::Identity(n, n));
    heights_ = inverse_ * testimony.heights;
    ones_ = inverse_.rowwise().sum();
    log_evidence_ = -0.5 * testimony.heights.dot(heights_) - factor.matrixLLT().diagonal().array().log().sum();
    const Eigen::ArrayXd pi = testimony.suspicion.array().max(kLeastSuspicion).min(1.0 - kLeastSuspicion);
    const Eigen::ArrayXd lie = testimony.heights.array() / testimony.lie;
    log_odds_ = (pi / (1.0 - pi)).log() - 0.5 * lie.square() - std::log(testimony.lie);
  }

  int taps() const { return static_cast<int>(heights_.size()); }
  double signal() const { return signal_; }
  const Eigen::MatrixXd& inverse() const { return inverse_; }

  Rest without(const Set& liars) const {
    Rest out{{}, {}, heights_, ones_, log_evidence_};
    const auto count = static_cast<Eigen::Index>(liars.size());
    if (count == 0) return out;
    out.rows.resize(count, taps());
    Eigen::MatrixXd own(count, count);
    Eigen::MatrixXd of_both(count, 2);
    for (Eigen::Index i = 0; i < count; ++i) {
      const int liar = liars[static_cast<std::size_t>(i)];
      out.rows.row(i) = inverse_.row(liar);
      of_both(i, 0) = heights_(liar);
      of_both(i, 1) = ones_(liar);
      out.log_weight += log_odds_(liar);
    }
    for (Eigen::Index i = 0; i < count; ++i) own.col(i) = out.rows.col(liars[static_cast<std::size_t>(i)]);
    const Eigen::LLT<Eigen::MatrixXd> factor(own);
    out.removed = factor.solve(out.rows);
    out.heights -= out.removed.transpose() * of_both.col(0);
    out.ones -= out.removed.transpose() * of_both.col(1);
    for (const int liar : liars) out.heights(liar) = out.ones(liar) = 0.0;
    out.log_weight +=
        0.5 * of_both.col(0).dot(factor.solve(of_both.col(0))) - factor.matrixLLT().diagonal().array().log().sum();
    return out;
  }

  /// `ones` and `heights`: 1^T A' 1 and 1^T A' y.
  Constant constant(double ones, double heights) const {
    Constant out;
    if (!(level_ > 0.0)) return out;
    const double prior = level_ * level_;
    out.precision = 1.0 / prior + ones;
    out.mean = heights / out.precision;
    out.log_weight = 0.5 * (out.mean * heights - std::log(out.precision * prior));
    return out;
  }
  Constant constant(const Rest& rest) const { return constant(rest.ones.sum(), rest.heights.sum()); }

  /// Log weights of the set of `rest` with each other tap; those of its own mean nothing.
  Eigen::VectorXd neighbours(const Rest& rest) const {
    const double ones = rest.ones.sum();
    const double heights = rest.heights.sum();
    Eigen::VectorXd own = inverse_.diagonal();
    if (rest.rows.rows() > 0) own -= rest.rows.cwiseProduct(rest.removed).colwise().sum().transpose();
    Eigen::VectorXd out(taps());
    for (int i = 0; i < taps(); ++i) {
      const double h = rest.heights(i);
      const double o = rest.ones(i);
      out(i) = rest.log_weight + log_odds_(i) + 0.5 * (h * h / own(i) - std::log(own(i))) +
               constant(ones - o * o / own(i), heights - o * h / own(i)).log_weight;
    }
    return out;
  }

 private:
  double signal_;
  double level_;
  Eigen::MatrixXd inverse_;    ///< A
  Eigen::VectorXd heights_;    ///< A y
  Eigen::VectorXd ones_;       ///< A 1
  double log_evidence_ = 0.0;  ///< of all heights, the constant and a factor common to all courts aside
  Eigen::ArrayXd log_odds_;    ///< of a lie against the truth, but for what the others say of its height
};

struct Sets {
  std::map<Set, double> log_weights;
  double most = 0.0;  ///< of them
  double next = 0.0;  ///< see Judgement
};

Sets likeliest(const Court& court, const Effort& effort) {
  const double hopeless = std::log(effort.hopeless);
  const double negligible = std::log(effort.negligible);
  Sets out;
  std::multimap<double, Set, std::greater<>> waiting;
  const auto add = [&](Set set, double weight) {
    if (!out.log_weights.emplace(set, weight).second) return;
    out.most = std::max(out.most, weight);
    waiting.emplace(weight, std::move(set));
  };
  const Rest all = court.without({});
  out.most = all.log_weight + court.constant(all).log_weight;
  add({}, out.most);
  for (int look = 0; !waiting.empty(); ++look) {
    const auto first = waiting.begin();
    if (first->first - out.most < hopeless) return out;
    if (look == effort.looks) {
      out.next = std::exp(first->first - out.most);
      return out;
    }
    const Set set = std::move(first->second);
    waiting.erase(first);
    const auto to_come = static_cast<std::size_t>(effort.looks - look);
    const Eigen::VectorXd weights = court.neighbours(court.without(set));
    for (int i = 0; i < court.taps(); ++i) {
      const double weight = weights(i);
      if (!(weight - out.most >= hopeless)) continue;
      // What is not summed is of use only where its neighbours come to be looked at.
      if (weight - out.most < negligible && waiting.size() >= to_come && weight <= std::prev(waiting.end())->first)
        continue;
      const auto place = std::lower_bound(set.begin(), set.end(), i);
      if (place != set.end() && *place == i) continue;
      Set more = set;
      more.insert(more.begin() + (place - set.begin()), i);
      add(std::move(more), weight);
      if (waiting.size() > to_come) waiting.erase(std::prev(waiting.end()));
    }
  }
  return out;
}

}  // namespace

Judgement judge(const Testimony& testimony, const Effort& effort) {
  std::vector<Court> courts;
  std::vector<Sets> sets;
  double most = -std::numeric_limits<double>::infinity();
  for (const double signal : testimony.signals) {
    for (const double noise : testimony.noises) {
      courts.emplace_back(testimony, signal, noise);
      sets.push_back(likeliest(courts.back(), effort));
      most = std::max(most, sets.back().most);
    }
  }
  const Eigen::Index n = testimony.heights.size();
  Judgement out;
  out.doubt = Eigen::VectorXd::Zero(n);
  out.a = Eigen::VectorXd::Zero(1 + 2 * n);
  out.b = Eigen::MatrixXd::Zero(1 + 2 * n, 1 + 2 * n);
  const double broad = testimony.broad_signal * testimony.broad_signal;
  double sum = 0.0;
  Eigen::VectorXd one(n + 1);
  for (std::size_t i = 0; i < courts.size(); ++i) {
    const Court& court = courts[i];
    // Over (1, c), c the covariances of this signal with the broad one.
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(n + 1);
    Eigen::MatrixXd form = Eigen::MatrixXd::Zero(n + 1, n + 1);
    double all = 0.0;
    for (const auto& [set, log_weight] : sets[i].log_weights) {
      const double weight = std::exp(log_weight - most);
      if (weight < effort.negligible) continue;
      const Rest rest = court.without(set);
      const Constant constant = court.constant(rest);
      all += weight;
      ++out.sets;
      for (const int liar : set) out.doubt(liar) += weight;
      one << constant.mean, rest.heights - constant.mean * rest.ones;
      mean += weight * one;
      form += weight * one * one.transpose();
      if (!set.empty()) form.bottomRightCorner(n, n) += weight * rest.rows.transpose() * rest.removed;
      if (constant.precision > 0.0) {
        one << 1.0, -rest.ones;
        form += weight / constant.precision * one * one.transpose();
      }
    }
    out.next = std::max(out.next, sets[i].next * std::exp(sets[i].most - most));
    if (!(all > 0.0)) continue;
    form.bottomRightCorner(n, n) -= all * court.inverse();
    const double signal = court.signal() * court.signal();
    const double shares[] = {signal, broad};
    out.s2 += all * (signal + broad);
    sum += all;
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
  out.doubt /= sum;
  out.a /= sum;
  out.b /= sum;
  out.s2 /= sum;
  out.b -= out.a * out.a.transpose();
  return out;
}

}  // namespace palpate
