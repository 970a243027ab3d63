// SPDX-License-Identifier: MIT
// The conditions that stop a run before its tap budget is spent.
//
// The rule `expected_rmse`: the errors of neighbouring cells are correlated, so the RMSE of one scene deviates from its
// expectation. A rule that is checked after each tap stops when the belief happens to be optimistic. So the expectation
// must be below the bound by a margin. The largest deviation comes from an object that no tap has touched: it adds
// little to the expectation, but its full height to the error. If the belief computes the probability of such an
// object, that probability must be small, and a smaller margin suffices. The constants were chosen on seven scenes and
// checked on others; stopping_table in tests/benchmark makes the table.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/tap_record.hpp"

#include <optional>
#include <string>

namespace palpate {

/// Factor by which the expected RMSE must be below its bound: if the probability of an untouched object is known
/// (kMargin), and if not (kLargeMargin).
constexpr double kMargin = 1.55;
constexpr double kLargeMargin = 1.75;
/// Largest probability of an untouched object with which a run may stop.
constexpr double kMostUndiscovered = 0.23;

/// Returns whether an expected RMSE (metres; nullopt if unknown) is low enough for `bound`, metres.
bool is_good_enough(std::optional<double> expected_rmse, std::optional<double> undiscovered, double bound);

/// Adds the quantities that the configured rules read.
void add_readers(const StopOptions& options, ReadPlan& plan);

/// Returns the rule that ends the run before the models are updated; nullopt if none does.
std::optional<std::string> stop_before_inference(const StopOptions& options, const RunResult& counts);

/// Returns the rule that reads the belief and ends the run after the initial design; nullopt if none does.
std::optional<std::string> stop_after_inference(const StopOptions& options, const BeliefView& belief);

}  // namespace palpate
