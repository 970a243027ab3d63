// SPDX-License-Identifier: MIT
// Google Benchmark over the posterior engines on the workloads, and over a whole run of the program.
//   build/release/tests/posterior_benchmark --benchmark_filter=W2
#include "benchmark/workload.hpp"
#include "support/support.hpp"

#include <benchmark/benchmark.h>

#include <memory>
#include <string>
#include <vector>

namespace palpate {
namespace {

struct Workload {
  const char* name;
  const char* file;
  int grid;
  bool large;  ///< more memory and time than dense should take
};

constexpr Workload kWorkloads[] = {
    {"W1", "taps_w1.csv", 47, false}, {"W2", "taps_w2.csv", 231, false}, {"W3", "taps_w3.csv", 461, true}};

struct Variant {
  const char* name;
  PosteriorSettings::Kind engine;
  int threads = 1;
  bool baseline = false;
};

std::vector<Variant> variants() {
  using Kind = PosteriorSettings::Kind;
  return {{"auto", Kind::automatic},
          {"dense", Kind::dense},
          {"grid", Kind::grid},
          {"grid/threads:2", Kind::grid, 2},
          {"grid/baseline", Kind::grid, 1, true},
          {"lowrank", Kind::lowrank},
          {"lowrank/threads:2", Kind::lowrank, 2},
          {"lowrank/baseline", Kind::lowrank, 1, true}};
}

void replay_workload(::benchmark::State& state, const Workload& workload, const Variant& variant) {
  const palpate::benchmark::Taps taps =
      palpate::benchmark::read_taps(test::source_folder() / "tests" / "data" / workload.file);
  const Candidates candidates = palpate::benchmark::square(workload.grid);
  const std::shared_ptr<Kernel> kernel = palpate::benchmark::make_kernel();
  PosteriorSettings settings;
  settings.engine = variant.engine;
  settings.taps = static_cast<int>(taps.places.rows());
  if (variant.baseline) settings.machine.loops = &simd::baseline();
  settings.machine.workers = std::make_shared<Workers>(variant.threads);
  std::unique_ptr<Process> process;
  while (state.KeepRunning()) {
    process.reset();
    // As palpate_bench has it: the making of the process counts, its end does not.
    state.SetIterationTime(palpate::benchmark::replay(taps, candidates, kernel, settings, &process).total);
  }
  state.SetLabel(std::string(process->engine()) + ", " + settings.machine.loops->name);
}

/// From the start of the process to its exit, with a fresh folder for its output, so that no run is found finished.
void run_program(::benchmark::State& state) {
  const std::string config = (test::source_folder() / "configs" / "paper" / "object_i_right.yaml").string();
  while (state.KeepRunning()) {
    state.PauseTiming();
    auto runs = std::make_unique<test::TemporaryFolder>();
    state.ResumeTiming();
    const test::Ended ended = test::palpate({"run", config, "--runs", runs->path().string(), "--quiet"}, runs->path());
    state.PauseTiming();
    runs.reset();
    state.ResumeTiming();
    if (ended.status != 0) {
      state.SkipWithError(ended.err.c_str());
      break;
    }
  }
}

void register_all() {
  for (const Workload& workload : kWorkloads) {
    for (const Variant& variant : variants()) {
      if (workload.large && variant.engine == PosteriorSettings::Kind::dense) continue;
      const std::string name = std::string(workload.name) + "/" + variant.name;
      ::benchmark::RegisterBenchmark(
          name.c_str(), [&workload, variant](::benchmark::State& state) { replay_workload(state, workload, variant); })
          ->UseManualTime()
          ->Unit(::benchmark::kMillisecond);
    }
  }
  ::benchmark::RegisterBenchmark("palpate_run/object_i_right", run_program)
      ->UseRealTime()
      ->Unit(::benchmark::kMillisecond);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  ::benchmark::Initialize(&argc, argv);
  if (::benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  palpate::register_all();
  ::benchmark::RunSpecifiedBenchmarks();
  ::benchmark::Shutdown();
  return 0;
}
