// SPDX-License-Identifier: MIT
#include "cli/campaign.hpp"
#include "cli/commands.hpp"
#include "launch/slurm_launcher.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>

#include <charconv>
#include <set>

namespace palpate::cli {
namespace {

/// The jobs in "0-7,12", ascending, each once. Throws Error for what is none of `count`.
std::vector<std::size_t> parse_jobs(const std::string& text, std::size_t count) {
  const auto refuse = [&] {
    return Error("command line", fmt::format("--jobs: '{}' is not understood", text),
                 fmt::format("write 0-7,12, from 0 to {}", count - 1));
  };
  const auto number = [&](const std::string& word) {
    const char* const end = word.data() + word.size();
    std::size_t out = 0;
    const auto read = std::from_chars(word.data(), end, out);
    if (read.ec != std::errc() || read.ptr != end || out >= count) throw refuse();
    return out;
  };
  std::set<std::size_t> jobs;
  std::vector<std::string> parts;
  for (const std::string& part : boost::split(parts, text, boost::is_any_of(","))) {
    const auto dash = part.find('-');
    const std::size_t first = number(part.substr(0, dash));
    const std::size_t last = dash == std::string::npos ? first : number(part.substr(dash + 1));
    if (last < first) throw refuse();
    for (std::size_t job = first; job <= last; ++job) jobs.insert(job);
  }
  return {jobs.begin(), jobs.end()};
}

}  // namespace

int resume_sweep(Program& program, const ResumeArguments& arguments) {
  check_sbatch_words(arguments.launch.sbatch);
  const ResumeOptions options{arguments.retry_failed, arguments.force};
  if (arguments.step) {
    throw Error("command line", "--step: " + arguments.directory + " is a sweep of many runs", "leave it out");
  }
  const Sweep sweep = read_sweep(arguments.directory);
  const auto config_of = [&](std::size_t job) { return load_run(program.host, job_directory(sweep, sweep.jobs[job])); };
  Campaign campaign{sweep, config_of, options, arguments.launch, {}, false};
  if (!arguments.jobs.empty()) campaign.only = parse_jobs(arguments.jobs, sweep.jobs.size());
  if (!arguments.jobs.empty() && arguments.launch.jobs_per_task.value_or(1) > 1) {
    throw Error("command line", "--jobs and --jobs-per-task do not go together: a task carries on all of its jobs",
                "leave one of them out");
  }
  if (!arguments.jobs.empty() && !arguments.launch.junit.empty()) {
    throw Error("command line", "--jobs and --junit do not go together: what is expected is judged of the whole sweep",
                "leave one of them out");
  }
  check_builds(program, campaign, false);
  return run_campaign(program, campaign);
}

}  // namespace palpate::cli
