// SPDX-License-Identifier: MIT
#include "cli/command_line.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "math/instructions.hpp"
#include "record/record_reader.hpp"
#include "record/run_directory.hpp"
#include "record/run_replay.hpp"

#include <fmt/format.h>

namespace palpate::cli {

namespace {

struct ReplayArguments {
  std::string directory;
};

int replay(CommandEnvironment& program, const ReplayArguments& arguments) {
  const std::string& directory = arguments.directory;
  constexpr std::size_t kShown = 10;
  check_one_run(directory);
  const ReplayReport report = replay_run(program, read_recorded_run(program.host, directory));
  if (report.truth_lost)
    print_message(fmt::format("numbers that need the truth are not compared: {}\n", report.truth_lost->what()));
  if (report.differences.empty()) {
    print_out("{} taps, {} numbers, all equal\n", report.taps, report.numbers);
    return kDone;
  }
  print_out("{} taps, {} numbers, {} differ\n", report.taps, report.numbers, report.differences.size());
  for (std::size_t i = 0; i < report.differences.size() && i < kShown; ++i) {
    const ReplayDifference& one = report.differences[i];
    print_out("{}: {}: recorded {}, now {}\n", one.tap == 0 ? std::string("summary") : fmt::format("tap {}", one.tap),
              one.field, one.recorded, one.replayed);
  }
  if (report.differences.size() > kShown) print_out("... and {} more\n", report.differences.size() - kShown);
  const std::optional<Tree> manifest = read_manifest(directory);
  const Tree* const recorded = manifest ? manifest->find("instruction_path") : nullptr;
  if (recorded != nullptr && recorded->text != math::name_of(instructions_in_use()))
    print_out("the run began with the instruction set {}, this command uses {}: the last digits may differ\n",
              recorded->text, math::name_of(instructions_in_use()));
  return kFailed;
}

}  // namespace

void add_replay(CommandLine& line) {
  auto [command, arguments] = line.add<ReplayArguments>(
      "replay", "Recompute a run from its recorded taps and compare every number with the record", replay,
      [](NeededParts& needs, const ReplayArguments& given) { needs.record(given.directory); });
  command.record("DIR", arguments.directory, RecordKind::run, "run");
  command.examples({"palpate replay runs/object_i/422cd70eb5f7", "palpate replay runs/first/*"});
}

}  // namespace palpate::cli
