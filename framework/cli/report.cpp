// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "record/files.hpp"
#include "report/run_page.hpp"

#include <fmt/format.h>

#include <chrono>

namespace palpate::cli {
namespace {

/// Speaks on stderr once a second, so that whoever waits knows for what.
class Patience {
 public:
  void operator()(int done, int all) {
    const auto now = std::chrono::steady_clock::now();
    if (now - last_ < std::chrono::seconds(1)) return;
    last_ = now;
    mention(fmt::format("report: {} of {} taps\n", done, all));
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

int report(Program& program, const ReportArguments& arguments) {
  const Recording recording = read_recording(program.workshop, arguments.directory);
  const History history = make_history(program.workshop, recording, Patience());
  const std::filesystem::path file = recording.directory / "report.html";
  write_file(file, run_page(recording, history));
  fmt::print("{}\n", file.string());
  return kDone;
}

}  // namespace palpate::cli
