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
#include <cmath>
#include <iomanip>
#include <locale>
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

/// Returns the value of --format; "" without it.
std::string format_of(const CommandWords& words) {
  const auto option = std::find(words.begin(), words.end(), "--format");
  return option != words.end() && option + 1 != words.end() ? *(option + 1) : "";
}

bool is_number(const std::string& text, double& value) {
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  return in >> value && in.eof();
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> out;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) out.push_back(cell);
  return out;
}

bool are_equal(const std::string& a, const std::string& b) {
  double first = 0.0;
  double second = 0.0;
  return a == b || (is_number(a, first) && is_number(b, second) &&
                    std::abs(first - second) <= kNumberTolerance * std::max(std::abs(first), std::abs(second)));
}

}  // namespace

CommandWords result_command(const std::string& text) {
  CommandWords out;
  std::istringstream in(text);
  for (std::string word; in >> std::quoted(word);) out.push_back(word);
  if (out.empty() || (out[0] != "compare" && out[0] != "pareto" && out[0] != "curves"))
    throw Error("command line", "--result " + text + ": is not compare, pareto or curves",
                "write for example --result \"compare --by acquisition --metric rmse_m\"");
  if (std::count(out.begin(), out.end(), "-o") > 0)
    throw Error("command line", "--result " + text + ": -o is chosen by the bundle", "leave it out");
  return out;
}

std::map<std::string, std::string> result_files(const CommandEnvironment& program, const CommandWords& command,
                                                const std::vector<fs::path>& records, const fs::path& scratch) {
  CommandWords words = command;
  for (std::size_t i = 0; i < records.size(); ++i)
    words.insert(words.begin() + 1 + static_cast<std::ptrdiff_t>(i), records[i].string());
  if (command[0] == "curves") {
    const fs::path table = scratch / "curves.csv";
    words.insert(words.end(), {"-o", table.string()});
    output_of(program, words, scratch);
    return {{"curves.csv", read_file(table)}};
  }
  const bool is_table = command[0] == "compare" && format_of(command).empty();
  if (is_table) words.insert(words.end(), {"--format", "csv"});
  std::string ending = is_table ? "csv" : format_of(command);
  if (ending.empty() || ending == "text") ending = "txt";
  if (ending == "latex") ending = "tex";
  if (ending == "markdown") ending = "md";
  return {{"table." + ending, output_of(program, words, scratch)}};
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
    if (exact || has_a != has_b || !std::equal(first.begin(), first.end(), second.begin(), second.end(), are_equal))
      out.push_back(fmt::format("{}:{}: recorded '{}', now '{}'", name, number, a, b));
  }
}

}  // namespace palpate::cli
