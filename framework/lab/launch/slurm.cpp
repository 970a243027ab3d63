// SPDX-License-Identifier: MIT
#include "launch/slurm.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <regex>
#include <sstream>

#include <poll.h>
#include <unistd.h>

namespace palpate::slurm {
namespace {

constexpr double kPatience = 30.0;  ///< s for an answer
constexpr std::chrono::seconds kPause{1};

constexpr const char* kAskedElsewhere = "run this on the login node of a cluster, or leave out '--launcher slurm'";

/// Lines, or the parts of a line between its '|'.
std::vector<std::string> parts_of(const std::string& text, char end = '\n') {
  std::vector<std::string> out;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, end);) out.push_back(part);
  return out;
}

/// All of `text` as a number from 0.
std::optional<int> whole_number(const std::string& text) {
  int out = 0;
  const char* const end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, out);
  if (read.ec != std::errc() || read.ptr != end || out < 0) return std::nullopt;
  return out;
}

/// The number behind `name` and an equals sign, blanks around it or not; none where there is no such thing.
std::optional<int> setting(const std::string& text, const std::string& name) {
  std::smatch found;
  if (!std::regex_search(text, found, std::regex(name + "[ \t]*=[ \t]*([0-9]+)"))) return std::nullopt;
  return whole_number(found[1]);
}

std::unique_ptr<ChildProcess> start(const std::vector<std::string>& words) {
  Program program{words};
  // By these users change what the commands print or how long they stay, behind the back of who reads it.
  static const std::regex users("^(SQUEUE_|SINFO_|SBATCH_WAIT=)");
  const auto is_users = [](const std::string& one) { return std::regex_search(one, users); };
  auto& sees = program.environment;
  sees.erase(std::remove_if(sees.begin(), sees.end(), is_users), sees.end());
  std::unique_ptr<ChildProcess> out = ChildProcess::start(program);
  if (out) return out;
  if (errno == ENOENT) throw Error(words.front(), "is not installed, or not on PATH", kAskedElsewhere);
  throw Error(words.front(), fmt::format("cannot be started: {}", std::strerror(errno)), kAskedElsewhere);
}

/// Runs a program to its end that may be cut off.
std::string ask(const std::vector<std::string>& words, const std::string& hint = kAskedElsewhere) {
  const std::unique_ptr<ChildProcess> command = start(words);
  if (!command->wait(kPatience))
    throw Error(words.front(), fmt::format("has not answered for {:.0f} s", kPatience), hint);
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

int parse_most_cpus(const std::string& lines, const std::string& partition) {
  int most = 0;
  for (const std::string& line : parts_of(lines)) {
    const std::vector<std::string> cells = parts_of(line, '|');
    if (cells.size() != 2) continue;
    const bool is_default = !cells[0].empty() && cells[0].back() == '*';
    const std::string name = is_default ? cells[0].substr(0, cells[0].size() - 1) : cells[0];
    if (partition.empty() ? is_default : name == partition) most = std::max(most, whole_number(cells[1]).value_or(0));
  }
  return most;
}

std::vector<Task> parse_queue(const std::string& lines) {
  std::vector<Task> out;
  for (const std::string& line : parts_of(lines)) {
    const std::vector<std::string> cells = parts_of(line, '|');
    if (cells.size() != 3) continue;
    const std::optional<int> array = whole_number(cells[0]);
    const std::optional<int> index = whole_number(cells[1]);
    if (array && index) out.push_back({*array, *index, cells[2] == "PD"});
  }
  return out;
}

std::optional<int> parse_array_id(const std::string& output) {
  std::optional<int> out;
  for (const std::string& line : parts_of(output)) {
    if (const auto id = whole_number(line.substr(0, line.find(';')))) out = id;
  }
  return out;
}

std::string words_of(const std::string& output) {
  std::string out;
  static const std::regex whose("^((sbatch|squeue|scontrol|sinfo|scancel): )?((error|fatal): )?");
  for (const std::string& said : parts_of(output)) {
    const std::string line = std::regex_replace(said, whose, "", std::regex_constants::format_first_only);
    if (line.find_first_not_of(" \t") == std::string::npos) continue;
    out += (out.empty() ? "" : "; ") + line;
  }
  return out.empty() ? "failed without a message" : out;
}

void check_installed() { ask({"sbatch", "--version"}); }

int most_tasks() { return parse_most_tasks(ask({"scontrol", "show", "config"})); }

int most_cpus(const std::string& partition) {
  return parse_most_cpus(ask({"sinfo", "--noheader", "--exact", "--format=%P|%c"}), partition);
}

int submit(const std::vector<std::string>& words) {
  std::vector<std::string> all{"sbatch", "--parsable"};
  all.insert(all.end(), words.begin(), words.end());
  const std::unique_ptr<ChildProcess> command = start(all);
  command->wait();  // however long it takes: cut off, it could have submitted or not
  const std::optional<int> id = parse_array_id(command->said());
  if (command->status() != 0 || !id) {
    throw Error("sbatch", words_of(command->said()),
                "no job of this array was submitted; 'sinfo' lists the partitions");
  }
  return *id;
}

void cancel(const std::vector<int>& arrays) {
  std::vector<std::string> words{"scancel"};
  for (const int array : arrays) words.push_back(std::to_string(array));
  ask(words, fmt::format("the jobs may still run; repeat the command by hand: {}", fmt::join(words, " ")));
}

std::optional<std::vector<Task>> Watch::look(double seconds) {
  if (!query_) {
    const double pause = std::chrono::duration<double>(next_ - Clock::now()).count();
    if (pause > 0.0) {
      ::poll(nullptr, 0, static_cast<int>(1000.0 * std::min(seconds, pause)) + 1);
      return std::nullopt;
    }
    query_ = start({"squeue", "--noheader", "--array", fmt::format("--user={}", ::geteuid()), "--format=%F|%K|%t"});
    next_ = Clock::now() + kPause;
  }
  ChildProcess::listen({query_.get()}, seconds);
  const bool late = Clock::now() >= next_ + std::chrono::seconds(static_cast<int>(kPatience));
  if (!query_->ended() && !late) return std::nullopt;
  const std::unique_ptr<ChildProcess> query = std::move(query_);
  trouble_.clear();
  if (!query->ended()) trouble_ = fmt::format("has not answered for {:.0f} s", kPatience);
  if (query->ended() && query->status() != 0) trouble_ = words_of(query->said());
  if (!trouble_.empty()) return std::nullopt;
  answered_ = Clock::now();
  return parse_queue(query->said());
}

double Watch::silence() const { return std::chrono::duration<double>(Clock::now() - answered_).count(); }

}  // namespace palpate::slurm
