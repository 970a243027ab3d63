// SPDX-License-Identifier: MIT
#include "cli/bundle_results.hpp"

#include "bundle/repeat.hpp"
#include "children/child_process.hpp"
#include "cli/command_line.hpp"
#include "cli/output.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>
#include <sstream>

namespace palpate::cli {

namespace fs = std::filesystem;

namespace {

/// Performs a command in a child process, because commands print on stdout. Returns what it prints. Throws Error.
std::string output_of(const CommandEnvironment& program, const CommandWords& words, const fs::path& scratch) {
  const fs::path file = scratch / "output";
  flush_output();
  const std::unique_ptr<ChildProcess> child = ChildProcess::fork([&](const ChildProcess::Say& say) {
    try {
      // What else the command prints are progress, and names of further files.
      if (std::freopen(file.c_str(), "w", stdout) == nullptr || std::freopen("/dev/null", "w", stderr) == nullptr)
        throw Error(file.string(), "cannot be written");
      std::vector<const char*> arguments{"palpate"};
      for (const std::string& word : words) arguments.push_back(word.c_str());
      CommandLine line(program.installation, false);
      add_commands(line, words.front());
      CommandEnvironment own = program;
      const auto status = line.parse(static_cast<int>(arguments.size()), const_cast<char**>(arguments.data()));
      return finish_output(status ? *status : line.perform(own));
    } catch (const Error& error) {
      say(error.what());
      return kUsage;
    }
  });
  if (!child || !child->wait() || child->status() != 0) {
    throw Error("palpate " + words_text(words), "failed: " + (child ? child->said() : std::string("no process")), {},
                Error::Kind::run);
  }
  return read_file(file);
}

/// Returns the words of a command before its first option: names of records.
CommandWords names_in(const CommandWords& command) {
  const auto option =
      std::find_if(command.begin(), command.end(), [](const std::string& one) { return boost::starts_with(one, "-"); });
  return {command.begin() + 1, option};
}

/// Returns whether a record in the folder "sweeps/NAME/ID" is one of these names.
bool is_named(const std::string& folder, const CommandWords& names) {
  const std::string name = fs::path(folder).parent_path().filename().string();
  return names.empty() || std::count(names.begin(), names.end(), name) > 0;
}

}  // namespace

void check_result_command(const CommandWords& command, const BundledRecords& records) {
  const auto refuse = [](const std::string& reason, const std::string& hint) {
    return Error("command line", "--result: " + reason, hint);
  };
  const std::string kind = command.empty() ? "" : command.front();
  if (kind != "compare" && kind != "pareto" && kind != "curves")
    throw refuse("'" + kind + "' is not compare, pareto or curves",
                 "write for example --result \"compare --by acquisition --metric rmse_m\"");
  // Only these options: a command of a stranger must write no file and read no record outside of the bundle.
  const std::set<std::string> options{"--by",    "--metric",  "--where", "--baseline", "--at",
                                      "--until", "--against", "--cost",  "--error"};
  const std::set<std::string> flags{"--ratio", "--importance"};
  for (std::size_t i = 1 + names_in(command).size(); i < command.size(); ++i) {
    const std::string& word = command[i];
    const std::string option = word.substr(0, word.find('='));
    if (flags.count(word) > 0) continue;
    if (options.count(option) == 0)
      throw refuse("the word '" + word + "' is not an option that a bundle can repeat",
                   fmt::format("known: {}, {}", fmt::join(options, ", "), fmt::join(flags, ", ")));
    if (option == word && ++i == command.size()) throw refuse(word + " has no value", "write one");
  }
  for (const std::string& name : names_in(command)) {
    const auto has_name = [&](const auto& record) { return is_named(record.first, {name}); };
    if (std::none_of(records.begin(), records.end(), has_name))
      throw refuse(fmt::format("no run or sweep of the bundle has the name '{}'", name),
                   "the names are those of the folders in `runs`");
  }
}

std::pair<std::string, std::string> result_of(const CommandEnvironment& program, const CommandWords& command,
                                              const BundledRecords& records, const fs::path& scratch) {
  const CommandWords names = names_in(command);
  CommandWords words{command.front()};
  for (const auto& [folder, directory] : records) {
    if (is_named(folder, names)) words.push_back(directory.string());
  }
  words.insert(words.end(), command.begin() + 1 + static_cast<std::ptrdiff_t>(names.size()), command.end());
  if (command.front() == "pareto") return {"table.txt", output_of(program, words, scratch)};
  const bool is_table = command.front() == "compare";
  const fs::path curves = scratch / "curves.csv";
  words.insert(words.end(), {is_table ? "--format" : "-o", is_table ? "csv" : curves.string()});
  const std::string output = output_of(program, words, scratch);
  return {is_table ? "table.csv" : "curves.csv", is_table ? output : read_file(curves)};
}

std::vector<std::string> compare_outputs(const std::string& recorded, const std::string& now, const std::string& name,
                                         bool exact) {
  std::vector<std::string> out;
  std::istringstream before(recorded);
  std::istringstream after(now);
  for (int number = 1;; ++number) {
    std::string a, b;
    const bool has_a = bool(std::getline(before, a));
    const bool has_b = bool(std::getline(after, b));
    if (!has_a && !has_b) return out;
    if (a == b && has_a == has_b) continue;
    if (exact || has_a != has_b || differ(a, b))
      out.push_back(fmt::format("{}:{}: recorded '{}', now '{}'", name, number, a, b));
  }
}

}  // namespace palpate::cli
