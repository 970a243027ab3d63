// SPDX-License-Identifier: MIT
// What runs, sweeps and robots left behind, changed by somebody else.
#include "fuzz/ground.hpp"
#include "fuzz/harness.hpp"

#include "bundle/archive.hpp"
#include "record/run.hpp"
#include "record/run_replay.hpp"
#include "sweep/draft.hpp"
#include "sweep/plan.hpp"

#include <palpate/error.hpp>

#include <array>

#include <zlib.h>

namespace palpate::fuzz {
namespace {

namespace fs = std::filesystem;

const Installation& installation() {
  const fs::path build = PALPATE_BUILD_FOLDER;
  static const Installation one{build / "palpate", build / "palpate-whole", build / "lib" / "palpate",
                                shipped_configs()};
  return one;
}

const RunEnvironment& environment() {
  static const RunEnvironment one{host(), installation(), {"palpate"}, nullptr};
  return one;
}

/// A run so small that it can be replayed a thousand times in a second.
const std::vector<std::string> kSmall{"taps=4", "initial.count=2", "candidates.count=5", "scene=object_i"};

fs::path sound_run() {
  Composer composer(shipped_configs(), config_keys());
  std::vector<Override> overrides;
  for (const std::string& one : kSmall) overrides.push_back(parse_override(one));
  const ResolvedConfig config =
      resolve_experiment(composer.compose(shipped_configs() / "paper" / "object_i.yaml", overrides), host());
  const fs::path directory = directory_of(config, ground().path() / "runs");
  StartOptions options;
  options.force = true;
  start_run(environment(), config, directory, options);
  return directory;
}

fs::path sound_sweep() {
  Composer composer(shipped_configs(), config_keys());
  std::vector<std::string> words = kSmall;
  words.insert(words.end(), {"seed=range(0,3)", "kernel=rbf,matern52"});
  const fs::path runs = ground().path() / "sweeps";
  SweepDraft draft(runs);
  const SweepPlan plan = plan_sweep(composer, host(), shipped_configs() / "paper" / "object_i.yaml", words, runs,
                                    [&](const Job& job, const ResolvedConfig& config) { draft.add(job, config); });
  draft.publish(plan);
  return plan.sweep.directory;
}

/// Puts other bytes into a file for a while.
class Changed {
 public:
  Changed(fs::path file, const std::string& bytes) : file_(std::move(file)), sound_(read_file(file_)) {
    write_file(file_, bytes);
  }
  ~Changed() { write_file(file_, sound_); }
  Changed(const Changed&) = delete;
  Changed& operator=(const Changed&) = delete;

 private:
  fs::path file_;
  std::string sound_;
};

template <class Read>
void attempt(const Read& read) {
  try {
    read();
  } catch (const Error&) {
  }
}

/// The file that the first byte stands for, and the other bytes.
template <std::size_t N>
std::pair<std::string, std::string> divided(const std::string& bytes, const std::array<const char*, N>& files) {
  if (bytes.empty()) return {files.front(), ""};
  return {files[static_cast<unsigned char>(bytes.front()) % N], bytes.substr(1)};
}

}  // namespace

void record(const std::string& bytes) {
  static const fs::path run = sound_run();
  static const std::array<const char*, 2> files{"record.jsonl", "config.yaml"};
  const auto [name, content] = divided(bytes, files);
  const Changed changed(run / name, content);
  attempt([&] { read_status(run); });
  attempt([&] { objection_to_build(environment(), load_run(host(), run), read_run_record(run)); });
  attempt([&] { replay_run(environment(), read_recorded_run(host(), run)); });
}

void plan(const std::string& bytes) {
  static const fs::path sweep = sound_sweep();
  static const std::array<const char*, 2> files{"manifest.jsonl", "config.yaml"};
  const auto [name, content] = divided(bytes, files);
  const Changed changed(sweep / name, content);
  attempt([&] {
    const Sweep read = read_sweep(sweep);
    sweep_results(read, sweep_summaries(read));
    sweep_name(read);
  });
}

void bundle(const std::string& bytes) {
  static const fs::path file = ground().path() / "x.palpate.tar.gz";
  gzFile out = gzopen(file.c_str(), "wb1");
  gzwrite(out, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(out);
  constexpr std::uintmax_t kMost = std::uintmax_t{1} << 20;
  attempt([&] {
    read_archive(file, kMost, [](const std::string& name, const std::string&) { check_archived_name(name, "bundle"); });
  });
}

}  // namespace palpate::fuzz
