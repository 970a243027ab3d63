// SPDX-License-Identifier: MIT
#include "cli/execute_run.hpp"

#include "cli/display.hpp"
#include "cli/gate.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "cli/step.hpp"
#include "cli/watcher.hpp"
#include "config/catch_error.hpp"
#include "record/json.hpp"

#include <memory>
#include <optional>

namespace palpate::cli {

int execute_run(const CommandEnvironment& program, const ResolvedConfig& config, const RunOutput& output,
                const RunAction& action) {
  listen_for_interrupts();
  outlive_reader();
  const std::unique_ptr<TapConfirmation> step = TapConfirmation::when(output.step, config.options, program.interrupted);
  std::vector<Observer*> observers;
  if (step) observers.push_back(step.get());
  std::optional<Watcher> watcher;
  if (!output.watched.empty()) observers.push_back(&watcher.emplace(program, output.watched));
  std::optional<TapTable> table;
  if (output.table) observers.push_back(&table.emplace(config.options.taps));
  const GateOutput gate{config.options.name, output.junit, output.table};
  RunConclusion report;
  const std::optional<Error> trouble = catch_error([&] {
    report = action(observers);
    // A run that makes no further tap does not call announce(), which starts the watcher.
    if (watcher) watcher->start();
  });
  std::vector<RunOutcome> runs{{"run " + config.id, "", trouble ? trouble->what() : "", {}}};
  // Continuous integration must see a failed run as a result.
  if (trouble && trouble->kind() == Error::Kind::run) write_junit(judge(config.expectations, runs), runs, gate);
  if (trouble) throw *trouble;
  set_record_line(record_line(report));
  if (output.json) print_data(to_json(report.summary));
  if (output.table) print_summary(report);
  if (report.interrupted) return kInterrupted;
  runs.front().summary = report.summary;
  return conclude(config.expectations, runs, gate) ? kDone : kFailed;
}

}  // namespace palpate::cli
