// SPDX-License-Identifier: MIT
#include "cli/command_line.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "cli/sweep.hpp"
#include "config/display_units.hpp"
#include "record/run_directory.hpp"

namespace palpate::cli {

namespace {

struct StatusArguments {
  std::string directory;
};

int status(CommandEnvironment& program, const StatusArguments& arguments) {
  const std::string& directory = arguments.directory;
  if (is_sweep(directory)) return call_in_whole(status_of_sweep, program, directory);
  // The config is read but not resolved, because resolving needs the plugins.
  const Tree config = read_run_config(directory);
  const RunStatus status = read_status(directory);
  const auto text_at = [&](const char* key) {
    const Tree* value = config.find(key);
    return value != nullptr ? value->text : std::string("?");
  };
  const std::string reason = status.stop_reason.empty() ? "" : ": " + status.stop_reason;
  print_out("{}: {} after {} of {} taps{}\n", text_at("name"), state_name(status.state), status.taps, text_at("taps"),
            reason);
  if (status.expected_rmse)
    print_out("expected error: {} over the scene{}\n", usual_scale(Unit::metre).quantity(*status.expected_rmse),
              status.state == RunStatus::State::done ? "" : ", before the last tap");
  if (status.cut)
    print_message(
        (std::filesystem::path(directory) / kRecordFile).string() +
        ": was cut short, because summary.json says that the run had ended; 'palpate resume' repeats the missing "
        "part\n");
  return kDone;
}

}  // namespace

void add_status(CommandLine& line) {
  auto [command, arguments] = line.add<StatusArguments>("status", "Show the state of a run or sweep", status,
                                                        [](NeededParts& needs, const StatusArguments& given) {
                                                          if (is_sweep(given.directory)) needs.whole();
                                                        });
  command.record("DIR", arguments.directory, RecordKind::any, "run or sweep");
  command.examples({"palpate status runs/object_i/422cd70eb5f7", "palpate status runs/first/*"});
}

}  // namespace palpate::cli
