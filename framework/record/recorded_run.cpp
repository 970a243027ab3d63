// SPDX-License-Identifier: MIT
#include "record/recorded_run.hpp"

#include "config/catch_error.hpp"
#include "config/compose.hpp"
#include "config/yaml.hpp"
#include "reading/read_file.hpp"
#include "record/fields.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Adds the origins of the value at `path` and of the values below this path.
void add_origins(const Tree& tree, const std::string& path, const std::vector<std::string>& lines,
                 std::map<std::string, std::string>& out) {
  const auto line = static_cast<std::size_t>(tree.place.line);
  if (!tree.is_map() && line < lines.size() && !lines[line].empty()) out.emplace(path, lines[line]);
  const std::string below = path.empty() ? path : path + ".";
  for (const Tree::Entry& entry : tree.entries) add_origins(entry.value, below + entry.key, lines, out);
  for (std::size_t i = 0; i < tree.items.size(); ++i) add_origins(tree.items[i], below + std::to_string(i), lines, out);
}

}  // namespace

RunIdentity read_identity(const fs::path& directory) {
  RunIdentity out;
  // A damaged manifest is ignored here, because other functions report it.
  catch_error([&] {
    const std::optional<Tree> manifest = read_manifest(directory);
    if (const Tree* name = manifest ? manifest->find("name") : nullptr) out.name = name->text;
    if (const Tree* identity = manifest ? manifest->find("identity") : nullptr) out.identity = identity->text;
  });
  return out;
}

Tree read_run_config(const fs::path& directory) {
  const fs::path file = directory / "config.yaml";
  if (!is_there(file)) throw Error(directory.string(), "is not a run directory", "it has no config.yaml");
  Tree config = read_yaml(file, FileOrigin::record);
  mark_complete(config);
  return config;
}

std::map<std::string, std::string> recorded_origins(const fs::path& directory) {
  std::map<std::string, std::string> out;
  const fs::path file = directory / "config.yaml";
  const FileReading reading = read_bounded(file, kMostConfigBytes, FileOrigin::record);
  if (!reading) return out;
  const std::vector<std::string> lines = places_of_lines(reading.text);
  catch_error([&] {
    add_origins(parse_yaml(reading.text, file.string()), "", lines, out);
  });  // without the config, the result stays empty
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
  const std::string recorded = read_identity(directory).identity;
  const bool other_folder = begins_with_id(name) && name.substr(0, kIdLength) != config.id;
  if (recorded.empty() ? other_folder : recorded != config.identity)
    throw Error((directory / "config.yaml").string(),
                fmt::format("the config now has the id {}, the run has {}", config.id,
                            (recorded.empty() ? name : recorded).substr(0, kIdLength)),
                "config.yaml was changed; run it with 'palpate run' instead");
  if (!other_folder) return config;
  throw Error(directory.string(), fmt::format("contains the run {}, but has the name of another run", config.id),
              "rename the folder");
}

RecordedRun read_recorded_run(const PluginHost& host, const fs::path& directory) {
  return read_recorded_run(load_run(host, directory), directory);
}

RecordedRun read_recorded_run(ResolvedConfig config, const fs::path& directory) {
  RunRecord record = read_run_record(directory);
  if (record.taps.empty()) throw Error(directory.string(), "has no recorded tap", {}, Error::Kind::run);
  RecordedRun out{directory, std::move(config),         std::move(record.taps),
                  {},        std::move(record.timings), std::move(record.manifest),
                  {}};
  out.taps = read_taps(out.rows, record.file);
  if (record.end && record.end->how != Ending::EndKind::interrupted) out.summary = std::move(record.end->summary);
  return out;
}

}  // namespace palpate
