// SPDX-License-Identifier: MIT
// What a posterior engine, the spacing of the candidates and refits cost, and what they are worth: whole experiments of
// 200 taps in process, on the same seeds, printed as a table and, where asked for, written as CSV.
//   build/release/tests/posterior_trade [--long] [--seeds N] [--out FILE]
#include "support/runs.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <vector>

namespace {

using namespace palpate;

constexpr std::array<int, 3> kSpacings{1, 2, 5};  // mm
constexpr std::array<const char*, 3> kEngines{"dense", "grid", "lowrank"};

/// Keeps every record and adds up the seconds.
class Timer final : public test::Collector {
 public:
  std::array<double, kPhases> seconds{};
  void record(const TapRecord& tap, const std::array<double, kPhases>& since) override {
    Collector::record(tap, since);
    add(since);
  }
  void add(const std::array<double, kPhases>& since) {
    std::transform(since.begin(), since.end(), seconds.begin(), seconds.begin(), std::plus<>());
  }
};

struct Outcome {
  std::array<double, kPhases> seconds{};
  std::vector<TapRecord> taps;
  Eigen::VectorXd mean, variance;  ///< of the heights at the end: metres, and relative to the prior
  double error_bound = 0.0;
  double rmse = 0.0;
};

/// With `past`, those taps instead of own choices.
Outcome run(std::vector<std::string> overrides, const std::string& engine, const std::vector<TapRecord>& past = {}) {
  overrides.push_back("belief.engine.type=" + engine);
  const ResolvedConfig config = test::shipped_config("paper/object_i_right.yaml", overrides);
  Experiment experiment(config.options, {test::shared_host()});
  experiment.resume(past);
  Timer timer;
  experiment.run(timer);
  Outcome out;
  Belief& belief = experiment.belief();
  belief.update();  // takes the last tap
  belief.infer();
  out.mean = belief.values(quantity::kHeightMean);
  out.variance = belief.values(quantity::kUncertainty);
  timer.add(experiment.clock().take());
  out.seconds = timer.seconds;
  out.taps.assign(timer.taps.begin(), timer.taps.end());
  const RunResult result = experiment.result();
  out.error_bound = test::number_of(result.state, "height_gp.error_bound").value();
  out.rmse = result.errors.rmse.value();
  return out;
}

bool same_taps(const Outcome& a, const Outcome& b) {
  const auto is_same = [](const TapRecord& p, const TapRecord& q) {
    return p.target().x == q.target().x && p.target().y == q.target().y;
  };
  return std::equal(a.taps.begin(), a.taps.end(), b.taps.begin(), b.taps.end(), is_same);
}

/// A row of the table, of all seeds.
struct Row {
  std::vector<std::array<double, kPhases>> seconds;
  double mean_error = 0.0, variance_error = 0.0, error_bound = 0.0;  ///< the largest
  double rmse = 0.0, change = 0.0, most_change = 0.0;                ///< sum, sum, and the largest
  int same = 0;                                                      ///< seeds where the taps are those of dense

  void add(const Outcome& own, const Outcome& after, const Outcome& dense, double finest) {
    seconds.push_back(own.seconds);
    mean_error = std::max(mean_error, (after.mean - dense.mean).cwiseAbs().maxCoeff());
    variance_error = std::max(variance_error, (after.variance - dense.variance).cwiseAbs().maxCoeff());
    error_bound = std::max(error_bound, after.error_bound);
    rmse += own.rmse;
    change += own.rmse - finest;
    most_change = std::max(most_change, std::abs(own.rmse - finest));
    same += same_taps(own, dense) ? 1 : 0;
  }
  double median(Phase phase) {
    const auto before = [i = static_cast<std::size_t>(phase)](const auto& a, const auto& b) { return a[i] < b[i]; };
    std::sort(seconds.begin(), seconds.end(), before);
    return seconds[seconds.size() / 2][static_cast<std::size_t>(phase)];
  }
};

void measure(std::ostream& csv, const std::vector<int>& periods, int seeds, int taps) {
  const auto line = [&](const std::vector<std::string>& cells) {
    for (const std::string& cell : cells) fmt::print("{:>16}", cell);
    fmt::print("\n");
    std::fflush(stdout);
    csv << fmt::format("{}\n", fmt::join(cells, ","));
  };
  line({"engine", "spacing_mm", "refit_every", "seconds", "infer_s", "acquire_s", "fit_s", "mean_error_m",
        "variance_error", "error_bound", "rmse_m", "rmse_change_m", "most_change_m", "taps_as_dense"});
  for (const int every : periods) {
    std::vector<double> finest;  // rmse of dense at the least spacing, a seed each
    for (const int spacing : kSpacings) {
      std::array<Row, kEngines.size()> rows;
      for (int seed = 1; seed <= seeds; ++seed) {
        std::vector<std::string> overrides{fmt::format("seed={}", seed), fmt::format("taps={}", taps),
                                           fmt::format("candidates.spacing={} mm", spacing), "candidates.count=none"};
        if (every > 0) overrides.insert(overrides.end(), {"fitting=ceres", fmt::format("fitting.every={}", every)});
        Outcome dense;
        for (std::size_t i = 0; i < kEngines.size(); ++i) {
          const Outcome own = run(overrides, kEngines[i]);
          if (i == 0) dense = own;
          if (static_cast<int>(finest.size()) < seed) finest.push_back(own.rmse);
          // The errors are those after the taps of dense, whatever the engine chose itself.
          const Outcome after = same_taps(own, dense) ? own : run(overrides, kEngines[i], dense.taps);
          rows[i].add(own, after, dense, finest[static_cast<std::size_t>(seed) - 1]);
        }
      }
      for (std::size_t i = 0; i < kEngines.size(); ++i) {
        Row& row = rows[i];
        const double infer = row.median(Phase::infer), acquire = row.median(Phase::acquire),
                     fit = row.median(Phase::fit);
        line({kEngines[i], fmt::format("{}", spacing), every > 0 ? fmt::format("{}", every) : "never",
              fmt::format("{:.4f}", infer + acquire + fit), fmt::format("{:.4f}", infer),
              fmt::format("{:.4f}", acquire), fmt::format("{:.4f}", fit), fmt::format("{:.1e}", row.mean_error),
              fmt::format("{:.1e}", row.variance_error), fmt::format("{:.1e}", row.error_bound),
              fmt::format("{:.6f}", row.rmse / seeds), fmt::format("{:+.1e}", row.change / seeds),
              fmt::format("{:.1e}", row.most_change), fmt::format("{} of {}", row.same, seeds)});
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Engine x spacing of candidates x refits: seconds, error against dense, change in rmse_m");
  bool also_long = false;
  int seeds = 3;
  int taps = 200;
  std::string file;
  app.add_flag("--long", also_long, "also with a refit every 10 taps");
  app.add_option("--seeds", seeds, "runs a row, of the seeds from 1 on")->check(CLI::Range(1, 1000));
  app.add_option("--taps", taps, "a run")->check(CLI::Range(4, 2000));
  app.add_option("--out", file, "also a CSV file, such as runs/reference/posterior_trade.csv");
  CLI11_PARSE(app, argc, argv);
  try {
    std::ofstream csv;
    if (!file.empty()) csv.open(file);
    if (!csv) throw std::runtime_error(file + ": cannot be written");
    measure(csv, also_long ? std::vector<int>{0, 50, 10} : std::vector<int>{0, 50}, seeds, taps);
  } catch (const std::exception& trouble) {
    fmt::print(stderr, "posterior_trade: {}\n", trouble.what());
    return 1;
  }
  return 0;
}
