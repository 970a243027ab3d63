// SPDX-License-Identifier: MIT
#include "cli/bundle.hpp"

#include "analysis/compare_plan.hpp"
#include "bundle/bundle.hpp"
#include "cli/bundle_results.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "record/catalogue.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <boost/algorithm/string/predicate.hpp>
#include <string>
#include <vector>

namespace palpate::cli {

namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".palpate.tar.gz";

/// Returns the name of a bundle: that of the file, or of the first record.
std::string name_of(const std::string& output, const fs::path& record) {
  if (output.empty()) return record.parent_path().filename().string();
  const std::string name = fs::path(output).filename().string();
  if (!boost::ends_with(name, kEnding) || name == kEnding)
    throw Error("command line", "-o " + output + ": is not the name of a bundle",
                fmt::format("write a name that ends in {}", kEnding));
  return name.substr(0, name.size() - std::string(kEnding).size());
}

}  // namespace

int bundle(CommandEnvironment& program, const BundleArguments& arguments) {
  std::vector<CommandWords> commands;
  for (const std::string& one : arguments.results) commands.push_back(words_of(one));
  const std::vector<fs::path> found = find_records(arguments.records);
  if (commands.empty() && recorded_plan(found)) commands.push_back({"compare"});
  const std::string name = name_of(arguments.output, fs::absolute(found.front()).lexically_normal());
  check_archived_name(name, arguments.output.empty() ? found.front().string() : arguments.output);
  const fs::path output = arguments.output.empty() ? name + kEnding : arguments.output;
  BundleCollector collector(program, {arguments.sources.begin(), arguments.sources.end()});
  BundledRecords records;
  for (const fs::path& one : found) records[collector.add(one)] = one;
  for (const CommandWords& one : commands) check_result_command(one, records);
  const ScratchFolder scratch;
  for (std::size_t i = 0; i < commands.size(); ++i) {
    auto [file, content] = result_of(program, commands[i], records, scratch.path());
    const std::string folder = fmt::format("results/{}/", i + 1);
    collector.add_file(folder + file, std::move(content));
    collector.add_file(folder + kCommandFile, words_text(commands[i]) + "\n");
  }
  const ArchivedFiles files = collector.finish();
  write_archive(output, name, files);
  print_out("{}: {} files\ndigest: {}\n", output.string(), files.size(), sha256_of(files.at(kSumsFile)));
  return kDone;
}

}  // namespace palpate::cli
