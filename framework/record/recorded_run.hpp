// SPDX-License-Identifier: MIT
// Reads a run from its directory: config, taps, summary, and the source locations of the values in its config.
#pragma once

#include "experiment/tap_record.hpp"
#include "host/plugin_host.hpp"
#include "record/record_reader.hpp"
#include "record/resolved_config.hpp"
#include "record/row.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Name and identity of a run (ResolvedConfig::identity) from its manifest; "" if they are not known.
struct RunIdentity {
  std::string name;
  std::string identity;
};
RunIdentity read_identity(const std::filesystem::path& directory);

/// Returns the unresolved config.yaml of a run directory. Throws Error if there is none, or if it has a later format.
Tree read_run_config(const std::filesystem::path& directory);

/// Returns the source location (such as FILE:LINE:COLUMN) of each value of a run's config, by the dotted path of the
/// value. The locations are those at the start of the run; they come from the comments in config.yaml. Returns an empty
/// map if config.yaml cannot be read.
std::map<std::string, std::string> recorded_origins(const std::filesystem::path& directory);

/// Returns the name of the group of this `kind` (such as "scene") that set values whose paths begin with `path`. If
/// several groups set such values, returns the group of the first path in the order of the paths. Returns "" if no
/// group set such a value. `origins` comes from recorded_origins().
std::string recorded_group(const std::map<std::string, std::string>& origins, const std::string& path,
                           const std::string& kind);

/// Returns the resolved config of a run directory. Throws Error if its identity differs from the recorded identity.
ResolvedConfig load_run(const PluginHost& host, const std::filesystem::path& directory);

/// Content of a run directory. The run may be unfinished or have failed.
struct RecordedRun {
  std::filesystem::path directory;
  ResolvedConfig config;
  std::vector<Row> rows;          ///< one per tap
  std::vector<TapRecord> taps;    ///< the same taps, without the models' states and the errors
  std::vector<TapTimes> timings;  ///< times of the taps; a kill may have lost some
  std::optional<Tree> manifest;   ///< nullopt before the start of the run
  std::optional<Row> summary;     ///< nullopt before the end of the run

  /// Returns whether the taps were made in the scene of the config, so that the truth is known.
  bool truth_known() const { return rows.front().flag("true_on_object").has_value(); }
  /// Returns whether the taps came from any side, so that the surface is closed. Otherwise the taps came from above.
  bool is_any_side() const { return !taps.empty() && !taps.front().request.line.from_above; }
  /// Returns whether the run ended because it could not continue.
  bool failed() const { return summary && summary->text("status") == "failed"; }
  /// Returns whether an external program scored the candidates. Reading a record does not start this program.
  bool scored_by_program() const { return config.notes.plugins.count({"acquisition", "program"}) != 0; }
};

/// Returns the run in `directory`. Throws Error if it has no recorded tap, is damaged, or has a config that does not
/// match its id.
RecordedRun read_recorded_run(const PluginHost& host, const std::filesystem::path& directory);
/// Returns the run in `directory`, whose config is `config`.
RecordedRun read_recorded_run(ResolvedConfig config, const std::filesystem::path& directory);

}  // namespace palpate
