// SPDX-License-Identifier: MIT
// What tests of the posterior engines start from: drawn taps, grids, processes of two outputs, and the textbook.
#pragma once

#include "gp/process.hpp"
#include "support/plugins.hpp"
#include "support/support.hpp"

#include <Eigen/Cholesky>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

using Kind = PosteriorSettings::Kind;
using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

struct Data {
  Points places;
  Eigen::MatrixXd values;  ///< two outputs
};

inline Data draw(int taps, std::uint64_t seed = 5) {
  Random random(seed, "engine_test");
  Data data{Points(taps, 2), Eigen::MatrixXd(taps, 2)};
  for (int i = 0; i < taps; ++i) {
    data.places.row(i) << 0.2 * random.uniform(), 0.2 * random.uniform();
    data.values.row(i) << random.uniform() - 0.5, random.uniform() < 0.5 ? 0.0 : 1.0;
  }
  return data;
}

/// Irregular in both directions.
inline Candidates grid(int columns, int rows) {
  Random random(9, "engine_test/grid");
  Eigen::VectorXd xs(columns);
  Eigen::VectorXd ys(rows);
  for (double& x : xs) x = 0.2 * random.uniform();
  for (double& y : ys) y = 0.2 * random.uniform();
  return product_grid(xs, ys);
}

/// What configs have: regular, its own mirror image.
inline Candidates regular(int columns, int rows) {
  return product_grid(Eigen::VectorXd::LinSpaced(columns, 0.0, 0.2), Eigen::VectorXd::LinSpaced(rows, 0.0, 0.2));
}

inline std::shared_ptr<Kernel> rbf(const std::string& options = "{length_scale: 3 cm, length_scale_y: 5 cm}") {
  return make<Kernel>(shared_host(), "rbf", options);
}

inline const std::vector<ProcessSettings> kOutputs{{2.0, 0.1, 0.25, 0.0}, {0.5, 0.025, 0.5, 0.0}};

inline PosteriorSettings settings_of(Kind kind) {
  PosteriorSettings out;
  out.engine = kind;
  out.scores = true;
  return out;
}

inline Process processed(const Data& data, const Candidates& candidates, const PosteriorSettings& settings,
                         const std::shared_ptr<Kernel>& kernel = rbf()) {
  Process process(kernel, kOutputs, candidates, settings);
  process.show(2);
  for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
    process.add({data.places(i, 0), data.places(i, 1)}, data.values.row(i).transpose());
  }
  return process;
}

/// Algorithm 2.1 of Rasmussen and Williams in long double, by the whole matrix.
struct Textbook {
  Textbook(const Kernel& kernel, const Data& data, const Candidates& candidates, const ProcessSettings& output,
           int column) {
    const auto covariance = [&](const Points& a, const Points& b) {
      Eigen::MatrixXd out(a.rows(), b.rows());
      kernel.covariance(a, b, out);
      return LongMatrix(out.cast<long double>() * output.signal * output.signal);
    };
    LongMatrix k = covariance(data.places, data.places);
    k.diagonal().array() += static_cast<long double>(output.noise) * output.noise;
    const LongMatrix cross = covariance(data.places, candidates.points);
    const Eigen::LLT<LongMatrix> factor(k);
    const LongMatrix targets = (data.values.col(column).array() - output.mean).matrix().cast<long double>();
    mean = ((cross.transpose() * factor.solve(targets)).array() + output.mean).cast<double>();
    const LongMatrix v = factor.matrixL().solve(cross);
    Eigen::VectorXd own(candidates.size());
    kernel.variance(candidates.points, own);
    variance = (own.cast<long double>().array() * output.signal * output.signal -
                v.colwise().squaredNorm().transpose().array())
                   .cast<double>();
  }
  Eigen::VectorXd mean;
  Eigen::VectorXd variance;
};

inline double apart(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

inline bool same_bytes(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

}  // namespace palpate::test
