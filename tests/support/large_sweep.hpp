// SPDX-License-Identifier: MIT
// A sweep of very many jobs as it stands when they have ended: written, not run.
#pragma once

#include "record/files.hpp"
#include "record/json.hpp"
#include "record/resolved_config.hpp"
#include "sweep/sweep.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

namespace palpate::test {

/// What a job of it came to: of every 100th nothing but a reason.
struct FakedJob {
  static bool failed(int index) { return index % 100 == 7; }
  static double error(int index) { return 0.001 * (index + 1); }
};

/// `seeds` jobs of each of two acquisitions, the seed running slowest, in a new directory.
inline Sweep large_sweep(const std::filesystem::path& directory, int seeds) {
  make_folder(directory / "jobs");
  write_file(directory / "config.yaml", "name: many\n");
  Sweep sweep{directory, {"seed", "acquisition"}, {}};
  for (int seed = 0; seed < seeds; ++seed) {
    for (const char* acquisition : {"weighted", "uncertainty"}) {
      const auto index = static_cast<int>(sweep.jobs.size());
      sweep.jobs.push_back({index, fmt::format("{:012x}", index), {std::to_string(seed), acquisition}});
      const std::filesystem::path folder = make_folder(job_directory(sweep, sweep.jobs.back()));
      Row summary;
      summary.add("name", "many");
      summary.add("seed", seed);
      summary.add("status", FakedJob::failed(index) ? "failed" : "done");
      summary.add("stop_reason", FakedJob::failed(index) ? "out of luck" : "tap budget");
      summary.add("taps", 3);
      if (!FakedJob::failed(index)) summary.add("rmse_m", FakedJob::error(index));
      // Not write_file(): what makes a file safe takes longer than all the rest.
      std::ofstream(folder / "record.jsonl")
          << "{\"manifest\": 1}\n"
          << fmt::format("{{\"end\": \"{}\", \"reason\": \"{}\", \"summary\": {}, \"files\": {{}}}}\n",
                         summary.text("status"), summary.text("stop_reason"), to_json_line(summary));
    }
  }
  write_file(directory / "manifest.jsonl", manifest_text(sweep, sweep_id(read_run_config(directory), sweep)));
  return sweep;
}

}  // namespace palpate::test
