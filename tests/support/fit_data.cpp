// SPDX-License-Identifier: MIT
#include "support/fit_data.hpp"

#include "support/support.hpp"

#include <cmath>
#include <fstream>

namespace palpate::test {

FitData fit_data(int count) {
  std::ifstream file(source_folder() / "tests/data" / ("fit_" + std::to_string(count) + ".csv"));
  std::string header;
  std::getline(file, header);
  FitData data{Points(count, 2), Eigen::VectorXd(count)};
  char comma = ',';
  for (int i = 0; i < count; ++i) file >> data.points(i, 0) >> comma >> data.points(i, 1) >> comma >> data.targets(i);
  data.points *= 0.01;
  return data;
}

FitState::FitState(double length_scale, double signal_variance, double noise_variance)
    : kernel(make<Kernel>(contract_host(), "rbf")),
      signal(std::sqrt(signal_variance)),
      noise_ratio(std::sqrt(noise_variance / signal_variance)) {
  kernel->set_parameters(Eigen::VectorXd::Constant(1, length_scale));
}

FitSummary FitState::fit(const Fitting& fitting, const FitData& data, std::uint64_t seed, std::vector<double>* memory) {
  FitProblem problem{data.points, *kernel, noise_ratio, 0.0, {{data.targets, signal, mean}}, memory};
  Random random(seed, "fit");
  return fitting.fit(problem, random);
}

}  // namespace palpate::test
