// SPDX-License-Identifier: MIT
#include "experiment/stop_rules.hpp"

#include "config/comparison.hpp"

#include <Eigen/Core>

namespace palpate {
namespace {

/// A rule that reads the belief. A new rule needs an option and a row in kRules.
struct Rule {
  const char* name;
  std::optional<double> StopOptions::*bound;
  const char* reads;
  Stage from;
  bool (*holds)(const BeliefView& belief, double bound);
};

constexpr Rule kRules[] = {
    {"max_standard_deviation", &StopOptions::max_standard_deviation, quantity::kMeasurementStd, Stage::first_scored_tap,
     [](const BeliefView& belief, double bound) {
       const double most = belief.values(quantity::kMeasurementStd).maxCoeff<Eigen::PropagateNaN>();
       return satisfies(most, Relation::at_most, bound);
     }},
    {"expected_rmse", &StopOptions::expected_rmse, quantity::kExpectedRmse, Stage::first_object_contact,
     [](const BeliefView& belief, double bound) {
       return is_good_enough(belief.scalar(quantity::kExpectedRmse), belief.scalar(quantity::kUndiscoveredProbability),
                             bound);
     }},
};

}  // namespace

bool is_good_enough(std::optional<double> expected_rmse, std::optional<double> undiscovered, double bound) {
  const double margin = undiscovered ? kMargin : kLargeMargin;
  return expected_rmse && satisfies(margin * *expected_rmse, Relation::at_most, bound) &&
         (!undiscovered || satisfies(undiscovered, Relation::at_most, kMostUndiscovered));
}

void add_readers(const StopOptions& options, ReadPlan& plan) {
  for (const Rule& rule : kRules) {
    if (options.*rule.bound) plan.readers.push_back({std::string("stop.") + rule.name, {rule.reads}, rule.from});
  }
}

std::optional<std::string> stop_before_inference(const StopOptions& options, const RunResult& counts) {
  if (options.robot_time && satisfies(counts.robot_seconds, Relation::at_least, *options.robot_time))
    return "robot_time";
  return std::nullopt;
}

std::optional<std::string> stop_after_inference(const StopOptions& options, const BeliefView& belief) {
  for (const Rule& rule : kRules) {
    if (options.*rule.bound && rule.holds(belief, *(options.*rule.bound))) return rule.name;
  }
  return std::nullopt;
}

}  // namespace palpate
