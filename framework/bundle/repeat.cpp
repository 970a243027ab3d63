// SPDX-License-Identifier: MIT
#include "bundle/repeat.hpp"

#include "config/catch_error.hpp"
#include "config/yaml.hpp"
#include "math/instructions.hpp"
#include "record/fields.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/record_reader.hpp"
#include "record/recorded_run.hpp"
#include "record/run_replay.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Absolute difference below which two numbers are equal for two builds.
constexpr double kSmallNumber = 1e-12;
/// Fields of taps that are equal on all builds.
const std::set<std::string> kExactFields{"source", "outcome", "on_object", "x",  "y",   "z",
                                         "dx",     "dy",      "dz",        "id", "taps"};

std::string shown(const Scalar* value) {
  if (value == nullptr) return "nothing";
  return std::holds_alternative<std::monostate>(*value) ? "null" : csv_cell(*value);
}

/// Returns the number that the whole text is; nullopt if it is none.
std::optional<double> number_of(const std::string& text) {
  double out = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(out) : std::nullopt;
}

/// Returns whether two texts are equal, or two numbers that are almost equal.
bool are_close(const std::string& first, const std::string& second) {
  const auto a = number_of(first);
  const auto b = number_of(second);
  return first == second ||
         (a && b && std::abs(*a - *b) <= kNumberTolerance * std::max(std::abs(*a), std::abs(*b)) + kSmallNumber);
}

/// Returns whether two values of a field count as different. `exact`: made by the same build.
bool differ(const std::string& field, const std::string& recorded, const std::string& now, bool exact) {
  // Two candidates with almost equal scores may change their places.
  if (!exact && (field == "runner_up.x" || field == "runner_up.y" || field == "instruction_path")) return false;
  return exact || kExactFields.count(field) > 0 ? recorded != now : palpate::differ(recorded, now);
}

/// Appends one line for each value that differs between two rows, with `place` at its beginning.
void compare_rows(const Row& recorded, const Row& now, const std::string& place, bool exact,
                  std::vector<std::string>& differences) {
  const auto compare = [&](const std::string& field) {
    const Scalar* const a = recorded.find(field);
    const Scalar* const b = now.find(field);
    const std::string before = shown(a);
    const std::string after = shown(b);
    const bool same_type = a != nullptr && b != nullptr && a->index() == b->index();
    if (differ(field, before, after, exact) || (exact && !same_type))
      differences.push_back(fmt::format("{}: {}: recorded {}, now {}", place, field, before, after));
  };
  for (const auto& [field, value] : recorded.fields) compare(field);
  for (const auto& [field, value] : now.fields) {
    if (recorded.find(field) == nullptr) compare(field);
  }
}

bool is_of_process(const std::string& field) { return field == "at" || field == "host" || field == "pid"; }

/// Returns whether a field of a line is the same in every repetition of a run. `exact`: by the same build.
bool is_comparable(LineKind kind, const std::string& field, bool exact) {
  static const std::set<std::string> kOfRun{"manifest", "name", "id", "identity"};
  constexpr std::string_view kSummary = "summary.";
  if (is_of_process(field) || (kind == LineKind::timing && field != "timing")) return false;
  // Equal code may stand in several commits, which README.md lists.
  if (kind == LineKind::manifest) return kOfRun.count(field) > 0 || (exact && field != "commit" && field != "dirty");
  if (kind == LineKind::attempt) return exact || field != "build";
  // Of the files beside the record, only the table of the taps follows from the record without its times.
  if (kind == LineKind::end && boost::starts_with(field, "files."))
    return exact && boost::starts_with(field, fmt::format("files.{}.", kTapsTable));
  return !boost::starts_with(field, kSummary) || !depends_on_machine(field.substr(kSummary.size()));
}

/// Lines of a record without clocks, and without what depends on kills and interrupts: the ends of attempts, further
/// attempts, and if there are several attempts, times and notes.
std::vector<std::pair<LineKind, Row>> comparable_lines(const std::string& text, std::size_t attempts, bool exact) {
  std::vector<std::pair<LineKind, Row>> out;
  std::istringstream lines(text);
  std::set<LineKind> seen;
  for (std::string line; std::getline(lines, line);) {
    const LineKind kind = kind_of_line(line);
    std::string reason;
    std::optional<Row> row = parse_json_row(line, &reason);
    if (!row) throw Error(kRecordFile, reason);
    const bool is_first = seen.insert(kind).second;
    const bool is_of_attempt = (kind == LineKind::attempt || kind == LineKind::setup) && !is_first;
    const bool is_lost = attempts > 1 && (kind == LineKind::timing || kind == LineKind::note);
    const bool is_interrupt = kind == LineKind::end && row->text("end") == ending_name(Ending::EndKind::interrupted);
    if (is_of_attempt || is_lost || is_interrupt) continue;
    const auto end = std::remove_if(row->fields.begin(), row->fields.end(), [&](const auto& one) {
      const bool counts_attempts = kind == LineKind::end && one.first == "attempt";
      return counts_attempts || !is_comparable(kind, one.first, exact);
    });
    row->fields.erase(end, row->fields.end());
    out.emplace_back(kind, std::move(*row));
  }
  return out;
}

/// Compares the texts of the record of a run, which had some attempts, and of the record of its repetition.
void compare_records(const std::string& recorded, const std::string& now, std::size_t attempts, bool exact,
                     std::vector<std::string>& differences) {
  const auto before = comparable_lines(recorded, attempts, exact);
  const auto after = comparable_lines(now, attempts, exact);
  if (before.size() != after.size())
    differences.push_back(fmt::format("{} lines, now {}", before.size(), after.size()));
  for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
    const auto& [kind, row] = before[i];
    const std::string place = kind == LineKind::tap ? "tap " + row.cell("tap") : fmt::format("line {}", i + 1);
    compare_rows(row, after[i].second, place, exact, differences);
  }
}

/// Replaces the backend by the simulator, because a replay does not need the backend, and its plugin may be missing on
/// this machine.
void replace_backend(Tree& config) {
  Tree simulator = Tree::map({{"type", Tree::scalar("simulator")}});
  simulator.set_layer(kCommandLineLayer);
  config.at("backend") = simulator;
  config.erase("motion");
}

/// Returns the config of the run in `directory`, which `build` made. `bundle`: folder of the bundle, in which the
/// programs are. Throws Error if the config does not fit the record; its identity is not checked without the backend.
ResolvedConfig config_of(const PluginHost& host, const fs::path& bundle, const fs::path& directory, bool has_backend,
                         const std::string& build) {
  Tree tree = read_run_config(directory);
  for_all(tree, [&](Tree& one) {
    Tree* folder = one.is_map() && one.find("command") != nullptr ? one.find("folder") : nullptr;
    if (folder != nullptr) folder->text = bundle.string() + folder->text;
  });
  if (!has_backend) replace_backend(tree);
  ResolvedConfig out = resolve_experiment(tree, host);
  const RunIdentity recorded = read_identity(directory);
  if (has_backend && (recorded.identity != out.identity || directory.filename() != out.id))
    throw Error("config.yaml",
                fmt::format("has the id {}, the record has {}", out.id, recorded.identity.substr(0, kIdLength)));
  if (recorded.name != out.options.name) throw Error("config.yaml", "has another name than the record");
  out.identity = recorded.identity;
  out.id = out.identity.substr(0, kIdLength);
  // A record has every option of the build that made it.
  Tree full = out.tree;
  for (const std::string& path : out.notes.files) full.at_path(path, {}).text = tree.find_path(path)->text;
  if (has_backend && build == build_hash(host, out.notes.plugins) &&
      portable_config(full, {}) != portable_config(tree, {}))
    throw Error("config.yaml", "lacks an option");
  return out;
}

/// Returns the first plugin of the manifest that this installation lacks: "kernel/own"; "" if there is none.
std::string missing_plugin(const PluginHost& host, const Tree& manifest) {
  const Tree* plugins = manifest.find("plugins");
  if (plugins == nullptr) return {};
  for (const Tree& one : plugins->items) {
    const Tree* kind = one.find("kind");
    const Tree* name = one.find("name");
    if (kind == nullptr || name == nullptr || kind->text == "backend") continue;
    if (!host.has(kind->text, name->text)) return kind->text + "/" + name->text;
  }
  return {};
}

void repeat(const RunEnvironment& environment, const ResolvedConfig& config, const RunRecord& recorded,
            const fs::path& scratch, bool exact, std::vector<std::string>& differences) {
  const fs::path directory = scratch / config.id;
  // A run that fails again has a record like one that ends.
  const std::optional<Error> trouble = catch_error([&] { start_run(environment, config, directory, {}); });
  if (trouble && !read_record_end(directory).end) throw Error(*trouble);
  const fs::path file = directory / kRecordFile;
  // Only the first line has paths.
  const std::string text = read_file(file);
  const std::size_t first = text.find('\n') + 1;
  compare_records(read_file(recorded.file), portable_record(text.substr(0, first), file) + text.substr(first),
                  recorded.attempts.size(), exact, differences);
  fs::remove_all(directory);
}

void check(const RunEnvironment& environment, const fs::path& bundle, const fs::path& directory,
           const fs::path& scratch, bool runs_programs, RunCheck& out) {
  const RunRecord record = read_run_record(directory);
  if (!record.manifest) throw Error(record.file.string(), "has no manifest");
  if (!record.end || record.end->how == Ending::EndKind::interrupted) throw Error(record.file.string(), "has no end");
  // Each attempt that was killed may have lost the times of one tap.
  if (record.timings.size() + std::max<std::size_t>(record.attempts.size(), 1) < record.taps.size() + 1)
    throw Error(record.file.string(), "lacks times of taps");
  if (!record.attempts.empty() && record.attempts.front().text("build") != record.build())
    throw Error(record.file.string(), "names two builds for its first attempt");
  const std::string plugin = missing_plugin(environment.host, *record.manifest);
  if (!plugin.empty()) {
    out.reason = "there is no plugin " + plugin;
    return;
  }
  const Tree config = read_run_config(directory);
  const Tree* backend = config.find_path("backend.type");
  const std::string maker = backend != nullptr ? backend->text : "";
  const bool has_backend = environment.host.has("backend", maker);
  ResolvedConfig resolved = config_of(environment.host, bundle, directory, has_backend, record.build());
  const Tree* instructions = record.manifest->find("instruction_path");
  out.same_build = record.build() == build_hash(environment.host, resolved.notes.plugins) && instructions != nullptr &&
                   instructions->text == math::name_of(instructions_in_use());
  const bool is_scored = resolved.notes.plugins.count({"acquisition", "program"}) > 0 && !runs_programs;
  // In a run from Python, the calling program may have scored the candidates.
  const std::vector<TapRecord> taps = read_taps(record.taps, record.file);
  const auto of_caller =
      std::count_if(taps.begin(), taps.end(), [](const TapRecord& tap) { return tap.is_of_caller(); });
  const auto initial = std::count_if(taps.begin(), taps.end(),
                                     [](const TapRecord& tap) { return tap.request.source == Source::initial; });
  const bool is_chosen = of_caller > 0;
  if (maker == "simulator" && !is_scored && !is_chosen) {
    out.kind = RunCheck::Kind::repeated;
    return repeat(environment, resolved, record, scratch, out.same_build, out.differences);
  }
  if (maker == "simulator" && is_chosen && of_caller + initial < static_cast<std::ptrdiff_t>(taps.size())) {
    out.reason = "a program chose some of its taps";
    return;
  }
  out.kind = RunCheck::Kind::replayed;
  out.reason = is_scored || is_chosen ? "a program chose its taps" : "its taps are of the backend " + maker;
  if (!has_backend) out.reason += ", which is not installed, so its config is not checked against its id";
  if (taps.empty()) return;
  const RecordedRun run = read_recorded_run(std::move(resolved), directory);
  for (const ReplayDifference& one : replay_run(environment, run).differences) {
    if (!differ(one.field, one.recorded, one.replayed, out.same_build)) continue;
    const std::string place = one.tap > 0 ? fmt::format("tap {}", one.tap) : "summary";
    out.differences.push_back(fmt::format("{}: {}: recorded {}, now {}", place, one.field, one.recorded, one.replayed));
  }
}

/// Throws Error unless the files of a run are exactly as a bundle has them.
void check_form(const fs::path& directory) {
  const fs::path config = directory / "config.yaml";
  if (portable_config(read_run_config(directory), recorded_origins(directory)) != read_file(config))
    throw Error(config.string(), "is not as 'palpate bundle' writes it");
  const fs::path record = directory / kRecordFile;
  const std::string text = read_file(record);
  if (portable_record(text, record) != text) throw Error(record.string(), "is not as 'palpate bundle' writes it");
}

}  // namespace

bool differ(const std::string& recorded, const std::string& now) {
  if (recorded == now) return false;
  const auto parts_of = [](const std::string& text) {
    std::vector<std::string> out;
    return boost::split(out, text, boost::is_any_of("[]{}, :"));
  };
  const std::vector<std::string> before = parts_of(recorded);
  const std::vector<std::string> after = parts_of(now);
  return !std::equal(before.begin(), before.end(), after.begin(), after.end(), are_close);
}

RunCheck check_run(const RunEnvironment& environment, const UnpackedBundle& bundle, const std::string& run,
                   const fs::path& scratch, bool runs_programs) {
  RunCheck out;
  const std::optional<Error> trouble = catch_error([&] {
    check_form(bundle.folder() / run);
    check(environment, bundle.folder(), bundle.folder() / run, scratch, runs_programs, out);
  });
  // The folder in which the bundle is unpacked says nothing to a reader.
  if (trouble)
    out.differences.push_back(
        boost::replace_all_copy(std::string(trouble->what()), bundle.folder().string() + "/", ""));
  return out;
}

BundleContent check_content(const UnpackedBundle& bundle, const BundleIndex& index) {
  BundleContent out;
  std::set<std::string> expected{"README.md"};
  const auto try_to = [&](const auto& work) {
    if (const std::optional<Error> trouble = catch_error(work)) out.differences.emplace_back(trouble->what());
  };
  const auto add_run = [&](const std::string& run) {
    out.runs.push_back(run);
    expected.insert({run + "/config.yaml", run + "/" + kRecordFile});
    try_to([&] {
      Tree config = read_run_config(bundle.folder() / run);
      for_all(config, [&](const Tree& one) {
        if (one.is_scalar() && one.text.rfind("files/", 0) == 0) expected.insert(one.text);
      });
    });
  };
  for (const std::string& record : index.records) {
    if (record.rfind("records/", 0) == 0) {
      add_run(record);
      continue;
    }
    try_to([&] {
      const Sweep sweep = read_sweep(bundle.folder() / record);
      for (const Job& job : sweep.jobs) add_run(record + "/jobs/" + job.id);
      const Tree config = read_run_config(sweep.directory);
      if (fmt::format("sweeps/{}/{}", slug(sweep_name(sweep)), sweep_id(config, sweep)) != record)
        throw Error(record, "has another name or id than its config");
      if (portable_sweep_config(config) != read_file(sweep.directory / "config.yaml"))
        throw Error(record + "/config.yaml", "is not as 'palpate bundle' writes it");
    });
    expected.insert({record + "/config.yaml", record + "/manifest.jsonl"});
  }
  for (const auto& [name, hash] : bundle.hashes()) {
    const bool is_result = name.rfind("results/", 0) == 0;  // compared with the output of its command
    if (!is_result && name.rfind("sources/", 0) != 0 && expected.count(name) == 0)
      out.differences.push_back(name + " does not belong to the bundle");
    if (name.rfind("files/", 0) == 0 && fs::path(name).stem().string() != hash)
      out.differences.push_back(name + " has another content than its name says");
  }
  return out;
}

}  // namespace palpate
