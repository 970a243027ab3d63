// SPDX-License-Identifier: MIT
// The conditions that stop a run before its tap budget is spent.
//
// The rule `expected_rmse` needs a margin: the errors of neighbouring cells are correlated, so the RMSE of one scene
// deviates from its expectation. A rule that is checked after each tap tends to stop after a tap for which the belief
// happens to be too optimistic. So the expectation must be below the bound by a margin. The largest deviation comes
// from an object that no tap has touched: this object adds little to the expectation, but its full height to the error.
// If the belief computes the probability of such an object, this probability must be small, and a smaller margin
// suffices. The constants were chosen on seven scenes and checked on other scenes; stopping_table in tests/benchmark
// prints the results.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/tap_record.hpp"

#include <optional>
#include <string>

namespace palpate {

/// The expected RMSE times this factor must be at most the bound. kMargin applies if the belief computes the
/// probability of an untouched object, else kLargeMargin applies.
constexpr double kMargin = 1.55;
constexpr double kLargeMargin = 1.75;
/// Largest probability of an untouched object at which a run may stop.
constexpr double kMostUndiscovered = 0.23;

/// Returns whether an expected RMSE (metres; nullopt if unknown) is low enough for `bound`, metres. `undiscovered`:
/// probability of an untouched object; nullopt if unknown.
bool is_good_enough(std::optional<double> expected_rmse, std::optional<double> undiscovered, double bound);

/// Adds the quantities that the configured rules read.
void add_readers(const StopOptions& options, ReadPlan& plan);

/// Returns the name of the first rule that ends the run before the models are updated; nullopt if no rule does.
std::optional<std::string> stop_before_inference(const StopOptions& options, const RunResult& counts);

/// Returns the name of the first rule that reads the belief and ends the run, which is possible only after the initial
/// design; nullopt if no rule does.
std::optional<std::string> stop_after_inference(const StopOptions& options, const BeliefView& belief);

}  // namespace palpate
