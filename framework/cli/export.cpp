// SPDX-License-Identifier: MIT
#include "cli/export.hpp"

#include "cli/display.hpp"
#include "cli/output.hpp"
#include "record/files.hpp"
#include "record/run_directory.hpp"
#include "report/history.hpp"
#include "report/mesh_export.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

/// Warns on stderr if the run has not ended, because the files then hold only its first `taps` taps.
void warn_state(const fs::path& directory, std::size_t taps) {
  const RunStatus status = read_status(directory);
  if (status.state == RunStatus::State::done) return;
  std::string how = "is unfinished";
  if (status.state == RunStatus::State::running) how = "is still running";
  if (status.state == RunStatus::State::failed) how = "failed: " + status.stop_reason;
  print_message(fmt::format("this run {}; the export uses its first {} taps\n", how, taps));
}

/// Creates the output folder and returns it. Throws Error if the output folder is the directory of the run, because
/// files of the run have the same names.
fs::path folder_for(const fs::path& directory, const std::string& to) {
  if (to.empty()) return make_inner_folder(directory / "export");
  fs::path folder = make_folder(to);
  if (fs::equivalent(folder, directory))
    throw Error(folder.string(), "is the folder of the record, whose files are never overwritten",
                "choose another folder");
  return folder;
}

void write_into(const fs::path& folder, const char* name, const std::string& text) {
  write_file(folder / name, text);
  print_out("{}\n", (folder / name).string());
}

/// Writes one table per part of the record. The export needs no plugin, and the run may have no tap.
int export_tables(const fs::path& directory, const std::string& to) {
  const RunRecord record = read_run_record(directory);
  if (!record.manifest)
    throw Error(directory.string(), "contains no record", "start the run first, or name another run", Error::Kind::run);
  const fs::path folder = folder_for(directory, to);
  warn_state(directory, record.taps.size());
  write_into(folder, kTapsTable, to_csv(record.taps));
  write_into(folder, "timings.csv", to_csv(timing_rows(record.timings)));
  write_into(folder, "objects.csv", to_csv(record.objects));
  write_into(folder, "attempts.csv", to_csv(record.attempts));
  return kDone;
}

}  // namespace

int export_run(CommandEnvironment& program, const ExportArguments& arguments) {
  check_one_run(arguments.directory);
  if (arguments.format == "csv") return export_tables(arguments.directory, arguments.to);
  const RecordedRun recording = read_recorded_run(program.host, arguments.directory);
  RunReplay playback(program, recording, page_readers(recording));
  playback.advance_to(static_cast<int>(recording.taps.size()));
  const std::string run = fmt::format("run {} {}", recording.config.id, recording.config.options.name);
  const std::string surface = recording.is_any_side()
                                  ? surface_ply(playback.experiment().belief().surface(kFineResolution), run)
                                  : surface_ply(reconstruct(playback.experiment()), run);
  if (playback.truth_lost())
    print_message(fmt::format("surface.ply has no true heights: {}\n", playback.truth_lost()->what()));
  const fs::path folder = folder_for(recording.directory, arguments.to);
  warn_state(recording.directory, recording.taps.size());
  write_into(folder, "surface.ply", surface);
  write_into(folder, "taps.ply", taps_ply(recording, playback.experiment().counts(), run));
  return kDone;
}

}  // namespace palpate::cli
