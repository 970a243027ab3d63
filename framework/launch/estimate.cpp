// SPDX-License-Identifier: MIT
#include "launch/estimate.hpp"

#include "experiment/experiment.hpp"
#include "scene/scene_options.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kSamples = 16;
constexpr double kSampleSeconds = 0.05;
/// Of a job beside its computing: process, lock and files. 2 to 4 ms where it was measured.
constexpr double kRecordSeconds = 0.003;
constexpr int kMostMilliseconds = 2000;  ///< for all samples: one tap of a sample may take long

/// The job of a sample. Multiples of the golden ratio fall into no step with the periods of a grid.
std::size_t job_of(std::size_t sample, std::size_t samples, std::size_t jobs) {
  if (samples == jobs) return sample;
  constexpr double kGolden = 0.6180339887498949;
  const double share = std::fmod((static_cast<double>(sample) + 0.5) * kGolden, 1.0);
  return std::min(jobs - 1, static_cast<std::size_t>(share * static_cast<double>(jobs)));
}

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

/// Knows the height of every place and takes no time.
class SceneBackend final : public Backend {
 public:
  SceneBackend(const ExperimentOptions& options, const PluginFactory& factory)
      : scene_(build_scene(options.scene, static_cast<std::uint64_t>(options.seed), factory)) {}

  Contact tap(const TapRequest& request) override {
    return {Outcome::contact, scene_->height(request.target.x, request.target.y), 0.0, 0.0, {}};
  }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return true; }

 private:
  std::unique_ptr<const Scene> scene_;
};

/// Breaks a run off when its time is over.
class Timer final : public Journal {
 public:
  explicit Timer(Clock::time_point begin) : begin_(begin) {}
  void announce(const TapRecord&) override {}
  void record(const TapRecord& tap, const std::array<double, kPhases>&) override {
    taps_ = tap.number;
    over_ = seconds_since(begin_) > kSampleSeconds;
  }
  int taps() const { return taps_; }
  const std::atomic<bool>* over() const { return &over_; }

 private:
  Clock::time_point begin_;
  int taps_ = 0;
  std::atomic<bool> over_{false};
};

/// The seconds of one job, added to `estimate`.
void try_out(const PluginFactory& factory, const ResolvedConfig& config, Estimate& estimate) {
  const Clock::time_point begin = Clock::now();
  Timer timer(begin);
  Experiment experiment(config.options, factory, timer.over(), std::make_shared<SceneBackend>(config.options, factory));
  experiment.run(timer);
  const bool whole = !timer.over()->load();
  if (whole) experiment.result();
  const double share = whole ? 1.0 : static_cast<double>(timer.taps()) / static_cast<double>(config.options.taps);
  estimate.job_seconds += seconds_since(begin) / share;
  estimate.at_least = estimate.at_least || !whole;
}

[[noreturn]] void answer(int pipe, const PluginFactory& factory,
                         const std::function<ResolvedConfig(std::size_t job)>& config_of, std::size_t jobs) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  try {
    Estimate estimate;
    const std::size_t samples = std::min(jobs, kSamples);
    for (std::size_t i = 0; i < samples; ++i) try_out(factory, config_of(job_of(i, samples, jobs)), estimate);
    estimate.job_seconds = estimate.job_seconds / static_cast<double>(samples) + kRecordSeconds;
    ::_exit(::write(pipe, &estimate, sizeof estimate) == static_cast<ssize_t>(sizeof estimate) ? 0 : 1);
  } catch (...) {
    // A job that cannot even be built says so when it is run.
    ::_exit(1);
  }
}

}  // namespace

std::optional<Estimate> estimate_job(const PluginFactory& factory,
                                     const std::function<ResolvedConfig(std::size_t job)>& config_of,
                                     std::size_t jobs) {
  std::array<int, 2> ends{};
  if (jobs == 0 || ::pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  std::fflush(nullptr);  // or the child might print it again
  const pid_t pid = ::fork();
  if (pid == 0) answer(ends[1], factory, config_of, jobs);
  ::close(ends[1]);
  Estimate estimate;
  bool known = false;
  if (pid > 0) {
    pollfd said{ends[0], POLLIN, 0};
    known = ::poll(&said, 1, kMostMilliseconds) > 0 &&
            ::read(ends[0], &estimate, sizeof estimate) == static_cast<ssize_t>(sizeof estimate);
    ::kill(pid, SIGKILL);
    while (::waitpid(pid, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  ::close(ends[0]);
  return known ? std::optional(estimate) : std::nullopt;
}

}  // namespace palpate
