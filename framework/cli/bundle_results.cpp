// SPDX-License-Identifier: MIT
#include "cli/bundle_results.hpp"

#include "bundle/repeat.hpp"
#include "children/child_process.hpp"
#include "cli/command_line.hpp"
#include "cli/output.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <sstream>

#include <fcntl.h>
#include <unistd.h>

namespace palpate::cli {

namespace fs = std::filesystem;

namespace {

/// Performs a command in a child process, because commands print on stdout. Returns what it prints. Throws Error.
std::string output_of(const CommandEnvironment& program, const CommandWords& words, const fs::path& scratch) {
  const fs::path file = scratch / "output";
  flush_output();
  const std::unique_ptr<ChildProcess> child = ChildProcess::fork([&](const ChildProcess::Say& say) {
    try {
      const int out = ::open(file.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
      if (out < 0 || ::dup2(out, STDOUT_FILENO) < 0) throw Error(file.string(), "cannot be written");
      ::dup2(::open("/dev/null", O_WRONLY | O_CLOEXEC), STDERR_FILENO);  // progress, and names of further files
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

CommandWords more(CommandWords words, const CommandWords& others) {
  words.insert(words.end(), others.begin(), others.end());
  return words;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> out;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) out.push_back(cell);
  return out;
}

}  // namespace

void check_result_command(const CommandWords& command) {
  const std::string name = command.empty() ? "" : command.front();
  if (name != "compare" && name != "pareto" && name != "curves")
    throw Error("command line", "--result: '" + name + "' is not compare, pareto or curves",
                "write for example --result \"compare --by acquisition --metric rmse_m\"");
  for (const char* const option : {"-o", "--format"}) {
    if (std::count(command.begin(), command.end(), option) > 0)
      throw Error("command line", fmt::format("--result: the bundle sets {} itself", option), "leave it out");
  }
}

std::pair<std::string, std::string> result_of(const CommandEnvironment& program, const CommandWords& command,
                                              const std::vector<fs::path>& records, const fs::path& scratch) {
  CommandWords words{command.front()};
  for (const fs::path& record : records) words.push_back(record.string());
  words.insert(words.end(), command.begin() + 1, command.end());
  if (command.front() == "pareto") return {"table.txt", output_of(program, words, scratch)};
  if (command.front() == "compare") return {"table.csv", output_of(program, more(words, {"--format", "csv"}), scratch)};
  const fs::path table = scratch / "curves.csv";
  output_of(program, more(words, {"-o", table.string()}), scratch);
  return {"curves.csv", read_file(table)};
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
    const std::vector<std::string> first = cells_of(a);
    const std::vector<std::string> second = cells_of(b);
    const auto equal = [](const std::string& x, const std::string& y) { return !differ(x, y); };
    if (exact || has_a != has_b || !std::equal(first.begin(), first.end(), second.begin(), second.end(), equal))
      out.push_back(fmt::format("{}:{}: recorded '{}', now '{}'", name, number, a, b));
  }
}

}  // namespace palpate::cli
