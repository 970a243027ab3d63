// SPDX-License-Identifier: MIT
#include "solids/expected_reduction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

}  // namespace

VectorXd expected_reductions(const AssemblySampler& solids, const ResidualGp& residual_gp,
                             const ResidualGp::Places& places, FactorReport* report) {
  if (places.empty()) return {};
  std::vector<ResidualGp::ResidualDatum> all;  // contacts first
  for (const ResidualGp::ResidualDatum& row : residual_gp.rows()) {
    if (!row.free && row.along.isZero(0.0)) all.push_back({row.place});
  }
  const auto n = static_cast<Index>(all.size());
  const auto count = static_cast<Index>(places.size());
  for (const ResidualGp::Place& place : places) all.push_back({place});
  MatrixXd covariance = residual_gp.covariance(all);
  MatrixXd apart(n + count, static_cast<Index>(solids.assemblies().size()));
  for (Index i = 0; i < apart.rows(); ++i) apart.row(i) = solids.offsets(all[static_cast<std::size_t>(i)].place.at);
  covariance.noalias() += apart * apart.transpose() / static_cast<double>(apart.cols());
  const double noise = residual_gp.noise() * residual_gp.noise();
  MatrixXd left = covariance.bottomRightCorner(count, count);
  if (n > 0) {
    MatrixXd known = covariance.topLeftCorner(n, n);
    known.diagonal().array() += noise;
    RegularFactor factor;
    factor.factorise(known);
    if (report != nullptr) report->add(factor.report());
    MatrixXd explained = covariance.topRightCorner(n, count);
    factor.solve_lower(explained);
    left.selfadjointView<Eigen::Lower>().rankUpdate(explained.transpose(), -1.0);
    left.triangularView<Eigen::StrictlyUpper>() = left.transpose();
  }
  const Eigen::ArrayXd variance = left.diagonal().array().max(0.0);
  const double deviation = variance.sqrt().mean();
  VectorXd out(count);
  for (Index i = 0; i < count; ++i) {
    const double of_contact = variance(i) + noise;
    const double taken = of_contact > 0.0 ? 1.0 / of_contact : 0.0;
    out(i) = std::max(0.0, deviation - (variance - taken * left.col(i).array().square()).max(0.0).sqrt().mean());
  }
  return out;
}

Representatives representatives(const ResidualGp::Places& places, std::size_t most) {
  constexpr double kSide = 0.008;
  constexpr double kLarger = 1.2;
  Representatives out;
  for (double side = kSide;; side *= kLarger) {
    out.places.clear();
    out.stands_for.clear();
    std::map<std::array<std::int64_t, 4>, std::size_t> taken;
    for (const ResidualGp::Place& place : places) {
      Index axis = 0;
      place.normal.cwiseAbs().maxCoeff(&axis);  // so that the two sides of a wall are separate
      std::array<std::int64_t, 4> key{};
      for (std::size_t i = 0; i < 3; ++i)
        key[i] = static_cast<std::int64_t>(std::floor(place.at(static_cast<Index>(i)) / side));
      key[3] = 2 * axis + (place.normal(axis) > 0.0 ? 1 : 0);
      const auto [found, is_new] = taken.emplace(key, out.places.size());
      if (is_new) out.places.push_back(place);
      out.stands_for.push_back(found->second);
    }
    if (out.places.size() <= most) return out;
  }
}

}  // namespace palpate
