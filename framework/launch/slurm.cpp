// SPDX-License-Identifier: MIT
#include "launch/slurm.hpp"

#include "children/child_process.hpp"
#include "config/catch_error.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <memory>
#include <regex>
#include <sstream>

#include <unistd.h>

namespace palpate::slurm {
namespace {

constexpr double kAnswerSeconds = 30.0;  ///< s
constexpr const char* kNoClusterHint = "run this on the login node of a cluster, or leave out '--launcher slurm'";

/// Returns the number that the first group of `pattern` captures in the last match; nullopt if there is no match.
std::optional<int> last_number(const std::string& text, const std::string& pattern) {
  const std::regex wanted(pattern);
  std::optional<int> out;
  for (std::sregex_iterator at(text.begin(), text.end(), wanted), end; at != end; ++at) out = std::stoi((*at)[1]);
  return out;
}

/// Returns the number after `name` and an equals sign.
std::optional<int> setting(const std::string& text, const std::string& name) {
  return last_number(text, name + "[ \t]*=[ \t]*([0-9]{1,9})\\b");
}

/// Runs a program to its end, for at most `patience` seconds, and returns its output.
std::string ask(const std::vector<std::string>& words, const std::string& hint = kNoClusterHint,
                double patience = kAnswerSeconds) {
  ProgramCall program{words};
  // Removes variables by which users change the output or the duration of Slurm's commands.
  static const std::regex users("^(SQUEUE_|SBATCH_WAIT=)");
  const auto is_users = [](const std::string& one) { return std::regex_search(one, users); };
  auto& sees = program.environment;
  sees.erase(std::remove_if(sees.begin(), sees.end(), is_users), sees.end());
  const std::unique_ptr<ChildProcess> command = ChildProcess::start(program);
  if (!command && errno == ENOENT) throw Error(words.front(), "is not installed, or not on PATH", kNoClusterHint);
  if (!command) throw Error(words.front(), fmt::format("cannot be started: {}", std::strerror(errno)), kNoClusterHint);
  if (!command->wait(patience))
    throw Error(words.front(), fmt::format("has not answered for {:.0f} s", patience), hint);
  if (command->status() != 0) throw Error(words.front(), words_of(command->said()), hint);
  return command->said();
}

}  // namespace

int parse_most_tasks(const std::string& config) {
  const std::optional<int> indices = setting(config, "MaxArraySize");
  if (!indices) throw Error("scontrol", "does not print MaxArraySize", "see 'scontrol show config'");
  if (*indices < 2)
    throw Error("scontrol", "this cluster accepts no job arrays", "ask its administrator to raise MaxArraySize");
  return std::clamp(setting(config, "max_array_tasks").value_or(*indices), 1, *indices);
}

std::vector<Task> parse_queue(const std::string& text) {
  std::vector<Task> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    Task task;
    std::string state;
    if (!(cells >> task.array >> state)) continue;
    task.waiting = state == "PD";
    out.push_back(task);
  }
  return out;
}

std::optional<int> parse_array_id(const std::string& output) {
  return last_number("\n" + output + "\n", "\n([0-9]{1,9})(?:;[^\n]*)?(?=\n)");
}

std::string words_of(const std::string& output) {
  std::string out;
  static const std::regex whose("^((sbatch|squeue|scontrol|scancel): )?((error|fatal): )?");
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    line = std::regex_replace(line, whose, "", std::regex_constants::format_first_only);
    if (line.find_first_not_of(" \t") == std::string::npos) continue;
    out += (out.empty() ? "" : "; ") + line;
  }
  return out.empty() ? "failed without a message" : out;
}

void check_installed() { ask({"sbatch", "--version"}); }

int most_tasks() { return parse_most_tasks(ask({"scontrol", "show", "config"})); }

Submission submit(const std::vector<std::string>& words) {
  std::vector<std::string> all{"sbatch", "--test-only"};
  all.insert(all.end(), words.begin(), words.end());
  const char* const hint = "no job of this array was submitted; 'sinfo' lists the partitions";
  const auto doubt = catch_error([&] { ask(all, hint); });
  all[1] = "--parsable";
  // No time limit: after an interruption it would be unknown whether the array was submitted.
  const std::string said = ask(all, hint, std::numeric_limits<double>::infinity());
  const std::optional<int> id = parse_array_id(said);
  if (!id) throw Error("sbatch", words_of(said), hint);
  return {*id, doubt ? doubt->reason() : ""};
}

std::vector<Task> queue() {
  return parse_queue(ask({"squeue", "--noheader", "--array", fmt::format("--user={}", ::geteuid()), "--format=%F %t"}));
}

void cancel(const std::vector<int>& arrays) {
  std::vector<std::string> words{"scancel"};
  for (const int array : arrays) words.push_back(std::to_string(array));
  ask(words, fmt::format("the jobs may still run; repeat the command by hand: {}", fmt::join(words, " ")));
}

}  // namespace palpate::slurm
