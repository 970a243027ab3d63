// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "config/scale.hpp"
#include "record/run_directory.hpp"

namespace palpate::cli {

int status(Program& program, const std::string& directory) {
  if (is_sweep(directory)) return status_of_sweep(program, directory);
  // The config is read and not resolved: a status needs no plugin.
  const Tree config = read_run_config(directory);
  const RunStatus status = read_status(directory);
  const auto text_at = [&](const char* key) {
    const Tree* value = config.find(key);
    return value != nullptr ? value->text : std::string("?");
  };
  const std::string reason = status.stop_reason.empty() ? "" : ": " + status.stop_reason;
  print_out("{}: {} after {} of {} taps{}\n", text_at("name"), state_name(status.state), status.taps, text_at("taps"),
            reason);
  if (status.expected_rmse) {
    print_out("expected error: {} over the scene{}\n", usual_scale(Unit::metre).quantity(*status.expected_rmse),
              status.state == RunStatus::State::done ? "" : ", before the last tap");
  }
  if (status.cut) {
    mention((std::filesystem::path(directory) / kRecordFile).string() +
            ": was cut short, because summary.json says that the run had ended; 'palpate resume' repeats the missing "
            "part\n");
  }
  return kDone;
}

}  // namespace palpate::cli
