// SPDX-License-Identifier: MIT
#include "launch/slurm_launcher.hpp"

#include "config/catch_error.hpp"
#include "launch/job.hpp"
#include "launch/slurm.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/algorithm/string/replace.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <set>
#include <utility>

#include <poll.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kScript = "task.sh";
constexpr const char* kJobs = "jobs";
constexpr const char* kNext = "next.sh";
constexpr std::chrono::minutes kMostSilence{10};
constexpr std::chrono::seconds kPause{1};  ///< shortest time between two queries of the queue
constexpr std::chrono::seconds kMostPause{60};

/// An option of sbatch that palpate sets, and the hint for users who set it.
struct ReservedOption {
  const char* name;
  const char* letter;
  const char* hint;
};
constexpr const char* kOwnOption = "use palpate's own option of this name";
constexpr std::array<ReservedOption, 10> kReservedOptions{
    {{"--partition", "-p", kOwnOption},
     {"--time", "-t", "use palpate's own option --task-time"},
     {"--account", "-A", kOwnOption},
     {"--wait", "-W", kOwnOption},
     {"--cpus-per-task", "-c", "set the cores per task with -j"},
     {"--array", "-a", "palpate itself chooses the missing jobs"},
     {"--output", "-o", "palpate writes the logs into the sweep's directory"},
     {"--clusters", "-M", "submit on the login node of that cluster"},
     {"--wrap", "--wrap", "palpate itself sets the command of a task"},
     {"--parsable", "--parsable", "leave it out"}}};

/// Returns the lines that give a script the folder and the environment of this process.
std::string script_head() {
  std::string out = fmt::format("cd {}\n", shell_word(fs::current_path().string()));  // for relative paths of plugins
  for (const char* name : {"PALPATE_PLUGIN_PATH", "PALPATE_INSTRUCTIONS"}) {
    const char* const value = std::getenv(name);
    out += value != nullptr ? fmt::format("export {}={}\n", name, shell_word(value)) : fmt::format("unset {}\n", name);
  }
  return out;
}

/// Returns a script that executes `palpate` with these words.
std::string command_script(const fs::path& program, const std::vector<std::string>& words, std::size_t ended_jobs) {
  std::string out = "#!/bin/sh\n# Decides the next round of a race and submits its jobs.\n" + script_head() +
                    fmt::format("export {}={}\nexec {}", kEndedJobs, ended_jobs, shell_word(program.string()));
  for (const std::string& word : words) out += " " + shell_word(word);
  return out + "\n";
}

class SlurmLauncher final : public Launcher {
 public:
  /// The nodes must share the file system of the program and the sweep. Submitted tasks outlive this object.
  explicit SlurmLauncher(LauncherSetup order) : order_(std::move(order)) {}

  /// Writes the script and the list of jobs per task into slurm/N in the sweep's directory, and submits them. Slurm
  /// writes the logs there. Throws Error if Slurm does not answer or rejects an array. Arrays that were already passed
  /// to LauncherSetup::submitted then remain in the queue.
  void submit(const std::vector<std::size_t>& jobs) override {
    if (jobs.empty()) return;
    const auto most = static_cast<std::size_t>(slurm::most_tasks());
    folder_ = make_folder();
    const fs::path& folder = folder_;
    const auto each = static_cast<std::size_t>(order_.options.jobs_per_task);
    const std::size_t tasks = (jobs.size() + each - 1) / each;
    const auto begin_of = [&](std::size_t task) { return std::min(task * each, jobs.size()); };
    // A line names the range from the first to the last job of a task. Other jobs within this range are done, so the
    // task skips them.
    std::string list;
    for (std::size_t task = 0; task < tasks; ++task)
      list += fmt::format("{}-{}\n", jobs[begin_of(task)], jobs[begin_of(task + 1) - 1]);
    write_file(folder / kJobs, list);
    write_file(folder / kScript,
               task_script(order_.environment.installation.program, directory_, folder / kJobs, order_.options));
    for (std::size_t first = 0; first < tasks; first += most) {
      const std::size_t count = std::min(most, tasks - first);
      const auto own = static_cast<std::ptrdiff_t>(begin_of(first));
      const auto end = static_cast<std::ptrdiff_t>(begin_of(first + count));
      const slurm::Submission made = slurm::submit(words_for(first, count, folder));
      arrays_.push_back(made.array);
      queued_.insert(arrays_.back());
      open_.insert(open_.end(), jobs.begin() + own, jobs.begin() + end);
      order_.submitted({arrays_.back(), static_cast<int>(count), static_cast<int>(end - own), folder, made.doubt});
    }
  }

  /// Returns jobs whose records have an end. If the queue contains no more tasks of the submitted arrays, returns all
  /// remaining jobs. Throws Error if Slurm has not answered for ten minutes.
  PollResult poll(double seconds) override {
    PollResult state;
    if (open_.empty()) return state;
    const double pause = std::chrono::duration<double>(next_ - Clock::now()).count();
    if (pause > 0.0) {
      ::poll(nullptr, 0, static_cast<int>(1000.0 * std::min(seconds, pause)) + 1);  // returns early after a signal
    } else {
      look(state.returned);
    }
    const int jobs = static_cast<int>(open_.size());
    state.running = std::min(jobs, running_ * order_.options.workers);
    state.waiting = jobs - state.running;
    return state;
  }

  void cancel() override {
    if (!open_.empty() && !queued_.empty()) slurm::cancel({queued_.begin(), queued_.end()});
  }

  void continue_with(const std::vector<std::string>& words) override {
    if (arrays_.empty()) return;
    write_file(folder_ / kNext,
               command_script(order_.environment.installation.program, words, order_.sweep.jobs.size() - open_.size()));
    std::vector<std::string> options =
        cluster_words(folder_, fmt::format("--dependency=afterany:{}", fmt::join(arrays_, ":")));
    options.push_back((folder_ / kNext).string());
    arrays_.push_back(slurm::submit(options).array);
  }

  std::string stop_command() const override {
    return order_.sweep.rounds.empty() ? fmt::format("scancel {}", fmt::join(arrays_, " "))
                                       : "scancel --name=" + shell_word(job_name());
  }

 private:
  using Clock = std::chrono::steady_clock;

  fs::path make_folder() const {
    const fs::path all = directory_ / "slurm";
    if (all.string().find_first_of("\\\n") != std::string::npos)
      throw Error(all.string(), "Slurm cannot write logs below a folder with a backslash or a line end in its name",
                  "rename it");
    make_inner_folder(all);
    std::error_code trouble;
    // Another process may try the same number at the same time. Only the process that creates the folder gets the
    // number.
    for (int number = 1; !trouble; ++number) {
      fs::path folder = all / std::to_string(number);
      if (fs::create_directory(folder, trouble)) return folder;
    }
    throw Error(all.string(), "cannot be made: " + trouble.message());
  }

  /// Returns the arguments of sbatch for an array of `count` tasks, from task `first` on.
  std::vector<std::string> words_for(std::size_t first, std::size_t count, const fs::path& folder) const {
    const bool one_at_a_time = order_.options.one_at_a_time;
    std::vector<std::string> words =
        cluster_words(folder, fmt::format("--array=0-{}{}", count - 1, one_at_a_time ? "%1" : ""));
    words.push_back(fmt::format("--cpus-per-task={}", order_.options.workers));
    // The limit %1 holds within one array only, so each array waits for the end of the previous array.
    if (one_at_a_time && !arrays_.empty()) words.push_back(fmt::format("--dependency=afterany:{}", arrays_.back()));
    words.push_back((folder / kScript).string());
    words.push_back(std::to_string(first));
    return words;
  }

  /// Returns the name of the sweep. The jobs of a race, which submit further jobs, have a name of their own.
  std::string job_name() const {
    const std::string name = directory_.parent_path().filename().string();
    return order_.sweep.rounds.empty() ? name : name + "_" + directory_.filename().string();
  }

  /// Returns the arguments of sbatch that all submissions share, and `own` behind those of the user. If a user forgets
  /// the value of an option, it takes `own` as its value, and the submission or all of its tasks fail at once.
  std::vector<std::string> cluster_words(const fs::path& folder, const std::string& own) const {
    const ClusterOptions& cluster = order_.options.cluster;
    std::vector<std::string> words;
    if (!cluster.partition.empty()) words.push_back("--partition=" + cluster.partition);
    if (!cluster.time.empty()) words.push_back("--time=" + cluster.time);
    if (!cluster.account.empty()) words.push_back("--account=" + cluster.account);
    words.insert(words.end(), cluster.words.begin(), cluster.words.end());
    words.push_back(own);
    words.push_back("--job-name=" + job_name());
    // Slurm replaces %A and %a in a file name; %% is a percent sign.
    words.push_back(fmt::format("--output={}/%A_%a.log", boost::replace_all_copy(folder.string(), "%", "%%")));
    return words;
  }

  /// Reads the queue, and appends returned jobs to `returned`.
  void look(std::vector<std::size_t>& returned) {
    const auto begun = Clock::now();
    const std::optional<Error> trouble = catch_error([&] {
      const std::vector<slurm::Task> tasks = slurm::queue();
      queued_.clear();
      running_ = 0;
      for (const slurm::Task& task : tasks) {
        if (std::find(arrays_.begin(), arrays_.end(), task.array) == arrays_.end()) continue;
        queued_.insert(task.array);
        running_ += task.waiting ? 0 : 1;
      }
    });
    silent_since_ = !trouble ? std::nullopt : silent_since_ ? silent_since_ : std::optional(begun);
    if (trouble && Clock::now() - *silent_since_ > kMostSilence)
      throw Error("squeue", fmt::format("has not answered for ten minutes: {}", trouble->reason()),
                  "the jobs continue; follow them with 'palpate status'", Error::Kind::run);
    // With --retry-failed, a failed job keeps its old result until it starts, so only the queue shows whether it has
    // ended.
    const auto ended = std::stable_partition(open_.begin(), open_.end(), [&](std::size_t job) {
      return trouble || (!queued_.empty() && (order_.options.resume.retry_failed ||
                                              !has_ended(job_directory(order_.sweep, order_.sweep.jobs[job]))));
    });
    returned.assign(ended, open_.end());
    open_.erase(ended, open_.end());
    // Reading many jobs from a slow file system takes long. The pause is ten times as long as the reading (within
    // limits), so most of the time is left to other users.
    next_ = Clock::now() + std::clamp<Clock::duration>(10 * (Clock::now() - begun), kPause, kMostPause);
  }

  LauncherSetup order_;
  fs::path directory_ = absolute(order_.sweep.directory / "").lexically_normal().parent_path();
  fs::path folder_;  ///< folder of the scripts and logs
  std::vector<int> arrays_;
  std::vector<std::size_t> open_;          ///< jobs that have not been returned
  std::set<int> queued_;                   ///< arrays that had tasks in the queue at the last query
  int running_ = 0;                        ///< number of running tasks
  Clock::time_point next_ = Clock::now();  ///< time of the next query
  std::optional<Clock::time_point> silent_since_;
};

}  // namespace

std::string shell_word(const std::string& text) {
  constexpr const char* kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./,:=@+%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  return "'" + boost::replace_all_copy(text, "'", "'\\''") + "'";
}

void check_sbatch_words(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (word.size() < 2 || word.front() != '-' || word == "--")
      throw Error("command line", fmt::format("--sbatch: '{}' is not an option of sbatch", word),
                  "write for example --sbatch=--mem=4G");
    const bool is_long = word.compare(0, 2, "--") == 0;
    const std::string name = is_long ? word.substr(0, word.find('=')) : word.substr(0, 2);
    for (const ReservedOption& own : kReservedOptions) {
      if (name != own.name && name != own.letter) continue;
      throw Error("command line", fmt::format("--sbatch: {} cannot be set with --sbatch", name), own.hint);
    }
  }
}

std::string task_script(const fs::path& program, const fs::path& directory, const fs::path& jobs,
                        const LaunchOptions& options) {
  std::string out =
      "#!/bin/sh\n# A task of a Slurm array resumes the jobs of the sweep that one line of a list names. The line "
      "number is the first\n# argument, 0 if absent, plus the array index. Jobs that are done or held by another "
      "process are skipped.\n" +
      script_head();
  out += fmt::format("jobs=$(sed -n \"$((${{1:-0}} + SLURM_ARRAY_TASK_ID + 1))p\" {})\n", shell_word(jobs.string()));
  out +=
      fmt::format("exec {} resume {} --jobs \"${{jobs:?there is no such task}}\" -j {} --attempts {} --quiet{}{}\n",
                  shell_word(program.string()), shell_word(directory.string()), options.workers, options.most_attempts,
                  options.resume.retry_failed ? " --retry-failed" : "", options.resume.force ? " --force" : "");
  return out;
}

const LauncherType slurm_launcher{
    [](const LauncherSetup& order) -> std::unique_ptr<Launcher> { return std::make_unique<SlurmLauncher>(order); },
    [](const ClusterOptions& options) { check_sbatch_words(options.words); }, slurm::check_installed};

}  // namespace palpate
