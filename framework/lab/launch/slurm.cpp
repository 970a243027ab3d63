// SPDX-License-Identifier: MIT
#include "launch/slurm.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <sstream>

#include <poll.h>
#include <unistd.h>

namespace palpate::slurm {
namespace {

constexpr double kPatience = 30.0;  ///< s for an answer
constexpr std::chrono::seconds kPause{1};

/// A list of more ranges than this becomes a second array: at most 16 bytes each, well below what a command line holds.
constexpr std::size_t kMostRanges = 1000;

constexpr const char* kAskedElsewhere =
    "run this where Slurm's commands work, on a cluster's login node, or leave out '--launcher slurm'";

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) out.push_back(line);
  return out;
}

/// The parts of a line between its '|'.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> out;
  std::istringstream cells(line);
  for (std::string cell; std::getline(cells, cell, '|');) out.push_back(cell);
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
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const std::size_t sign = text.find_first_not_of(" \t", at + name.size());
    if (sign == std::string::npos || text[sign] != '=') continue;
    const std::size_t begin = text.find_first_not_of(" \t", sign + 1);
    if (begin == std::string::npos) continue;
    const std::size_t end = std::min(text.find_first_not_of("0123456789", begin), text.size());
    if (const auto number = whole_number(text.substr(begin, end - begin))) return number;
  }
  return std::nullopt;
}

bool begins_with(std::string_view text, std::string_view with) { return text.substr(0, with.size()) == with; }

/// Settings by which users change what these commands print or how long they stay, behind the back of who reads it.
bool is_seen(std::string_view variable) {
  return !begins_with(variable, "SQUEUE_") && !begins_with(variable, "SINFO_") &&
         !begins_with(variable, "SBATCH_WAIT=");
}

std::unique_ptr<ChildProcess> start(const std::vector<std::string>& words) {
  Program program{words};
  auto& sees = program.environment;
  sees.erase(std::remove_if(sees.begin(), sees.end(), [](const std::string& one) { return !is_seen(one); }),
             sees.end());
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

Limits parse_limits(const std::string& config) {
  const std::optional<int> indices = setting(config, "MaxArraySize");
  if (!indices) throw Error("scontrol", "does not say MaxArraySize", "see 'scontrol show config'");
  if (*indices < 2) throw Error("scontrol", "this cluster takes no arrays", "its MaxArraySize would have to be raised");
  const int tasks = setting(config, "max_array_tasks").value_or(*indices);
  return {*indices, std::clamp(tasks, 1, *indices)};
}

std::vector<Nodes> parse_nodes(const std::string& lines) {
  std::vector<Nodes> out;
  for (const std::string& line : lines_of(lines)) {
    const std::vector<std::string> cells = cells_of(line);
    const std::optional<int> cpus = cells.size() == 2 ? whole_number(cells[1]) : std::nullopt;
    if (!cpus || cells[0].empty()) continue;
    Nodes nodes{cells[0], cells[0].back() == '*', *cpus};
    if (nodes.is_default) nodes.partition.pop_back();
    out.push_back(std::move(nodes));
  }
  return out;
}

std::vector<Task> parse_queue(const std::string& lines) {
  std::vector<Task> out;
  for (const std::string& line : lines_of(lines)) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.size() != 3) continue;
    const std::optional<int> array = whole_number(cells[0]);
    const std::optional<int> index = whole_number(cells[1]);
    if (array && index) out.push_back({*array, *index, cells[2] == "PD"});
  }
  return out;
}

std::optional<int> parse_array_id(const std::string& output) {
  std::optional<int> out;
  for (const std::string& line : lines_of(output)) {
    if (const auto id = whole_number(line.substr(0, line.find(';')))) out = id;
  }
  return out;
}

std::string index_list(const std::vector<int>& indices) {
  std::string out;
  for (std::size_t first = 0; first < indices.size();) {
    std::size_t last = first;
    while (last + 1 < indices.size() && indices[last + 1] == indices[last] + 1) ++last;
    out += fmt::format("{}{}", out.empty() ? "" : ",", indices[first]);
    if (last > first) out += fmt::format("-{}", indices[last]);
    first = last + 1;
  }
  return out;
}

std::vector<Part> split(const std::vector<int>& tasks, const Limits& limits) {
  std::vector<Part> out;
  std::size_t ranges = 0;
  for (const int task : tasks) {
    const int index = task % limits.indices;
    const int offset = task - index;
    const bool fits = !out.empty() && out.back().offset == offset &&
                      out.back().indices.size() < static_cast<std::size_t>(limits.tasks);
    const bool goes_on = fits && out.back().indices.back() + 1 == index;
    if (!goes_on) ++ranges;
    if (!fits || ranges > kMostRanges) {
      out.push_back({offset, {}});
      ranges = 1;
    }
    out.back().indices.push_back(index);
  }
  return out;
}

std::string words_of(const std::string& output) {
  std::string out;
  for (std::string line : lines_of(output)) {
    for (const char* name : {"sbatch", "squeue", "scontrol", "sinfo", "scancel"}) {
      if (begins_with(line, fmt::format("{}: ", name))) line = line.substr(std::string_view(name).size() + 2);
    }
    for (const char* level : {"error: ", "fatal: "}) {
      if (begins_with(line, level)) line = line.substr(std::string_view(level).size());
    }
    if (line.find_first_not_of(" \t") == std::string::npos) continue;
    out += (out.empty() ? "" : "; ") + line;
  }
  return out.empty() ? "failed and says nothing" : out;
}

Limits limits() { return parse_limits(ask({"scontrol", "show", "config"})); }

int most_cpus(const std::string& partition) {
  int most = 0;
  for (const Nodes& nodes : parse_nodes(ask({"sinfo", "--noheader", "--exact", "--format=%P|%c"}))) {
    if (partition.empty() ? nodes.is_default : nodes.partition == partition) most = std::max(most, nodes.cpus);
  }
  return most;
}

int submit(const std::vector<std::string>& words) {
  std::vector<std::string> all{"sbatch", "--parsable"};
  all.insert(all.end(), words.begin(), words.end());
  const std::unique_ptr<ChildProcess> command = start(all);
  command->wait();  // however long it takes: cut off, it could have submitted or not
  const std::optional<int> id = parse_array_id(command->said());
  if (command->status() != 0 || !id) {
    throw Error("sbatch", words_of(command->said()), "nothing of this array was submitted; 'sinfo' lists partitions");
  }
  return *id;
}

void cancel(const std::vector<int>& arrays) {
  std::vector<std::string> words{"scancel"};
  for (const int array : arrays) words.push_back(std::to_string(array));
  ask(words, fmt::format("the jobs may go on; say it again by hand: {}", fmt::join(words, " ")));
}

std::optional<std::vector<Task>> Watch::look(double seconds) {
  const auto now = Clock::now();
  if (!query_ && now < next_) {
    const double pause = std::min(seconds, std::chrono::duration<double>(next_ - now).count());
    ::poll(nullptr, 0, static_cast<int>(1000.0 * pause) + 1);
    return std::nullopt;
  }
  if (!query_) {
    query_ = start({"squeue", "--noheader", "--array", fmt::format("--user={}", ::geteuid()), "--format=%F|%K|%t"});
    next_ = now + kPause;
  }
  ChildProcess::listen({query_.get()}, seconds);
  if (!query_->ended()) {
    if (now < next_ + std::chrono::seconds(static_cast<int>(kPatience))) return std::nullopt;
    trouble_ = fmt::format("has not answered for {:.0f} s", kPatience);
    query_.reset();
    return std::nullopt;
  }
  const std::unique_ptr<ChildProcess> query = std::move(query_);
  if (query->status() != 0) {
    trouble_ = words_of(query->said());
    return std::nullopt;
  }
  trouble_.clear();
  answered_ = Clock::now();
  return parse_queue(query->said());
}

double Watch::silence() const { return std::chrono::duration<double>(Clock::now() - answered_).count(); }

}  // namespace palpate::slurm
