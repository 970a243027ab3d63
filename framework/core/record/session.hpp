// SPDX-License-Identifier: MIT
// One run from its config to its summary, with the directory in between: started, carried on, or played again.
#pragma once

#include "experiment/tap_record.hpp"
#include "plugin/host.hpp"
#include "record/build_info.hpp"
#include "record/resolved.hpp"
#include "record/row.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

class Experiment;

/// What every run of this process shares.
struct Workshop {
  const PluginHost& host;
  const Installation& installation;
  std::vector<std::string> command_line;
  const std::atomic<bool>* interrupted;  ///< set by the user's wish to stop; may be null
};

/// Names of files that an ended run had lost.
struct Restored {
  std::vector<std::string> made;  ///< again, byte for byte
  std::vector<std::string> lost;  ///< left out: this build makes others from the same taps
};

/// How a run ended.
struct RunReport {
  std::filesystem::path directory;
  bool already_done = false;  ///< nothing was run: the directory held the finished run
  bool interrupted = false;   ///< it can be resumed; there is no summary
  Row summary;                ///< the fields of summary.json
  Restored restored{};        ///< of a finished run
};

/// Somebody who is asked before every tap of a backend that moves what only a person can put right.
class Supervisor {
 public:
  virtual ~Supervisor() = default;
  /// Whether the tap may be made. If not, the run ends, interrupted, as if the tap had never been chosen.
  virtual bool permits(const TapRecord& tap, const Preview& preview) = 0;
};

/// Who reads which model of this config. Of backends only the simulator is built for this, as others may connect to
/// something: what they would read is left out. Throws Error for what only building finds out.
std::vector<ModelReader> readers_of(const Workshop& workshop, const ResolvedConfig& config);

/// <runs>/<slug>/<id>.
std::filesystem::path directory_of(const ResolvedConfig& config, const std::filesystem::path& runs);

/// Runs `config` in `directory` and writes its files. `observer` (may be null) hears of every tap, after the log, and
/// with the errors of the state that it was chosen from, however little the strategy reads.
///
/// A finished run of the same build is left alone and reported. A finished run of another build, a failed or a broken
/// one throws Error with the remedy; with `force` the old directory is moved to <id>.old-N first. When the run itself
/// fails, its summary says so and the Error, of kind `run`, is thrown on.
///
/// `supervisor` (may be null) is asked before every tap; a repeatable backend is then refused by an Error.
RunReport start_run(const Workshop& workshop, const ResolvedConfig& config, const std::filesystem::path& directory,
                    bool force, Journal* observer, Supervisor* supervisor = nullptr);

struct ResumeOptions {
  bool retry_failed = false;  ///< carry on a failed run too
  bool force = false;         ///< carry on what another build began
};

/// Carries on the run in `directory` from its config and its recorded taps; repeats none. A finished run is reported
/// as done. `supervisor` as of start_run().
RunReport resume_run(const Workshop& workshop, const std::filesystem::path& directory, const ResumeOptions& options,
                     Journal* observer, Supervisor* supervisor = nullptr);

/// The same with `config`, that of the run, in a directory that this process holds.
RunReport resume_held(const Workshop& workshop, const ResolvedConfig& config, RunDirectory& held,
                      const ResumeOptions& options, Journal* observer, Supervisor* supervisor = nullptr);

/// Why a run is not to be carried on: it has taps of another build than this one. None if it has not.
std::optional<Error> objection_to_build(const Workshop& workshop, const ResolvedConfig& config,
                                        const RunRecord& record);

/// Makes those files again that an ended run in a directory that this process holds has lost: a kill came between its
/// last line and summary.json, or a power cut took what was never synced. Throws Error.
Restored restore_files(const Workshop& workshop, RunDirectory& held);

/// The config.yaml of a run directory as it stands. Throws Error if there is none, or one of a later format.
Tree read_run_config(const std::filesystem::path& directory);

/// Where the values of a run's config were written when it began: the comments of its config.yaml, by the paths of the
/// values. Empty where there is none that can be read.
std::map<std::string, std::string> recorded_origins(const std::filesystem::path& directory);

/// Returns the name of the group of this `kind` ("scene") whose file has written the first of the values at paths that
/// begin with `path`, by their recorded origins; "" for none. A group is known by name from that alone.
std::string recorded_group(const std::map<std::string, std::string>& origins, const std::string& path,
                           const std::string& kind);

/// The config of a run directory, as resolved then. Throws Error if it does not resolve to the identity that it had.
ResolvedConfig load_run(const PluginHost& host, const std::filesystem::path& directory);

}  // namespace palpate
