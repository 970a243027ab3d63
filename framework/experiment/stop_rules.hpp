// SPDX-License-Identifier: MIT
// The conditions that stop a run before its tap budget is spent.
//
// The expected RMSE: errors of neighbouring cells go together, so that the RMSE of one scene strays from its
// expectation, and a rule that looks after each tap stops where the belief is lucky. So the expectation must be below
// the bound with a margin. It strays most by an object that no tap has touched, which adds little to the expectation
// and all of its height to the error: where the belief knows the probability of such an object, that probability must
// be small, and a smaller margin will do. The constants were chosen on seven scenes and checked on others;
// stopping_table in tests/benchmark makes the table.
#pragma once

#include "experiment/experiment_options.hpp"
#include "experiment/tap_record.hpp"

#include <optional>
#include <string>

namespace palpate {

/// Factor by which the expected RMSE must be below its bound, if the probability of an untouched object is known, and
/// if not.
constexpr double kMargin = 1.55;
constexpr double kLargeMargin = 1.75;
/// Largest probability of an untouched object at a stop.
constexpr double kMostUndiscovered = 0.23;

/// Whether an expected RMSE (metres, nullopt: not known) is good enough for `bound`, metres.
bool is_good_enough(std::optional<double> expected_rmse, std::optional<double> undiscovered, double bound);

/// Adds the readers of the rules that are set.
void add_readers(const StopOptions& options, ReadPlan& plan);

/// Returns the rule that ends the run before the models are brought up to date; nullopt if none does.
std::optional<std::string> stop_before_inference(const StopOptions& options, const RunResult& counts);

/// Returns the rule that ends the run by what the belief says, after the initial design; nullopt if none does.
std::optional<std::string> stop_after_inference(const StopOptions& options, const BeliefView& belief);

}  // namespace palpate
