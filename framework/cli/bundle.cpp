// SPDX-License-Identifier: MIT
#include "cli/bundle.hpp"

#include "analysis/compare_plan.hpp"
#include "bundle/bundle.hpp"
#include "cli/bundle_results.hpp"
#include "cli/display.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "record/catalogue.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/predicate.hpp>

#include <cstdlib>
#include <set>
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

/// Returns a line for each file that contains a path of this user.
std::vector<std::string> paths_in(const ArchivedFiles& files) {
  const char* const home = std::getenv("HOME");
  std::vector<std::string> out;
  for (const auto& [name, content] : files) {
    for (const std::string& path : {std::string(home != nullptr ? home : ""), fs::current_path().string()}) {
      if (path.size() > 1 && content.find(path + "/") != std::string::npos)
        out.push_back(fmt::format("{} contains the path {}", name, path));
    }
  }
  return out;
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
  if (is_there(output)) throw Error(output.string(), "exists already", "remove it, or choose another name with -o");
  listen_for_interrupts();
  BundleCollector collector(program, {arguments.sources.begin(), arguments.sources.end()});
  std::set<std::string> folders;
  for (const fs::path& one : found) folders.insert(collector.add(one));
  // The results come from the records as they are in the bundle, so that 'palpate verify' finds the same.
  const ScratchFolder scratch;
  BundledRecords records;
  for (const std::string& one : folders) records[one] = scratch.path() / one;
  for (const CommandWords& one : commands) check_result_command(one, records);
  if (commands.empty()) print_message("note: the bundle has no result; --result adds one\n");
  for (const auto& [file, content] : collector.files()) {
    if (commands.empty()) break;
    fs::create_directories((scratch.path() / file).parent_path());
    write_file(scratch.path() / file, content);
  }
  for (std::size_t i = 0; i < commands.size(); ++i) {
    auto [file, content] = result_of(program, commands[i], records, scratch.path());
    const std::string folder = fmt::format("results/{}/", i + 1);
    collector.add_file(folder + file, std::move(content));
    collector.add_file(folder + kCommandFile, words_text(commands[i]) + "\n");
  }
  const ArchivedFiles files = collector.finish();
  if (program.interrupted->load()) return kInterrupted;
  for (const std::string& one : paths_in(files)) print_message("note: " + one + "\n");
  write_archive(output, name, files);
  print_out("{}: {} files\ndigest: {}\n", output.string(), files.size(), sha256_of(files.at(kSumsFile)));
  return kDone;
}

}  // namespace palpate::cli
