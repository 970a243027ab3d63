// SPDX-License-Identifier: MIT
// One function a command. Each prints its result on stdout and returns the exit status; errors are thrown.
#pragma once

#include "config/compose.hpp"
#include "launch/launcher.hpp"
#include "plugin/host.hpp"
#include "record/session.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate::cli {

constexpr int kDone = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kBusy = 75;
constexpr int kInterrupted = 130;

/// What all commands share.
struct Program : Workshop {
  Composer& composer;
};

struct RunArguments {
  std::string config;
  std::vector<std::string> overrides;
  std::string runs = "runs";
  bool json = false;
  bool quiet = false;
  bool dry_run = false;
  bool force = false;
  bool step = false;
  bool print_config = false;
  bool origins = false;
  bool identity = false;
  bool watch = false;
  std::string junit;
};
int run(Program& program, const RunArguments& arguments);

/// How a run is watched, and what is shown of it and of what was expected of it.
struct RunOutput {
  bool table = false;  ///< a line a tap and the result in a few on stdout
  bool json = false;   ///< summary.json on stdout
  std::string junit;   ///< a file, "" for none
  bool step = false;   ///< every tap is asked for
  /// Where its page is served while it goes on, by a process of its own; "" for nowhere.
  std::filesystem::path watched{};
};
/// Has `action` run it, with who shows each tap and who is asked before, shows its report and judges it by the config.
/// Returns the exit status.
using RunAction = std::function<RunReport(Journal* display, Supervisor* step)>;
int conduct_run(const Program& program, const ResolvedConfig& config, const RunOutput& output, const RunAction& action);

/// Who runs the jobs of a sweep, and how.
struct LaunchArguments {
  std::string launcher = kLocal;
  std::optional<int> workers;  ///< jobs at a time, of one task where there are several
  int attempts = 3;            ///< a job is begun at most so often before it stays failed
  bool quiet = false;
  bool watch = false;
  std::string junit;
  // Only for a cluster:
  std::string partition, time, account;
  std::vector<std::string> sbatch;
  std::optional<int> jobs_per_task;
  bool wait = false;
};
/// Throws Error for options that do not go together, and where no JUnit file can be made.
void check_launch(const LaunchArguments& launch);

struct SweepArguments {
  std::string config;
  std::vector<std::string> axes;
  std::string runs = "runs";
  bool list = false;
  LaunchArguments launch;
};
int sweep(Program& program, const SweepArguments& arguments);

struct ResumeArguments {
  std::string directory;
  ResumeOptions options;
  bool step = false;
  std::string jobs;  ///< of a sweep: "0-7,12"; "" for all
  LaunchArguments launch;
};
int resume(Program& program, const ResumeArguments& arguments);

struct WatchArguments {
  std::string directory;
  std::string bind = "127.0.0.1";
  int port = 0;
  bool until_left = false;
};
/// Serves the page of a run or a sweep until a signal ends it.
int watch(Program& program, const WatchArguments& arguments);

struct ListArguments {
  std::string folder = "runs";
  std::optional<std::string> where;
  bool json = false;
};
int list_runs(Program& program, const ListArguments& arguments);

int status(Program& program, const std::string& directory);
int replay(Program& program, const std::string& directory);
/// For commands that read one run: throws Error for the directory of a sweep, saying which of its folders are runs.
void check_one_run(const std::filesystem::path& directory);
int validate(Program& program, const std::vector<std::string>& configs);
int plugins(Program& program, const std::string& what, bool json);
/// Makes the folder `name` with a plugin that builds, and an experiment with it; with `python` a program in its place,
/// of an acquisition.
int new_plugin(Program& program, const std::string& kind, const std::string& name, bool python);
int schema(Program& program);

// What of these is about many runs.
int resume_sweep(Program& program, const ResumeArguments& arguments);
int status_of_sweep(Program& program, const std::string& directory);
/// How many `config` describes. Throws Error where it is not valid.
std::size_t jobs_of_sweep(Program& program, const std::string& config);

struct ParetoArguments {
  std::vector<std::string> records;  ///< sweeps and runs, taken as one sweep: see find_records()
  std::string cost;
  std::string error;
  std::optional<std::string> within;
  std::optional<std::string> where;
};
int pareto(Program& program, const ParetoArguments& arguments);

struct CompareArguments {
  std::vector<std::string> records;  ///< sweeps and runs, taken as one sweep: see find_records()
  std::vector<std::string> by;
  std::vector<std::string> metrics;
  std::optional<std::string> where;
  std::optional<std::string> baseline;
  std::vector<int> at;               ///< numbers of taps; none: as the jobs ended
  std::optional<std::string> until;  ///< or once they were that good
  bool ratio = false;
  std::string format = "text";  ///< of what is printed: text, markdown, csv, json or latex
  std::optional<int> workers;
};
int compare(Program& program, const CompareArguments& arguments);

struct CurvesArguments {
  std::vector<std::string> records;  ///< sweeps and runs, taken as one sweep: see find_records()
  std::vector<std::string> by;       ///< none: all keys that vary but the seed and the scene's
  std::string metric;                ///< "": main_error() of the results
  std::string against = "taps";
  std::optional<std::string> where;
  std::vector<std::string> outputs;  ///< files; none: a picture and a table beside results.csv
  std::optional<int> workers;
  std::optional<std::string> width;  ///< of pictures, with its unit
};
int curves(Program& program, const CurvesArguments& arguments);

struct ReportArguments {
  std::vector<std::string> directories;  ///< one, or runs to be set side by side
  std::string to;                        ///< the folder of what is written; "" for the record's own
  bool figures = false;
  bool paper = false;
};
int report(Program& program, const ReportArguments& arguments);

int explain(Program& program, const std::string& directory, int tap);

int calibrate(Program& program, const std::vector<std::string>& directories);

/// `format`: "ply" or "csv"; `to`: a folder; "" for export/ of the run.
int export_run(Program& program, const std::string& directory, const std::string& format, const std::string& to);

}  // namespace palpate::cli
