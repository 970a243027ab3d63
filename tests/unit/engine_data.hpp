// SPDX-License-Identifier: MIT
// What tests of the posterior engines start from: drawn taps, grids, processes of two outputs, and the textbook.
#pragma once

#include "support/arrays.hpp"
#include "support/gaussian_process.hpp"
#include "support/grids.hpp"
#include "support/testing.hpp"
#include "support/textbook.hpp"

#include <functional>

namespace palpate::test {

using Kind = EngineSettings::Kind;

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
inline CandidateGrid grid(int columns, int rows) {
  Random random(9, "engine_test/grid");
  Eigen::VectorXd xs(columns);
  Eigen::VectorXd ys(rows);
  for (double& x : xs) x = 0.2 * random.uniform();
  for (double& y : ys) y = 0.2 * random.uniform();
  return product_grid(xs, ys);
}

/// What configs have: regular, its own mirror image.
inline CandidateGrid regular(int columns, int rows) {
  return product_grid(Eigen::VectorXd::LinSpaced(columns, 0.0, 0.2), Eigen::VectorXd::LinSpaced(rows, 0.0, 0.2));
}

inline std::shared_ptr<Kernel> rbf(const std::string& options = "{length_scale: 3 cm, length_scale_y: 5 cm}") {
  return make<Kernel>(shared_host(), "rbf", options);
}

inline const std::vector<GpSettings> kOutputs{{2.0, 0.1, 0.25, 0.0}, {0.5, 0.025, 0.5, 0.0}};

inline EngineSettings settings_of(Kind kind) {
  EngineSettings out;
  out.engine = kind;
  return out;
}

/// Adds all taps, and calls `after` after each.
inline void add_all(
    GaussianProcess& process, const Data& data, const std::function<void()>& after = [] {}) {
  for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
    process.add({data.places(i, 0), data.places(i, 1)}, data.values.row(i).transpose());
    after();
  }
}

inline GaussianProcess processed(const Data& data, const CandidateGrid& candidates, const EngineSettings& settings,
                                 const std::shared_ptr<Kernel>& kernel = rbf(),
                                 const std::vector<GpSettings>& outputs = kOutputs) {
  GaussianProcess process(kernel, outputs, candidates, settings);
  process.show(2);
  add_all(process, data);
  return process;
}

/// Maps of both outputs and their variance are the same to the last bit.
inline void expect_same_maps(const GaussianProcess& one, const GaussianProcess& other) {
  for (const int output : {0, 1}) EXPECT_TRUE(same_bytes(one.mean(output), other.mean(output))) << output;
  EXPECT_TRUE(same_bytes(one.variance(), other.variance()));
}

/// One output in long double, with the framework's kernel.
inline Textbook<long double> by_the_book(const Kernel& kernel, const Data& data, const Points& probes,
                                         const GpSettings& output, Eigen::Index column) {
  const auto covariance = [&kernel, output](const Target& a, const Target& b) {
    Eigen::MatrixXd k(1, 1);
    kernel.covariance(Points{{a.x, a.y}}, Points{{b.x, b.y}}, k);
    return static_cast<long double>(k(0)) * output.signal * output.signal;
  };
  Textbook<long double> out(covariance, static_cast<long double>(output.noise) * output.noise, probes);
  for (Eigen::Index i = 0; i < data.places.rows(); ++i) {
    out.add({data.places(i, 0), data.places(i, 1)}, {static_cast<long double>(data.values(i, column)) - output.mean});
  }
  return out;
}

}  // namespace palpate::test
