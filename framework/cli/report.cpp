// SPDX-License-Identifier: MIT
#include "cli/report.hpp"

#include "cli/display.hpp"
#include "cli/output.hpp"
#include "record/files.hpp"
#include "report/figures/figures.hpp"
#include "report/page/run_page.hpp"
#include "report/page/runs_page.hpp"
#include "report/page/sweep_page.hpp"
#include "report/words/words.hpp"
#include "sweep/pooled_sweep.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

/// Prints the progress on stderr, at most once per second.
class ProgressMessages {
 public:
  explicit ProgressMessages(const char* what) : what_(what) {}

  void operator()(int done, int all) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::seconds(1)) return;
    last_ = now;
    print_message(fmt::format("report: {} of {} {}\n", done, all, what_));
  }

 private:
  const char* what_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void write_page(const fs::path& file, const std::string& page) {
  write_file(file, page);
  print_out("{}\n", file.string());
}

void show(const Figures& figures) {
  for (const std::string& note : figures.notes) print_message(note + "\n");
  for (const fs::path& picture : figures.pictures) print_out("{}\n", picture.string());
}

/// Throws Error for a run that taps from any side. `what` is the reason in the message.
void check_from_above(const RecordedRun& recording, const std::string& what) {
  if (!recording.is_any_side()) return;
  throw Error(recording.directory.string(), "is a run from any side, but " + what,
              "use 'palpate report' without options for its page");
}

/// Warns on stderr if the true surface can no longer be computed. The page then shows the errors in the record.
void warn_lost(const History& history) {
  if (history.truth_lost) print_message(truth_lost_words(*history.truth_lost) + "\n");
}

void report_run(const RunEnvironment& environment, const ReportArguments& arguments, const fs::path& to) {
  const RecordedRun recording = read_recorded_run(environment.host, arguments.directories.front());
  if (arguments.figures || arguments.paper)
    check_from_above(recording, "--figures and --paper are only for runs from above");
  ProgressMessages progress("taps");
  const History history = make_history(environment, recording, std::ref(progress));
  warn_lost(history);
  write_page(to / "report.html", run_page(recording, history, std::ref(progress)));
  if (arguments.figures) show(write_run_figures(environment, recording, history, to / "figures"));
  if (arguments.paper) show(write_paper_figures(environment, recording, to / "figures"));
}

void report_sweep(const RunEnvironment& environment, const ReportArguments& arguments, const fs::path& to) {
  const Sweep sweep = read_sweep(arguments.directories.front());
  write_page(to / "report.html", sweep_page(sweep, ProgressMessages("jobs")));
  if (arguments.figures) show(write_sweep_figures(sweep, to / "figures"));
  if (arguments.paper) show(write_paper_figures(environment, sweep, to / "figures"));
}

void report_several(const RunEnvironment& environment, const ReportArguments& arguments) {
  const std::vector<std::string>& directories = arguments.directories;
  const auto refuse = [](const std::string& reason, const std::string& hint) {
    throw Error("command line", reason, hint);
  };
  if (directories.size() > kMostRunsOnAPage)
    refuse(fmt::format("{} runs are too many for one page", directories.size()),
           fmt::format("give at most {}, or compare a sweep of them with 'palpate compare'", kMostRunsOnAPage));
  if (arguments.figures || arguments.paper)
    refuse("--figures and --paper draw one run or sweep", "give one, or leave the options out");
  std::vector<ComparedRun> runs;
  std::string name = "side_by_side";
  for (const std::string& directory : directories) {
    if (is_sweep(directory))
      refuse(directory + " is a sweep, but a page of several runs needs single runs", "name its jobs: SWEEP/jobs/ID");
    RecordedRun recording = read_recorded_run(environment.host, directory);
    check_from_above(recording, "pages of several runs are only for runs from above");
    History history = make_history(environment, recording, ProgressMessages("taps"));
    warn_lost(history);
    name += "_" + recording.config.id;
    runs.push_back({std::move(recording), std::move(history)});
  }
  const fs::path to =
      arguments.to.empty() ? common_folder({directories.begin(), directories.end()}) : fs::path(arguments.to);
  write_page(to / (name + ".html"), runs_page(runs, ProgressMessages("taps")));
}

}  // namespace

int report(CommandEnvironment& program, const ReportArguments& arguments) {
  // An interrupt may end this command at once, because no tap is being made and each file is replaced as a whole.
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  if (!arguments.to.empty()) make_folder(arguments.to);
  if (arguments.directories.size() > 1) {
    report_several(program, arguments);
    return kDone;
  }
  const std::string& directory = arguments.directories.front();
  const fs::path to = arguments.to.empty() ? fs::path(directory) : fs::path(arguments.to);
  (is_sweep(directory) ? report_sweep : report_run)(program, arguments, to);
  return kDone;
}

}  // namespace palpate::cli
