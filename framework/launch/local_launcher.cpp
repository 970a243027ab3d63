// SPDX-License-Identifier: MIT
#include "launch/local_launcher.hpp"

#include "reading/read_file.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <sys/wait.h>

namespace palpate {
namespace {

constexpr std::chrono::milliseconds kBusyPause{200};

/// Returns whether the signal means a crash of the program itself.
bool is_crash(int signal) {
  constexpr std::array<int, 7> kCrashes{SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS};
  return std::find(kCrashes.begin(), kCrashes.end(), signal) != kCrashes.end();
}

}  // namespace

extern const LauncherType local_launcher{
    [](const LauncherSetup& order) -> std::unique_ptr<Launcher> { return std::make_unique<LocalLauncher>(order); }};

void LocalLauncher::submit(const std::vector<std::size_t>& jobs) {
  waiting_.insert(waiting_.end(), jobs.begin(), jobs.end());
}

bool LocalLauncher::start(std::size_t job) {
  std::unique_ptr<ChildProcess> process = ChildProcess::fork([&](const ChildProcess::Say& say) -> int {
    // Close the pipes of other children, because this child needs the file descriptors for its own files.
    for (const RunningJob& other : running_) other.process->forget();
    const JobEnd end = run(job);
    if (end == JobEnd::blocked) say(kBlocked);
    // Use exit() and not _exit(), because plugins must release resources such as a ROS node.
    std::exit(static_cast<int>(end));
  });
  if (!process && !running_.empty()) return false;
  if (!process)
    throw Error("", fmt::format("cannot start a child process for a job: {}", std::strerror(errno)), {},
                Error::Kind::run);
  running_.push_back({job, std::move(process)});
  return true;
}

JobEnd LocalLauncher::run(std::size_t job) const {
  JobEnd end = JobEnd::unrecorded;
  try {
    return run_job(order_.environment, directory_of(job), order_.options.resume);
  } catch (const std::exception& trouble) {  // the error cannot be recorded, so it is only printed
    const auto* const error = dynamic_cast<const Error*>(&trouble);
    if (error != nullptr && error->kind() == Error::Kind::busy) end = JobEnd::blocked;
    // execute_jobs() reports a missing folder once for all jobs. fmt::print would throw if the terminal is closed.
    std::error_code unknown;
    if (std::filesystem::exists(order_.sweep.directory, unknown) || unknown)
      std::fputs(fmt::format("job {}: {}\n", job, printable(trouble.what())).c_str(), stderr);
  }
  return end;
}

Launcher::PollResult LocalLauncher::poll(double seconds) {
  if (again_ <= Clock::now()) {
    waiting_.insert(waiting_.end(), later_.begin(), later_.end());
    later_.clear();
  }
  while (!waiting_.empty() && static_cast<int>(running_.size()) < order_.options.workers && start(waiting_.front()))
    waiting_.pop_front();
  std::vector<ChildProcess*> processes;
  for (const RunningJob& one : running_) processes.push_back(one.process.get());
  if (!later_.empty()) seconds = std::min(seconds, std::chrono::duration<double>(kBusyPause).count());
  if (running_.empty() && later_.empty()) seconds = 0.0;
  ChildProcess::listen(processes, seconds);
  PollResult state;
  // The count includes jobs that have just ended, because other jobs start at once in their place.
  state.running = static_cast<int>(running_.size());
  const auto ended = std::stable_partition(running_.begin(), running_.end(),
                                           [](const RunningJob& one) { return !one.process->ended(); });
  for (auto one = ended; one != running_.end(); ++one) conclude(one->job, *one->process, state);
  running_.erase(ended, running_.end());
  if (waiting_.empty()) state.running = static_cast<int>(running_.size());
  state.waiting = static_cast<int>(waiting_.size() + later_.size());
  return state;
}

void LocalLauncher::conclude(std::size_t job, const ChildProcess& process, PollResult& state) {
  const int wait_status = process.status();
  if (wait_status < 0) throw Error("", "the child process of a job is lost", {}, Error::Kind::run);
  if (WIFSIGNALED(wait_status)) return was_killed(job, WTERMSIG(wait_status), state);
  const auto end = static_cast<JobEnd>(WEXITSTATUS(wait_status));
  if (end == JobEnd::busy && order_.options.wait_for_others && !cancelled_) {
    again_ = Clock::now() + kBusyPause;
    later_.push_back(job);
    return;
  }
  if (end == JobEnd::blocked && process.said() == kBlocked) {  // the next job would be blocked, too
    waiting_.clear();
    later_.clear();
    state.blocked = true;
    return;
  }
  state.all_recorded = state.all_recorded && end != JobEnd::unrecorded;
  const bool ended = end == JobEnd::done || end == JobEnd::failed;
  const bool known = ended || end == JobEnd::unrecorded || end == JobEnd::busy || end == JobEnd::interrupted;
  // A plugin that calls exit(0) or exit(1) leaves no result.
  if (!cancelled_ && (!known || (ended && !has_ended(directory_of(job)))))
    record_failure(directory_of(job), fmt::format("its process ended with status {}", WEXITSTATUS(wait_status)));
  state.returned.push_back(job);
}

void LocalLauncher::was_killed(std::size_t job, int signal, PollResult& state) {
  // A kill before the attempt is recorded counts as an attempt, too. Otherwise such a job would be started again
  // forever.
  const int attempts = std::max(attempts_of(directory_of(job)), ++kills_[job]);
  const std::string name = fmt::format("signal {} ({})", signal, ::strsignal(signal));
  if (is_crash(signal)) {
    record_failure(directory_of(job), "crashed: " + name);
  } else if (cancelled_) {
    // The user cancelled the job.
  } else if (attempts >= order_.options.most_attempts) {
    record_failure(directory_of(job),
                   fmt::format("was killed by {}{} in attempt {}", name,
                               signal == SIGKILL ? ", as happens when memory runs out," : "", attempts));
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
  for (const RunningJob& one : running_) one.process->signal(SIGTERM);
}

}  // namespace palpate
