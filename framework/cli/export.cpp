// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "record/files.hpp"
#include "record/run_directory.hpp"
#include "report/exchange/exchange.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

/// That more taps may follow is no mistake, but whoever reads the files should know.
void mention_state(const fs::path& directory) {
  const RunStatus status = read_status(directory);
  if (status.state == RunStatus::State::done) return;
  std::string how = "is unfinished";
  if (status.state == RunStatus::State::running) how = "is under way";
  if (status.state == RunStatus::State::failed) how = "failed: " + status.stop_reason;
  mention(fmt::format("this run {}; what is written is what its first {} taps tell\n", how, status.taps));
}

fs::path folder_for(const fs::path& directory, const std::string& to) {
  return to.empty() ? make_inner_folder(directory / "export") : make_folder(to);
}

void write_into(const fs::path& folder, const char* name, const std::string& text) {
  write_file(folder / name, text);
  print_out("{}\n", (folder / name).string());
}

/// The parts of a record, a table each: needs no plugin, and no tap.
int export_tables(const fs::path& directory, const std::string& to) {
  const RunRecord record = read_run_record(directory);
  if (!record.manifest) throw Error(directory.string(), "holds no record", {}, Error::Kind::run);
  const fs::path folder = folder_for(directory, to);
  mention_state(directory);
  write_into(folder, kTapsTable, to_csv(record.taps));
  write_into(folder, "timings.csv", to_csv(timing_rows(record.timings)));
  write_into(folder, "objects.csv", to_csv(record.objects));
  write_into(folder, "attempts.csv", to_csv(record.attempts));
  return kDone;
}

}  // namespace

int export_run(Program& program, const std::string& directory, const std::string& format, const std::string& to) {
  check_one_run(directory);
  if (format == "csv") return export_tables(directory, to);
  const Recording recording = read_recording(program, directory);
  Playback playback(program, recording);
  playback.advance_to(static_cast<int>(recording.taps.size()));
  const std::string run = fmt::format("run {} {}", recording.config.id, recording.config.options.name);
  auto* const any_side = dynamic_cast<FromAnySide*>(&playback.experiment());
  const std::string surface =
      any_side != nullptr ? surface_ply(*any_side, run) : surface_ply(reconstruct(playback.from_above()), run);
  const fs::path folder = folder_for(recording.directory, to);
  if (any_side != nullptr && fs::equivalent(folder, recording.directory)) {
    throw Error(folder.string(), "has the surface.ply of the record, which nothing is written over",
                "choose another folder");
  }
  mention_state(recording.directory);
  write_into(folder, "surface.ply", surface);
  write_into(folder, "taps.ply", taps_ply(recording, playback.experiment().counts(), run));
  return kDone;
}

}  // namespace palpate::cli
