// SPDX-License-Identifier: MIT
#include "benchmark/workload.hpp"

#include "experiment/pick_best.hpp"
#include "support/grids.hpp"
#include "support/plugins.hpp"
#include "support/support.hpp"

#include <palpate/error.hpp>

#include <chrono>
#include <fstream>
#include <sstream>
#include <utility>

namespace palpate::benchmark {
namespace {

constexpr double kSide = 23.0;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

Taps read_taps(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw Error(file.string(), "cannot be read");
  std::vector<double> numbers;
  std::string line;
  std::getline(in, line);
  if (line != "x,y,height,on_object") throw Error(file.string(), "does not begin with x,y,height,on_object");
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::string cell;
    while (std::getline(cells, cell, ',')) numbers.push_back(std::stod(cell));
  }
  const auto rows = static_cast<Eigen::Index>(numbers.size() / 4);
  const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>> all(numbers.data(), rows, 4);
  return {all.leftCols(2), all.rightCols(2)};
}

CandidateGrid square(int count) {
  Eigen::VectorXd places(count);
  for (int i = 0; i < count; ++i) places(i) = kSide * i / std::max(1, count - 1);
  return test::product_grid(places, places);
}

std::shared_ptr<Kernel> make_kernel() {
  // The kernel cares for ratios of lengths only, so that a metre may stand for a centimetre.
  return test::make<Kernel>(test::shared_host(), "rbf", "{length_scale: 3 m}");
}

Replay replay(const Taps& taps, const CandidateGrid& candidates, const std::shared_ptr<Kernel>& kernel,
              const EngineSettings& settings, std::unique_ptr<test::GaussianProcess>* last) {
  Replay out;
  const auto count = static_cast<std::size_t>(taps.places.rows());
  out.choices.reserve(count);
  out.seconds.reserve(count);
  const auto start = Clock::now();
  const std::vector<GpSettings> outputs(2, {1.0, 1e-2, 0.0, 0.0});
  auto process = std::make_unique<test::GaussianProcess>(kernel, outputs, candidates, settings);
  process->show(2);
  Eigen::VectorXd uncertainty(candidates.size());
  Eigen::VectorXd weight(candidates.size());
  const Allowed allowed = Allowed::Constant(candidates.size(), true);
  auto before = Clock::now();
  for (Eigen::Index i = 0; i < taps.places.rows(); ++i) {
    process->add({taps.places(i, 0), taps.places(i, 1)}, taps.answers.row(i).transpose());
    if (i + 1 < kInitialTaps) continue;
    process->read_relative_variance(uncertainty);
    process->read_mean(1, weight);
    weight.array() *= uncertainty.array();
    out.choices.push_back(pick_best(weight, allowed, 1.0, 0.0).candidate);
    const auto now = Clock::now();
    out.seconds.push_back(std::chrono::duration<double>(now - std::exchange(before, now)).count());
  }
  out.total = seconds_since(start);
  if (last != nullptr) *last = std::move(process);
  return out;
}

}  // namespace palpate::benchmark
