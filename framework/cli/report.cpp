// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "record/files.hpp"
#include "report/figures/figures.hpp"
#include "report/page/run_page.hpp"
#include "report/page/sweep_page.hpp"

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <functional>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

/// Speaks on stderr once a second, so that whoever waits knows for what.
class Patience {
 public:
  explicit Patience(const char* what) : what_(what) {}

  void operator()(int done, int all) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::seconds(1)) return;
    last_ = now;
    mention(fmt::format("report: {} of {} {}\n", done, all, what_));
  }

 private:
  const char* what_;
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void write_page(const fs::path& directory, const std::string& page) {
  const fs::path file = directory / "report.html";
  write_file(file, page);
  fmt::print("{}\n", file.string());
}

void show(const Figures& figures) {
  for (const std::string& note : figures.notes) mention(note + "\n");
  for (const fs::path& picture : figures.pictures) fmt::print("{}\n", picture.string());
}

void report_run(const Workshop& workshop, const ReportArguments& arguments) {
  const Recording recording = read_recording(workshop, arguments.directory);
  Patience patience("taps");
  const History history = make_history(workshop, recording, std::ref(patience));
  write_page(recording.directory, run_page(recording, history, std::ref(patience)));
  if (arguments.figures) show(write_run_figures(workshop, recording, history));
  if (arguments.paper) show(write_paper_figures(workshop, recording));
}

void report_sweep(const Workshop& workshop, const ReportArguments& arguments) {
  const Sweep sweep = read_sweep(arguments.directory);
  write_page(sweep.directory, sweep_page(sweep, Patience("jobs")));
  if (arguments.figures) show(write_sweep_figures(sweep));
  if (arguments.paper) show(write_paper_figures(workshop, sweep));
}

}  // namespace

int report(Program& program, const ReportArguments& arguments) {
  // Here is no tap to be ended first, and files appear whole: what interrupts may do so at once.
  for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, SIG_DFL);
  (is_sweep(arguments.directory) ? report_sweep : report_run)(program, arguments);
  return kDone;
}

}  // namespace palpate::cli
