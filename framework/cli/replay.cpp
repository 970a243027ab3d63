// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "math/instructions.hpp"
#include "record/record_reader.hpp"
#include "record/recording.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate::cli {

void check_one_run(const std::filesystem::path& directory) {
  if (!is_sweep(directory)) return;
  const std::string jobs = (directory / "jobs").string();
  throw Error(directory.string(), "is a sweep of many runs",
              fmt::format("name one run: {0}/<id>; 'palpate list {0} --where \"seed == 3\"' finds it", jobs));
}

int replay(Program& program, const std::string& directory) {
  constexpr std::size_t kShown = 10;
  check_one_run(directory);
  const ReplayReport report = replay_run(program, directory);
  if (report.truth_lost)
    mention(fmt::format("numbers that need the truth are not compared: {}\n", report.truth_lost->what()));
  if (report.differences.empty()) {
    print_out("{} taps, {} numbers, all equal\n", report.taps, report.numbers);
    return kDone;
  }
  print_out("{} taps, {} numbers, {} differ\n", report.taps, report.numbers, report.differences.size());
  for (std::size_t i = 0; i < report.differences.size() && i < kShown; ++i) {
    const Difference& one = report.differences[i];
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

}  // namespace palpate::cli
