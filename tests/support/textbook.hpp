// SPDX-License-Identifier: MIT
// Gaussian process regression by the book (Rasmussen and Williams 2006, algorithm 2.1), in a number type with digits to
// spare. It shares nothing with the framework.
#pragma once

#include <palpate/types.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>
#include <vector>

namespace palpate::test {

/// The posterior of one or more outputs of prior mean 0 at the `probes`, tap by tap.
template <class Real>
class Textbook {
 public:
  using Covariance = std::function<Real(const Target& a, const Target& b)>;

  /// `noise` is a variance.
  Textbook(Covariance covariance, Real noise, const Points& probes, std::size_t outputs = 1)
      : covariance_(std::move(covariance)), noise_(std::move(noise)), reduced_(outputs) {
    for (Eigen::Index i = 0; i < probes.rows(); ++i) {
      const Target place{probes(i, 0), probes(i, 1)};
      probes_.push_back({place, {}, std::vector<Real>(outputs, Real(0)), covariance_(place, place)});
    }
  }

  /// A tap with a value for each output.
  void add(const Target& place, const std::vector<Real>& values) {
    using std::sqrt;
    const std::vector<Real> row = solved(place);
    Real pivot = covariance_(place, place) + noise_;
    for (const Real& one : row) pivot -= one * one;
    pivots.push_back(sqrt(pivot));
    for (std::size_t i = 0; i < values.size(); ++i) {
      reduced_[i].push_back((values[i] - product(row, reduced_[i])) / pivots.back());
    }
    for (Probe& probe : probes_) {
      const Real v = (covariance_(probe.place, place) - product(row, probe.row)) / pivots.back();
      for (std::size_t i = 0; i < values.size(); ++i) probe.means[i] += v * reduced_[i].back();
      probe.variance -= v * v;
      probe.row.push_back(v);
    }
    factor_.push_back(row);
    places_.push_back(place);
  }

  Eigen::VectorXd mean(std::size_t output = 0) const {
    return over_probes([output](const Probe& probe) { return probe.means[output]; });
  }
  Eigen::VectorXd variance() const {
    return over_probes([](const Probe& probe) { return probe.variance; });
  }
  double log_marginal_likelihood() const {
    using std::log;
    Real sum = 0;
    for (std::size_t i = 0; i < pivots.size(); ++i) {
      sum -= reduced_[0][i] * reduced_[0][i] / 2 + log(pivots[i]) + log(Real(2 * 3.14159265358979323846L)) / 2;
    }
    return static_cast<double>(sum);
  }

  std::vector<Real> pivots;  ///< the diagonal of the Cholesky factor

 private:
  struct Probe {
    Target place;
    std::vector<Real> row;  ///< of the factor, if it were a tap
    std::vector<Real> means;
    Real variance;
  };

  /// The first terms of both, multiplied and summed.
  static Real product(const std::vector<Real>& a, const std::vector<Real>& b) {
    Real sum = 0;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) sum += a[i] * b[i];
    return sum;
  }
  std::vector<Real> solved(const Target& place) const {
    std::vector<Real> row;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      row.push_back((covariance_(places_[i], place) - product(row, factor_[i])) / pivots[i]);
    }
    return row;
  }
  template <class Value>
  Eigen::VectorXd over_probes(const Value& value) const {
    Eigen::VectorXd out(static_cast<Eigen::Index>(probes_.size()));
    for (std::size_t i = 0; i < probes_.size(); ++i) {
      out(static_cast<Eigen::Index>(i)) = static_cast<double>(value(probes_[i]));
    }
    return out;
  }

  Covariance covariance_;
  Real noise_;
  std::vector<Probe> probes_;
  std::vector<Target> places_;
  std::vector<std::vector<Real>> factor_;   ///< below the diagonal
  std::vector<std::vector<Real>> reduced_;  ///< of each output, L^-1 times its values
};

}  // namespace palpate::test
