// SPDX-License-Identifier: MIT
// A run as its directory has it: config, taps, summary, and where the values of its config were written.
#pragma once

#include "experiment/tap_record.hpp"
#include "host/host.hpp"
#include "record/record_reader.hpp"
#include "record/resolved.hpp"
#include "record/row.hpp"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// Name and identity of a run (ResolvedConfig::identity), as its manifest has them; "" if they are not known.
struct RunIdentity {
  std::string name;
  std::string identity;
};
RunIdentity read_identity(const std::filesystem::path& directory);

/// Returns the config.yaml of a run directory as it stands. Throws Error if there is none, or one of a later format.
Tree read_run_config(const std::filesystem::path& directory);

/// Returns the places where the values of a run's config were written when it began, by the paths of the values: the
/// comments of its config.yaml. Empty if that cannot be read.
std::map<std::string, std::string> recorded_origins(const std::filesystem::path& directory);

/// Returns the name of the group of this `kind` ("scene") whose file has written the first of the values at paths that
/// begin with `path`, by their recorded origins; "" for none.
std::string recorded_group(const std::map<std::string, std::string>& origins, const std::string& path,
                           const std::string& kind);

/// Returns the config of a run directory, resolved. Throws Error if it does not resolve to its recorded identity.
ResolvedConfig load_run(const PluginHost& host, const std::filesystem::path& directory);

/// What a run directory holds. The run may be under way, or have failed.
struct RecordedRun {
  std::filesystem::path directory;
  ResolvedConfig config;
  std::vector<Row> rows;          ///< one per tap
  std::vector<TapRecord> taps;    ///< the same, without state and errors
  std::vector<TapTimes> timings;  ///< of most taps
  std::optional<Tree> manifest;   ///< nullopt before a run has begun
  std::optional<Row> summary;     ///< of a run that ended

  /// Whether the scene of the config is what was tapped.
  bool truth_known() const { return rows.front().flag("true_on_object").has_value(); }
  /// Whether taps came from any side, so that the surface is closed; else from above.
  bool is_any_side() const { return !taps.empty() && !taps.front().request.line.from_above; }
  /// Whether the run ended because it could not continue.
  bool failed() const { return summary && summary->text("status") == "failed"; }
  /// Whether a program scored: it is not started again to read a record.
  bool scored_by_program() const { return config.notes.plugins.count({"acquisition", "program"}) != 0; }
};

/// Throws Error for a directory without a recorded tap, a damaged one, and one whose config does not match its id.
RecordedRun read_recorded_run(const PluginHost& host, const std::filesystem::path& directory);

}  // namespace palpate
