// SPDX-License-Identifier: MIT
#include "launch/slurm_launcher.hpp"

#include "launch/job.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/replace.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <set>
#include <sstream>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kScript = "task.sh";
constexpr const char* kJobs = "jobs";
constexpr double kMostSilence = 600.0;  ///< s

/// What palpate says to sbatch, and how a user has a say in it.
struct OwnWord {
  const char* name;
  const char* letter;
  const char* hint;
};
constexpr const char* kOwnOption = "use palpate's own option of this name";
constexpr std::array<OwnWord, 10> kOwnWords{{{"--partition", "-p", kOwnOption},
                                             {"--time", "-t", kOwnOption},
                                             {"--account", "-A", kOwnOption},
                                             {"--wait", "-W", kOwnOption},
                                             {"--cpus-per-task", "-c", "set the cores per task with -j"},
                                             {"--array", "-a", "palpate itself chooses the missing jobs"},
                                             {"--output", "-o", "palpate writes the logs into the sweep's directory"},
                                             {"--clusters", "-M", "submit on the login node of that cluster"},
                                             {"--wrap", "--wrap", "palpate itself sets the command of a task"},
                                             {"--parsable", "--parsable", "leave it out"}}};

/// Every folder of the search path absolute: a task may begin elsewhere.
std::optional<std::string> own_plugin_path() {
  const char* value = std::getenv("PALPATE_PLUGIN_PATH");
  if (value == nullptr) return std::nullopt;
  std::string out;
  std::istringstream folders(value);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (!folder.empty()) out += (out.empty() ? "" : ":") + fs::absolute(folder).string();
  }
  return out;
}

}  // namespace

std::string shell_word(const std::string& text) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./,:=@+%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  return "'" + boost::replace_all_copy(text, "'", "'\\''") + "'";
}

void check_sbatch_words(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (word.size() < 2 || word.front() != '-' || word == "--") {
      throw Error("command line", fmt::format("--sbatch: '{}' is not an option of sbatch", word),
                  "write for example --sbatch=--mem=4G");
    }
    const bool is_long = word.compare(0, 2, "--") == 0;
    const std::string name = is_long ? word.substr(0, word.find('=')) : word.substr(0, 2);
    for (const OwnWord& own : kOwnWords) {
      if (name != own.name && name != own.letter) continue;
      throw Error("command line", fmt::format("--sbatch: {} cannot be set with --sbatch", name), own.hint);
    }
  }
}

std::string task_script(const fs::path& program, const fs::path& directory, const fs::path& jobs,
                        const LaunchOptions& options, const std::optional<std::string>& plugin_path) {
  std::string out =
      "#!/bin/sh\n# A task of a Slurm array resumes the jobs of the sweep that one line of a list names. The line "
      "number is the first\n# argument, 0 if absent, plus the array index. Jobs that are done or held by another "
      "process are skipped.\n";
  out += plugin_path ? fmt::format("export PALPATE_PLUGIN_PATH={}\n", shell_word(*plugin_path))
                     : "unset PALPATE_PLUGIN_PATH\n";
  const char* const instructions = std::getenv("PALPATE_INSTRUCTIONS");
  out += instructions != nullptr ? fmt::format("export PALPATE_INSTRUCTIONS={}\n", shell_word(instructions))
                                 : "unset PALPATE_INSTRUCTIONS\n";
  out += fmt::format("jobs=$(sed -n \"$((${{1:-0}} + SLURM_ARRAY_TASK_ID + 1))p\" {})\n", shell_word(jobs.string()));
  out +=
      fmt::format("exec {} resume {} --jobs \"${{jobs:?there is no such task}}\" -j {} --attempts {} --quiet{}{}\n",
                  shell_word(program.string()), shell_word(directory.string()), options.workers, options.most_attempts,
                  options.resume.retry_failed ? " --retry-failed" : "", options.resume.force ? " --force" : "");
  return out;
}

std::unique_ptr<Launcher> slurm_launcher(const LaunchOrder& order) {
  return std::make_unique<SlurmLauncher>(order.workshop.installation.program, order.sweep, order.options,
                                         order.submitted);
}

void SlurmLauncher::check_cores() const {
  const char* elsewhere = std::getenv("SBATCH_PARTITION");
  const std::string partition =
      !options_.partition.empty() || elsewhere == nullptr ? options_.partition : std::string(elsewhere);
  const int most = slurm::most_cpus(partition);
  if (most == 0 || options_.workers <= most) return;
  throw Error("command line",
              fmt::format("-j {}: no node of {} has more than {} CPUs, so the task would never start", options_.workers,
                          partition.empty() ? "the default partition" : "partition " + partition, most),
              fmt::format("give at most -j {}, or another --partition", most));
}

fs::path SlurmLauncher::make_folder() const {
  const fs::path all = directory_ / "slurm";
  if (all.string().find_first_of("\\\n") != std::string::npos) {
    throw Error(all.string(), "Slurm cannot write logs below a folder with a backslash or a line end in its name",
                "rename it");
  }
  make_inner_folder(all);
  std::error_code trouble;
  // Another submission may be looking for its number, too: who makes the folder has it.
  for (int number = 1; !trouble; ++number) {
    fs::path folder = all / std::to_string(number);
    if (fs::create_directory(folder, trouble)) return folder;
  }
  throw Error(all.string(), "cannot be made: " + trouble.message());
}

std::vector<std::string> SlurmLauncher::words_for(std::size_t first, std::size_t count, const fs::path& folder) const {
  // Behind the user's words, so that one of those without its value takes nothing away unnoticed.
  std::vector<std::string> words = options_.more;
  words.push_back(fmt::format("--array=0-{}{}", count - 1, options_.one_at_a_time ? "%1" : ""));
  words.push_back(fmt::format("--job-name={}", directory_.parent_path().filename().string()));
  // A percent sign begins what Slurm fills in.
  words.push_back(fmt::format("--output={}/%A_%a.log", boost::replace_all_copy(folder.string(), "%", "%%")));
  words.push_back(fmt::format("--cpus-per-task={}", options_.workers));
  if (!options_.partition.empty()) words.push_back("--partition=" + options_.partition);
  if (!options_.time.empty()) words.push_back("--time=" + options_.time);
  if (!options_.account.empty()) words.push_back("--account=" + options_.account);
  // The limit is each array's own: one begins when the other has ended.
  if (options_.one_at_a_time && !arrays_.empty())
    words.push_back(fmt::format("--dependency=afterany:{}", arrays_.back()));
  words.push_back((folder / kScript).string());
  words.push_back(std::to_string(first));
  return words;
}

void SlurmLauncher::submit(const std::vector<std::size_t>& jobs) {
  if (jobs.empty()) return;
  const auto most = static_cast<std::size_t>(slurm::most_tasks());
  check_cores();
  const fs::path folder = make_folder();
  std::vector<std::vector<std::size_t>> tasks;
  for (const std::size_t job : jobs) {
    if (tasks.empty() || tasks.back().size() == static_cast<std::size_t>(options_.jobs_per_task)) tasks.emplace_back();
    tasks.back().push_back(job);
  }
  // Between the first and the last of a task lie only such as it leaves alone.
  std::string list;
  for (const auto& task : tasks) list += fmt::format("{}-{}\n", task.front(), task.back());
  write_file(folder / kJobs, list);
  write_file(folder / kScript, task_script(program_, directory_, folder / kJobs, options_, own_plugin_path()));
  for (std::size_t first = 0; first < tasks.size(); first += most) {
    const std::size_t count = std::min(most, tasks.size() - first);
    TaskArray array{slurm::submit(words_for(first, count, folder)), static_cast<int>(count), 0, folder};
    arrays_.push_back(array.id);
    for (std::size_t index = 0; index < count; ++index) {
      std::vector<std::size_t>& own = tasks[first + index];
      array.jobs += static_cast<int>(own.size());
      tasks_[{array.id, static_cast<int>(index)}] = {std::move(own), true};
    }
    submitted_(array);
  }
}

Launcher::State SlurmLauncher::poll(double seconds) {
  State state;
  const std::optional<std::vector<slurm::Task>> queue = tasks_.empty() ? std::nullopt : watch_.look(seconds);
  if (watch_.silence() > kMostSilence) {
    throw Error("squeue", fmt::format("has not answered for ten minutes: {}", watch_.trouble()),
                "the jobs continue; follow them with 'palpate status'", Error::Kind::run);
  }
  if (queue) {
    std::map<Place, bool> present;
    for (const slurm::Task& task : *queue) present[{task.array, task.index}] = task.waiting;
    for (auto at = tasks_.begin(); at != tasks_.end();) {
      TaskState& task = at->second;
      const auto found = present.find(at->first);
      const bool gone = found == present.end();
      task.waiting = !gone && found->second;
      // A failed job that is tried again has its old result until it begins: only the queue tells.
      const bool by_queue = task.waiting || options_.resume.retry_failed;
      const auto still = std::stable_partition(task.jobs.begin(), task.jobs.end(), [&](std::size_t job) {
        return !gone && (by_queue || !has_ended(job_directory(sweep_, sweep_.jobs[job])));
      });
      state.returned.insert(state.returned.end(), still, task.jobs.end());
      task.jobs.erase(still, task.jobs.end());
      at = gone || task.jobs.empty() ? tasks_.erase(at) : std::next(at);
    }
  }
  for (const auto& [place, task] : tasks_) {
    const int jobs = static_cast<int>(task.jobs.size());
    const int running = task.waiting ? 0 : std::min(jobs, options_.workers);
    state.running += running;
    state.waiting += jobs - running;
  }
  return state;
}

void SlurmLauncher::cancel() {
  std::set<int> arrays;
  for (const auto& [place, task] : tasks_) arrays.insert(place.first);
  if (!arrays.empty()) slurm::cancel({arrays.begin(), arrays.end()});
}

std::string SlurmLauncher::stop_command() const { return fmt::format("scancel {}", fmt::join(arrays_, " ")); }

}  // namespace palpate
