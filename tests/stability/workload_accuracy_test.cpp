// SPDX-License-Identifier: MIT
// Error of every engine against long double, after all taps of the workloads W1, W2 and W3: a dense factorisation with
// 19 digits that shares nothing with the framework.
#include "benchmark/workload.hpp"
#include "support/sanitizers.hpp"
#include "support/support.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace palpate {
namespace {

using LongVector = std::vector<long double>;

/// The textbook posterior at any place: L L^T = K + 1e-4 I, rows of L one after the other.
class LongDouble {
 public:
  explicit LongDouble(const benchmark::Taps& taps) : taps_(taps) {
    const auto n = static_cast<std::size_t>(taps.places.rows());
    for (std::size_t i = 0; i < n; ++i) {
      LongVector row(i + 1);
      for (std::size_t j = 0; j <= i; ++j) {
        long double sum = kernel(i, taps.places(at(j), 0), taps.places(at(j), 1)) + (i == j ? 1e-4L : 0.0L);
        for (std::size_t k = 0; k < j; ++k) sum -= row[k] * (i == j ? row[k] : rows_[j][k]);
        row[j] = i == j ? std::sqrt(sum) : sum / rows_[j][j];
      }
      rows_.push_back(row);
    }
    for (const Eigen::Index output : {0, 1}) {
      LongVector answers;
      for (std::size_t i = 0; i < n; ++i) answers.push_back(taps.answers(at(i), output));
      reduced_.push_back(reduced(answers));
    }
  }

  struct Posterior {
    long double mean, weight, variance;
  };
  Posterior posterior(double x, double y) const {
    LongVector v;
    for (std::size_t i = 0; i < rows_.size(); ++i) v.push_back(kernel(i, x, y));
    v = reduced(v);
    Posterior out{0.0L, 0.0L, 1.0L};
    for (std::size_t i = 0; i < v.size(); ++i) {
      out.mean += v[i] * reduced_[0][i];
      out.weight += v[i] * reduced_[1][i];
      out.variance -= v[i] * v[i];
    }
    return out;
  }

 private:
  static Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i); }
  long double kernel(std::size_t tap, double x, double y) const {
    const long double dx = (static_cast<long double>(taps_.places(at(tap), 0)) - x) / 3.0L;
    const long double dy = (static_cast<long double>(taps_.places(at(tap), 1)) - y) / 3.0L;
    return std::exp(-0.5L * (dx * dx + dy * dy));
  }
  LongVector reduced(LongVector b) const {
    for (std::size_t i = 0; i < b.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k) b[i] -= rows_[i][k] * b[k];
      b[i] /= rows_[i][i];
    }
    return b;
  }

  const benchmark::Taps& taps_;
  std::vector<LongVector> rows_;
  std::vector<LongVector> reduced_;
};

struct Workload {
  const char* name;
  int grid;
};

/// Lists of tests show a workload by its name.
void PrintTo(const Workload& one, std::ostream* out) { *out << one.name; }

struct Limit {
  PosteriorSettings::Kind engine;
  double mean, variance;
};

class WorkloadAccuracy : public testing::TestWithParam<Workload> {};

TEST_P(WorkloadAccuracy, IsThatPromisedForEveryEngine) {
  const Workload workload = GetParam();
  if (test::kSanitized && workload.grid > 100) GTEST_SKIP() << "takes minutes under a sanitizer; release runs it";
  const benchmark::Taps taps =
      benchmark::read_taps(test::source_folder() / "tests/data" / fmt::format("taps_{}.csv", workload.name));
  const Candidates candidates = benchmark::square(workload.grid);
  const LongDouble truth(taps);
  using Kind = PosteriorSettings::Kind;
  // Of dense, the memory of W3 would be 1.7 GB.
  // After a thousand taps rounding is 5e-11 with AVX-512, for which there was a bound first, and 1.04e-10 with AVX2.
  const bool wide = std::string(simd::fastest().name) == "AVX-512";
  std::vector<Limit> limits{{Kind::grid, workload.grid < 400 || wide ? 1e-10 : 2e-10, 1e-13},
                            {Kind::lowrank, 5e-9, 1e-12}};
  if (workload.grid < 400) limits.push_back({Kind::dense, 1e-10, 1e-13});
  for (const Limit& limit : limits) {
    PosteriorSettings settings;
    settings.engine = limit.engine;
    settings.taps = static_cast<int>(taps.places.rows());
    std::unique_ptr<Process> process;
    benchmark::replay(taps, candidates, benchmark::make_kernel(), settings, &process);
    const Eigen::VectorXd mean = process->mean(0);
    const Eigen::VectorXd weight = process->mean(1);
    const Eigen::VectorXd variance = process->variance();
    double mean_error = 0.0;
    double variance_error = 0.0;
    constexpr int kProbes = 397;  // a prime, so that they fall into all rows and columns
    for (int i = 0; i < kProbes; ++i) {
      const auto candidate = static_cast<int>(static_cast<std::int64_t>(i) * (candidates.size() - 1) / (kProbes - 1));
      const LongDouble::Posterior exact =
          truth.posterior(candidates.target(candidate).x, candidates.target(candidate).y);
      const auto apart = [](long double a, double b) { return static_cast<double>(std::abs(a - b)); };
      mean_error = std::max({mean_error, apart(exact.mean, mean(candidate)), apart(exact.weight, weight(candidate))});
      variance_error = std::max(variance_error, apart(exact.variance, variance(candidate)));
    }
    EXPECT_LE(mean_error, limit.mean) << process->engine();
    EXPECT_LE(variance_error, limit.variance) << process->engine();
    EXPECT_GT(mean_error, 0.0);
    if (limit.engine == Kind::lowrank) {
      EXPECT_LE(std::max(mean_error, variance_error), process->error_bound() + 1e-10) << "its own bound holds";
    }
    RecordProperty(process->engine(), fmt::format("mean {:.2g} variance {:.2g} bound {:.2g}", mean_error,
                                                  variance_error, process->error_bound()));
    fmt::print("{} {}: mean {:.2g}, variance {:.2g}, bound {:.2g}\n", workload.name, process->engine(), mean_error,
               variance_error, process->error_bound());
  }
}

INSTANTIATE_TEST_SUITE_P(Of, WorkloadAccuracy,
                         testing::Values(Workload{"w1", 47}, Workload{"w2", 231}, Workload{"w3", 461}),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace palpate
