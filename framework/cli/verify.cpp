// SPDX-License-Identifier: MIT
#include "cli/verify.hpp"

#include "bundle/repeat.hpp"
#include "cli/bundle_plugins.hpp"
#include "cli/bundle_results.hpp"
#include "cli/display.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "cli/sweep_display.hpp"
#include "config/catch_error.hpp"
#include "record/files.hpp"
#include "report/words/words.hpp"

#include <palpate/error.hpp>
#include <palpate/random.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <sstream>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShown = 20;

/// Returns the numbers of `count` of `runs` runs, ascending. Chance chooses them, so that the author of the bundle
/// cannot.
std::vector<std::size_t> sample_of(std::size_t runs, std::size_t count) {
  std::vector<std::size_t> out(runs);
  std::iota(out.begin(), out.end(), std::size_t{0});
  Random random{std::random_device{}(), "verify"};
  for (std::size_t i = 0; i < std::min(count, runs); ++i) std::swap(out[i], out[i + random.index(runs - i)]);
  out.resize(std::min(count, runs));
  std::sort(out.begin(), out.end());
  return out;
}

/// Results of the runs come from child processes, as files: kind, build, reason, then one line per difference.
void write_check(const fs::path& file, const RunCheck& check) {
  std::string text =
      fmt::format("{}\n{}\n{}\n", static_cast<int>(check.kind), int{check.same_build}, one_line(check.reason));
  for (const std::string& one : check.differences) text += one_line(one) + "\n";
  write_file(file, text);
}

RunCheck read_check(const fs::path& file) {
  RunCheck out;
  std::istringstream lines(read_file(file));
  std::string line;
  std::getline(lines, line);
  out.kind = static_cast<RunCheck::Kind>(std::stoi(line));
  std::getline(lines, line);
  out.same_build = line == "1";
  std::getline(lines, out.reason);
  while (std::getline(lines, line)) out.differences.push_back(line);
  return out;
}

/// The differences that were found so far, and what was not checked.
struct Findings {
  std::vector<std::string> differences;
  std::map<std::string, int> not_repeated;  ///< numbers of runs by reason
  int unchecked = 0;                        ///< number of runs with RunCheck::Kind::unchecked
  bool same_build = true;                   ///< whether this build made all runs that were checked

  void add(const std::string& place, const std::vector<std::string>& lines) {
    for (const std::string& one : lines) differences.push_back(place.empty() ? one : fmt::format("{}: {}", place, one));
  }
};

/// Repeats or replays runs of the bundle, and prints how many. Returns false after an interrupt.
bool check_runs(const CommandEnvironment& program, const VerifyArguments& arguments, const UnpackedBundle& bundle,
                const std::vector<std::string>& runs, Findings& findings) {
  const ScratchFolder scratch;
  const std::vector<std::size_t> chosen =
      sample_of(runs.size(), arguments.sample ? static_cast<std::size_t>(*arguments.sample) : runs.size());
  const auto file_of = [&](std::size_t run) { return scratch.path() / fmt::format("{}.check", run); };
  if (!compute_jobs(program, chosen, arguments.workers, [&](std::size_t run) {
        write_check(file_of(run), check_run(program, bundle, runs[run], scratch.path() / std::to_string(run),
                                            arguments.with_plugins));
      }))
    return false;
  std::map<RunCheck::Kind, int> counts;
  for (const std::size_t run : chosen) {
    const RunCheck check = read_check(file_of(run));
    ++counts[check.kind];
    findings.same_build = findings.same_build && check.same_build;
    if (!check.reason.empty()) ++findings.not_repeated[check.reason];
    findings.add(runs[run], check.differences);
  }
  print_out("runs: {} in the bundle, {} repeated, {} replayed, {} not checked\n", runs.size(),
            counts[RunCheck::Kind::repeated], counts[RunCheck::Kind::replayed], counts[RunCheck::Kind::unchecked]);
  findings.unchecked = counts[RunCheck::Kind::unchecked];
  if (chosen.size() < runs.size()) {
    constexpr double kRisk = 0.05;
    const double share = 1.0 - std::pow(kRisk, 1.0 / static_cast<double>(chosen.size()));
    print_out("sample: if more than {:.2g} % of the runs were changed, it shows one of them with 95 % probability\n",
              100.0 * share);
  }
  return true;
}

/// Makes each result again and compares it.
void check_results(const CommandEnvironment& program, const UnpackedBundle& bundle, const BundleIndex& index,
                   Findings& findings) {
  const ScratchFolder scratch;
  BundledRecords records;
  for (const std::string& one : index.records) records[one] = bundle.folder() / one;
  std::set<std::string> expected;
  std::size_t equal = 0;
  const std::vector<CommandWords>& commands = index.commands;
  for (std::size_t i = 0; i < commands.size() && !program.interrupted->load(); ++i) {
    std::vector<std::string> differences;
    const std::string folder = fmt::format("results/{}/", i + 1);
    const auto trouble = catch_error([&] {
      check_result_command(commands[i], records);
      const auto [file, content] = result_of(program, commands[i], records, scratch.path());
      differences = compare_outputs(bundle.read(folder + file), content, folder + file, findings.same_build);
      if (bundle.read(folder + kCommandFile) != words_text(commands[i]) + "\n")
        differences.push_back(folder + kCommandFile + " is not as 'palpate bundle' writes it");
      expected.insert({folder + file, folder + kCommandFile});
    });
    if (trouble) differences.emplace_back(trouble->what());
    equal += differences.empty() ? 1 : 0;
    findings.add("", differences);
  }
  for (const auto& [name, hash] : bundle.hashes()) {
    if (boost::starts_with(name, "results/") && expected.count(name) == 0)
      findings.add("", {name + " does not belong to the bundle"});
  }
  if (!commands.empty()) print_out("results: {} of {} are equal\n", equal, commands.size());
}

}  // namespace

int verify(CommandEnvironment& program, const VerifyArguments& arguments) {
  listen_for_interrupts();
  const UnpackedBundle bundle(arguments.bundle, bytes_of_gib(arguments.max_size));
  print_out("digest: {}\n", bundle.digest());
  Findings findings;
  findings.differences = bundle.wrong_sums();
  const bool sums_match = findings.differences.empty();
  if (sums_match) {
    print_out("files: {}, all as in SHA256SUMS\n", bundle.hashes().size());
    const BundleIndex index = bundle.read_index();
    const BundlePlugins plugins(program, bundle, arguments.with_plugins);
    const BundleContent content = check_content(bundle, index);
    findings.add("", content.differences);
    if (!check_runs(plugins.program(), arguments, bundle, content.runs, findings)) return kInterrupted;
    check_results(plugins.program(), bundle, index, findings);
    // Another version may write another page.
    if (bundle.hashes().count("README.md") == 0 ||
        (findings.same_build && bundle.read("README.md") != readme_text(index)))
      findings.add("", {"README.md is not as 'palpate bundle' writes it"});
  }
  if (program.interrupted->load()) return kInterrupted;
  for (const auto& [reason, count] : findings.not_repeated)
    print_out("not repeated: {}, because {}\n", counted(count, "run"), reason);
  const std::size_t differences = findings.differences.size();
  for (std::size_t i = 0; i < std::min(kShown, differences); ++i) print_out("{}\n", findings.differences[i]);
  if (differences > kShown) print_out("... and {} more\n", differences - kShown);
  print_out("{}{}\n", differences == 0 ? "no differences" : counted(static_cast<long>(differences), "difference"),
            findings.unchecked == 0 ? "" : ", but some runs were not checked");
  return differences == 0 && findings.unchecked == 0 ? kDone : kFailed;
}

}  // namespace palpate::cli
