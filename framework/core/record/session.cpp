// SPDX-License-Identifier: MIT
#include "record/session.hpp"

#include "config/catch_error.hpp"
#include "config/compose.hpp"
#include "config/hash.hpp"
#include "config/yaml.hpp"
#include "reading/reading.hpp"
#include "record/course.hpp"
#include "record/json.hpp"
#include "record/recording.hpp"
#include "record/summary.hpp"
#include "space/from_any_side.hpp"

#include <fmt/format.h>

#include <memory>

namespace palpate {

namespace fs = std::filesystem;

namespace {

RunReport report_done(const Workshop& workshop, RunDirectory& held) {
  return {held.path(), true, false, held.before().end->summary, restore_files(workshop, held)};
}

}  // namespace

std::vector<ModelReader> readers_of(const Workshop& workshop, const ResolvedConfig& config) {
  const bool connects = config.options.backend.type != "simulator";  // as far as anybody knows
  return make_experiment(config.options, workshop.host, workshop.interrupted, connects ? no_backend(false) : nullptr)
      ->readers();
}

fs::path directory_of(const ResolvedConfig& config, const fs::path& runs) {
  return runs / slug(config.options.name) / config.id;
}

RunReport start_run(const Workshop& workshop, const ResolvedConfig& config, const fs::path& directory, bool force,
                    Journal* observer, Supervisor* supervisor) {
  check_who_taps(config, Taps::by_backend, "run");
  const Stopwatch watch;
  const Begun run = begin_run(workshop, config, directory, force, supervisor != nullptr);
  if (!run.experiment) {
    const RunStatus status = read_ending(directory);
    if (!lacks_files(directory, status.end.value())) return {directory, true, false, status.end->summary};
    RunDirectory held(directory);
    return report_done(workshop, held);
  }
  return Course(config, *run.directory, *run.experiment, watch, observer, supervisor).run();
}

Tree read_run_config(const fs::path& directory) {
  const fs::path file = directory / "config.yaml";
  if (!is_there(file)) throw Error(directory.string(), "is not a run directory", "it has no config.yaml");
  Tree config = read_yaml(file, Origin::record);
  mark_complete(config);
  return config;
}

/// Adds the origins of what stands at `path` and below.
static void add_origins(const Tree& tree, const std::string& path, const std::vector<std::string>& lines,
                        std::map<std::string, std::string>& out) {
  const auto line = static_cast<std::size_t>(tree.place.line);
  if (!tree.is_map() && line < lines.size() && !lines[line].empty()) out.emplace(path, lines[line]);
  const std::string below = path.empty() ? path : path + ".";
  for (const Tree::Entry& entry : tree.entries) add_origins(entry.value, below + entry.key, lines, out);
  for (std::size_t i = 0; i < tree.items.size(); ++i) add_origins(tree.items[i], below + std::to_string(i), lines, out);
}

std::map<std::string, std::string> recorded_origins(const fs::path& directory) {
  std::map<std::string, std::string> out;
  const fs::path file = directory / "config.yaml";
  const Reading reading = read_bounded(file, kMostConfigBytes, Origin::record);
  if (!reading) return out;
  const std::vector<std::string> lines = places_of_lines(reading.text);
  catch_error([&] { add_origins(parse_yaml(reading.text, file.string()), "", lines, out); });  // then nothing is known
  return out;
}

std::string recorded_group(const std::map<std::string, std::string>& origins, const std::string& path,
                           const std::string& kind) {
  for (auto at = origins.lower_bound(path); at != origins.end() && at->first.compare(0, path.size(), path) == 0; ++at) {
    const fs::path file = at->second.substr(0, at->second.find(".yaml:"));
    if (file.parent_path().filename() == kind) return file.filename().string();
  }
  return {};
}

ResolvedConfig load_run(const PluginHost& host, const fs::path& directory) {
  ResolvedConfig config = resolve_experiment(read_run_config(directory), host);
  const std::string name = fs::absolute(directory).lexically_normal().filename().string();
  const std::string recorded = recorded_run(directory).identity;
  const bool other_folder = begins_with_id(name) && name.substr(0, kIdLength) != config.id;
  if (recorded.empty() ? other_folder : recorded != config.identity) {
    throw Error((directory / "config.yaml").string(),
                fmt::format("the config now has the id {}, the run has {}", config.id,
                            (recorded.empty() ? name : recorded).substr(0, kIdLength)),
                "config.yaml was changed; run it with 'palpate run' instead");
  }
  if (!other_folder) return config;
  throw Error(directory.string(), fmt::format("contains the run {}, but has the name of another run", config.id),
              "rename the folder");
}

std::optional<Error> objection_to_build(const Workshop& workshop, const ResolvedConfig& config,
                                        const RunRecord& record) {
  const std::string build = record.build();
  if (build.empty() || build == build_hash(workshop.host, config.notes.plugins) || record.taps.empty())
    return std::nullopt;
  return Error(record.file.parent_path().string(), "this run was started by another build of palpate or its plugins",
               "add --force to resume it with this build, which the record will note");
}

Restored restore_files(const Workshop& workshop, RunDirectory& held) {
  const fs::path& directory = held.path();
  const RunRecord& record = held.before();
  Restored out;
  const auto restore = [&](const Ending::File& one, const std::string& text) {
    const bool same = text.size() == one.bytes && hash_of(text) == one.hash;
    if (same) held.write(one.name, text);
    (same ? out.made : out.lost).push_back(one.name);
  };
  for (const Ending::File& one : record.end->files) {
    const std::optional<std::string> now = read_if_there(directory / one.name);
    if (now && now->size() == one.bytes && hash_of(*now) == one.hash) continue;
    if (one.name == kTapsTable) {
      restore(one, to_csv(record.taps));
      continue;
    }
    const Recording recording = read_recording(workshop, directory);
    Playback playback(workshop, recording);
    playback.advance_to(static_cast<int>(recording.taps.size()));
    playback.experiment().result();  // reads what the run read at its end
    const auto [name, text] = surface_file(playback.experiment());
    restore(one, name == one.name ? text : "");
    const bool is_made = out.lost.empty() || out.lost.back() != one.name;
    if (!is_made && playback.truth_lost()) throw Error(*playback.truth_lost());
  }
  // Last, as a run does.
  const std::string summary = to_json(record.end->summary);
  if (read_if_there(directory / kSummaryFile) != summary) {
    held.write(kSummaryFile, summary);
    out.made.emplace_back(kSummaryFile);
  }
  return out;
}

RunReport resume_run(const Workshop& workshop, const fs::path& directory, const ResumeOptions& options,
                     Journal* observer, Supervisor* supervisor) {
  // Read first: what is no run directory is not made one.
  const ResolvedConfig config = load_run(workshop.host, directory);
  RunDirectory held(directory);
  return resume_held(workshop, config, held, options, observer, supervisor);
}

RunReport resume_held(const Workshop& workshop, const ResolvedConfig& config, RunDirectory& held,
                      const ResumeOptions& options, Journal* observer, Supervisor* supervisor) {
  const Stopwatch watch;
  const std::unique_ptr<Experiment> experiment =
      go_on(workshop, config, held, options, Taps::by_backend, supervisor != nullptr);
  if (!experiment) return report_done(workshop, held);
  return Course(config, held, *experiment, watch, observer, supervisor).run();
}

}  // namespace palpate
