// SPDX-License-Identifier: MIT
// Sweeps that are made up for a comparison: no directory stands behind them.
#pragma once

#include "analysis/compare_report.hpp"
#include "support/testing.hpp"

namespace palpate::test {

/// A job of a made-up sweep over strategy, kernel and seed: its value, or how it failed.
struct MadeJob {
  std::string strategy;
  std::string kernel;
  int seed;
  std::optional<double> rmse;
  std::string status = "done";  ///< "absent" has no row
};

struct MadeSweep {
  Sweep sweep{"runs/x/0123456789ab", {"acquisition", "kernel", "seed"}, {}};
  std::vector<Row> results;

  explicit MadeSweep(const std::vector<MadeJob>& jobs) {
    for (const MadeJob& one : jobs) {
      const int index = static_cast<int>(sweep.jobs.size());
      sweep.jobs.push_back({index, "id", {one.strategy, one.kernel, std::to_string(one.seed)}});
      if (one.status == "absent") continue;
      Row row;
      row.add("job", index);
      row.add("acquisition", one.strategy);
      row.add("kernel", one.kernel);
      row.add("seed", std::to_string(one.seed));
      row.add("status", one.status);
      row.add("rmse_m", one.rmse);
      row.add("footprint_iou", one.rmse ? std::optional(1.0 - *one.rmse) : std::nullopt);
      row.add("coverage_95", 0.9);
      row.add("nlpd", std::optional<double>());
      row.add("found", one.rmse && *one.rmse < 0.5);
      results.push_back(std::move(row));
    }
  }

  Comparison by(const std::vector<std::string>& keys, const std::string& metric = "rmse_m",
                const std::optional<std::string>& baseline = {}, const std::string& where = "") const {
    if (where.empty()) return compare(sweep, results, {keys, metric, nullptr, baseline});
    const WhereCondition condition(Tree::scalar(where, true));
    return compare(sweep, results, {keys, metric, &condition, baseline});
  }

  std::string refusal(const std::vector<std::string>& keys, const std::string& metric = "rmse_m",
                      const std::optional<std::string>& baseline = {}, const std::string& where = "") const {
    return error_of([&] { by(keys, metric, baseline, where); });
  }
};

}  // namespace palpate::test
