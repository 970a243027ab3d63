// SPDX-License-Identifier: MIT
// One hyperparameter fit of tests/data/fit_N.csv from the reference start, timed: prints the least and the median
// milliseconds of ROUNDS fits, the log marginal likelihood, and the evaluations.
//   fit_benchmark N ROUNDS
#include "support/fit_data.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <vector>

int main(int argc, char** argv) {
  using namespace palpate;
  const int count = argc > 1 ? std::atoi(argv[1]) : 50;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 11;
  const test::FitData data = test::fit_data(count);
  const auto fitting = test::make<Fitting>(test::contract_host(), "ceres", "{priors: none, starts: 1}");
  std::vector<double> milliseconds;
  FitSummary summary;
  for (int i = 0; i < rounds; ++i) {
    test::FitState state;
    const auto start = std::chrono::steady_clock::now();
    summary = state.fit(*fitting, data);
    milliseconds.push_back(1e3 * std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(milliseconds.begin(), milliseconds.end());
  fmt::print("{:.4f} {:.4f} {:.6f} {} {}\n", milliseconds.front(), milliseconds[milliseconds.size() / 2],
             summary.objective, summary.evaluations, summary.reason);
}
