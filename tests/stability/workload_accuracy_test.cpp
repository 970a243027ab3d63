// SPDX-License-Identifier: MIT
// Error of every engine against long double, after all taps of the workloads W1, W2 and W3: a dense factorisation with
// 19 digits that shares nothing with the framework.
#include "benchmark/workload.hpp"
#include "support/arrays.hpp"
#include "support/instruction_sets.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/textbook.hpp"

#include <fmt/format.h>

namespace palpate::test {
namespace {

struct Workload {
  const char* name;
  int grid;
};

/// Lists of tests show a workload by its name.
void PrintTo(const Workload& one, std::ostream* out) { *out << one.name; }

struct Limit {
  EngineSettings::Kind engine;
  double mean, variance;
};

class WorkloadAccuracy : public testing::TestWithParam<Workload> {};

TEST_P(WorkloadAccuracy, IsThatPromisedForEveryEngine) {
  const Workload workload = GetParam();
  if (test::brief() && workload.grid > 100) GTEST_SKIP() << "./check --all makes it in release";
  const benchmark::Taps taps =
      benchmark::read_taps(test::source_folder() / "tests/data" / fmt::format("taps_{}.csv", workload.name));
  const CandidateGrid candidates = benchmark::square(workload.grid);
  constexpr Eigen::Index kProbes = 397;  // a prime, so that they fall into all rows and columns
  Eigen::Array<Eigen::Index, kProbes, 1> chosen;
  for (Eigen::Index i = 0; i < kProbes; ++i) chosen(i) = i * (candidates.size() - 1) / (kProbes - 1);
  Textbook<long double> truth(
      [](const Target& a, const Target& b) {
        const long double dx = (static_cast<long double>(a.x) - b.x) / 3.0L;
        const long double dy = (static_cast<long double>(a.y) - b.y) / 3.0L;
        return std::exp(-0.5L * (dx * dx + dy * dy));
      },
      1e-4L, candidates.points(chosen, Eigen::all), 2);
  for (Eigen::Index i = 0; i < taps.places.rows(); ++i) {
    truth.add({taps.places(i, 0), taps.places(i, 1)}, {taps.answers(i, 0), taps.answers(i, 1)});
  }
  using Kind = EngineSettings::Kind;
  // After a thousand taps rounding is 5e-11. Of dense, the memory of W3 would be 1.7 GB.
  std::vector<Limit> limits{{Kind::grid, 1e-10, 1e-13}, {Kind::lowrank, 5e-9, 1e-12}};
  if (workload.grid < 400) limits.push_back({Kind::dense, 1e-10, 1e-13});
  for (const Instructions set : math::instruction_sets()) {
    const OnInstructions here(set);
    for (const Limit& limit : limits) {
      EngineSettings settings;
      settings.engine = limit.engine;
      settings.taps = static_cast<int>(taps.places.rows());
      std::unique_ptr<GaussianProcess> process;
      benchmark::replay(taps, candidates, benchmark::make_kernel(), settings, &process);
      const double mean_error =
          std::max(apart(truth.mean(0), process->mean(0)(chosen)), apart(truth.mean(1), process->mean(1)(chosen)));
      const double variance_error = apart(truth.variance(), process->variance()(chosen));
      const std::string name = fmt::format("{} {}", process->engine().name, math::name_of(set));
      EXPECT_LE(mean_error, limit.mean) << name;
      EXPECT_LE(variance_error, limit.variance) << name;
      EXPECT_GT(mean_error, 0.0);
      if (limit.engine == Kind::lowrank) {
        EXPECT_LE(std::max(mean_error, variance_error), process->engine().error_bound + 1e-10) << "its own bound holds";
      }
      RecordProperty(name, fmt::format("mean {:.2g} variance {:.2g} bound {:.2g}", mean_error, variance_error,
                                       process->engine().error_bound));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, WorkloadAccuracy,
                         testing::Values(Workload{"w1", 47}, Workload{"w2", 231}, Workload{"w3", 461}),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace palpate::test
