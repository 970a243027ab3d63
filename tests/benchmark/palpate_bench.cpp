// SPDX-License-Identifier: MIT
// Replays a file of taps on one posterior engine and prints, as JSON, what it chose and how long that took.
//   palpate_bench --taps tests/data/taps_w2.csv --grid 231 --engine lowrank --repeat 5
#include "benchmark/workload.hpp"
#include "math/instructions.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>

namespace {

using namespace palpate;

struct Arguments {
  std::string taps;
  int grid = 47;
  EngineSettings::Kind engine = EngineSettings::Kind::automatic;
  int repeat = 1;
  int threads = 1;
  double tolerance = EngineSettings{}.tolerance;
  std::string maps;
};

long peak_rss_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss * 1024;
}

void write_maps(const std::string& file, const CandidateGrid& candidates, const test::GaussianProcess& process) {
  const Eigen::VectorXd mean = process.mean(0);
  const Eigen::VectorXd variance = process.variance(0);
  const Eigen::VectorXd weight = process.mean(1);
  std::FILE* const out = std::fopen(file.c_str(), "w");
  if (out == nullptr) throw Error(file, "cannot be written");
  fmt::print(out, "x,y,mean,variance,weight\n");
  for (int i = 0; i < candidates.size(); ++i) {
    fmt::print(out, "{},{},{},{},{}\n", candidates.points(i, 0), candidates.points(i, 1), mean(i), variance(i),
               weight(i));
  }
  std::fclose(out);
}

void run(const Arguments& arguments) {
  const palpate::benchmark::Taps taps = palpate::benchmark::read_taps(arguments.taps);
  const CandidateGrid candidates = palpate::benchmark::square(arguments.grid);
  EngineSettings settings;
  settings.engine = arguments.engine;
  settings.tolerance = arguments.tolerance;
  settings.taps = static_cast<int>(taps.places.rows());
  settings.workers = std::make_shared<Workers>(arguments.threads);

  const std::shared_ptr<Kernel> kernel = palpate::benchmark::make_kernel();
  std::vector<double> totals;
  palpate::benchmark::Replay best;
  std::unique_ptr<test::GaussianProcess> process;
  for (int i = 0; i < arguments.repeat; ++i) {
    process.reset();
    palpate::benchmark::Replay one = palpate::benchmark::replay(taps, candidates, kernel, settings, &process);
    totals.push_back(one.total);
    if (one.total <= *std::min_element(totals.begin(), totals.end())) best = std::move(one);
  }
  const long memory = peak_rss_bytes();
  std::sort(totals.begin(), totals.end());
  int agree = 0;
  for (std::size_t i = 0; i + 1 < best.choices.size(); ++i) {
    const auto next = static_cast<Eigen::Index>(i) + palpate::benchmark::kInitialTaps;
    const Target chosen = candidates.target(best.choices[i]);
    const double apart = std::hypot(chosen.x - taps.places(next, 0), chosen.y - taps.places(next, 1));
    agree += apart < 1e-9 ? 1 : 0;
  }
  fmt::print("{{\n  \"engine\": \"{}\",\n  \"reason\": \"{}\",\n  \"instruction_path\": \"{}\",\n",
             process->engine().name, process->engine().reason, math::name_of(instructions_in_use()));
  fmt::print("  \"candidates\": {},\n  \"taps\": {},\n  \"error_bound\": {:.3g},\n", candidates.size(), process->size(),
             process->engine().error_bound);
  fmt::print("  \"total_seconds\": {{\"least\": {:.6g}, \"median\": {:.6g}}},\n  \"peak_rss_bytes\": {},\n",
             totals.front(), totals[totals.size() / 2], memory);
  fmt::print("  \"choices_as_in_file\": \"{} of {}\",\n", agree, best.choices.size() - 1);
  fmt::print("  \"choices\": [{}],\n", fmt::join(best.choices, ", "));
  fmt::print("  \"seconds_per_tap\": [{:.3g}]\n}}\n", fmt::join(best.seconds, ", "));
  if (!arguments.maps.empty()) write_maps(arguments.maps, candidates, *process);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Replays taps on a posterior engine: height and label GP, choice of the best u w after every tap");
  Arguments arguments;
  using Kind = EngineSettings::Kind;
  const std::map<std::string, Kind> engines{
      {"auto", Kind::automatic}, {"dense", Kind::dense}, {"grid", Kind::grid}, {"lowrank", Kind::lowrank}};
  app.add_option("--taps", arguments.taps, "x,y,height,on_object; the first three are the initial taps")->required();
  app.add_option("--grid", arguments.grid, "candidates a side of the 23 cm square")->check(CLI::Range(2, 2000));
  app.add_option("--engine", arguments.engine, "auto, dense, grid or lowrank")
      ->transform(CLI::CheckedTransformer(engines).description(""));
  app.add_option("--repeat", arguments.repeat, "times to replay; the fastest is told tap by tap")
      ->check(CLI::Range(1, 1000000));
  app.add_option("--threads", arguments.threads, "")->check(CLI::Range(1, 64));
  app.add_option("--tolerance", arguments.tolerance, "of lowrank");
  app.add_option("--maps", arguments.maps, "writes the final maps there, as CSV");
  CLI11_PARSE(app, argc, argv);
  try {
    math::choose_instructions();
    run(arguments);
  } catch (const std::exception& trouble) {
    fmt::print(stderr, "palpate_bench: {}\n", trouble.what());
    return 1;
  }
  return 0;
}
