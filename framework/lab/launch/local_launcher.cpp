// SPDX-License-Identifier: MIT
#include "launch/local_launcher.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <sys/wait.h>

namespace palpate {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kBusyPause{200};

/// Exit statuses of a child.
constexpr std::array<std::pair<JobEnd, int>, 4> kStatuses{
    {{JobEnd::done, 0}, {JobEnd::failed, 1}, {JobEnd::busy, 75}, {JobEnd::interrupted, 130}}};
constexpr int kUnrecorded = 2;  ///< not even the failure could be recorded

int status_of(JobEnd end) {
  return std::find_if(kStatuses.begin(), kStatuses.end(), [end](const auto& one) { return one.first == end; })->second;
}

/// Signals by which a program breaks down by itself; others come from outside.
bool is_crash(int signal) {
  constexpr std::array<int, 7> kCrashes{SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS};
  return std::find(kCrashes.begin(), kCrashes.end(), signal) != kCrashes.end();
}

/// Not with fmt::print, which throws when stderr is a terminal that was closed.
void mention(std::size_t job, const char* what) { std::fputs(fmt::format("job {}: {}\n", job, what).c_str(), stderr); }

}  // namespace

LocalLauncher::LocalLauncher(const Workshop& workshop, const Sweep& sweep, Configs config_of,
                             const LocalOptions& options)
    : workshop_(workshop), sweep_(sweep), config_of_(std::move(config_of)), options_(options) {}

void LocalLauncher::submit(const std::vector<std::size_t>& jobs) {
  waiting_.insert(waiting_.end(), jobs.begin(), jobs.end());
}

bool LocalLauncher::start(std::size_t job) {
  std::unique_ptr<ChildProcess> process = ChildProcess::fork([&](const ChildProcess::Say&) -> int {
    // What it may open is for its own files.
    for (const Running& other : running_) other.process->forget();
    // Not as children end otherwise: plugins have things to take down, such as a robot's node.
    std::exit(be_child(job));
  });
  if (!process && !running_.empty()) return false;
  if (!process) throw Error("", fmt::format("no process for a job: {}", std::strerror(errno)), {}, Error::Kind::run);
  running_.push_back({job, std::move(process)});
  return true;
}

JobEnd LocalLauncher::run(std::size_t job) const {
  std::optional<ResolvedConfig> config;
  try {
    config.emplace(config_of_(job));
  } catch (const Error& trouble) {
    std::error_code none;
    // One that was deleted has not failed: `palpate sweep` puts it back.
    if (!std::filesystem::exists(directory_of(job) / "config.yaml", none)) throw;
    record_failure(directory_of(job), sweep_.jobs[job].id, trouble.what());
    return JobEnd::failed;
  }
  return run_job(workshop_, *config, directory_of(job), options_.resume);
}

int LocalLauncher::be_child(std::size_t job) const {
  try {
    return status_of(run(job));
  } catch (const std::exception& trouble) {
    std::error_code none;
    // Who conducts the sweep says once that all of it is gone.
    if (std::filesystem::exists(sweep_.directory, none)) mention(job, trouble.what());
  }
  return kUnrecorded;
}

Launcher::State LocalLauncher::poll(double seconds) {
  while (!later_.empty() && later_.front().when <= Clock::now()) {
    waiting_.push_back(later_.front().job);
    later_.pop_front();
  }
  while (!waiting_.empty() && static_cast<int>(running_.size()) < options_.workers && start(waiting_.front())) {
    waiting_.pop_front();
  }
  std::vector<ChildProcess*> processes;
  for (const Running& one : running_) processes.push_back(one.process.get());
  if (!later_.empty()) seconds = std::min(seconds, std::chrono::duration<double>(kBusyPause).count());
  if (running_.empty() && later_.empty()) seconds = 0.0;
  ChildProcess::listen(processes, seconds);
  State state;
  const auto ended =
      std::stable_partition(running_.begin(), running_.end(), [](const Running& one) { return !one.process->ended(); });
  for (auto one = ended; one != running_.end(); ++one) conclude(one->job, one->process->status(), state);
  running_.erase(ended, running_.end());
  state.running = static_cast<int>(running_.size());
  state.waiting = static_cast<int>(waiting_.size() + later_.size());
  return state;
}

void LocalLauncher::conclude(std::size_t job, int wait_status, State& state) {
  if (wait_status < 0) throw Error("", "a job's process is lost", {}, Error::Kind::run);
  if (WIFSIGNALED(wait_status)) return was_killed(job, WTERMSIG(wait_status), state);
  const int status = WEXITSTATUS(wait_status);
  if (status == status_of(JobEnd::busy) && options_.wait_for_others && !cancelled_) {
    later_.push_back({job, Clock::now() + kBusyPause});
    return;
  }
  if (status != kUnrecorded && !cancelled_ && !is_borne_out(job, status)) {
    record_failure(directory_of(job), sweep_.jobs[job].id, fmt::format("its process ended with status {}", status));
  }
  state.returned.push_back(job);
}

bool LocalLauncher::is_borne_out(std::size_t job, int status) const {
  if (status == status_of(JobEnd::busy) || status == status_of(JobEnd::interrupted)) return true;
  if (status != status_of(JobEnd::done) && status != status_of(JobEnd::failed)) return false;
  const RunStatus::State state = read_ending(directory_of(job)).state;
  return state == RunStatus::State::done || state == RunStatus::State::failed;
}

void LocalLauncher::was_killed(std::size_t job, int signal, State& state) {
  // Who is killed before its attempt is noted counts, too, or it would be begun for ever.
  const int attempts = std::max(attempts_of(directory_of(job)), ++kills_[job]);
  const std::string name = fmt::format("signal {} ({})", signal, ::strsignal(signal));
  if (is_crash(signal)) {
    record_failure(directory_of(job), sweep_.jobs[job].id, "crashed: " + name);
  } else if (cancelled_) {
    // As wished.
  } else if (attempts >= options_.most_attempts) {
    record_failure(directory_of(job), sweep_.jobs[job].id,
                   fmt::format("was killed by {}{} in attempt {}", name,
                               signal == SIGKILL ? ", as is done when memory runs out," : "", attempts));
  } else {
    waiting_.push_front(job);
    return;
  }
  state.returned.push_back(job);
}

void LocalLauncher::cancel() {
  cancelled_ = true;
  waiting_.clear();
  later_.clear();
  for (const Running& one : running_) one.process->signal(SIGTERM);
}

}  // namespace palpate
