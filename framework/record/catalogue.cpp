// SPDX-License-Identifier: MIT
#include "record/catalogue.hpp"

#include "config/catch_error.hpp"
#include "record/distinguishing_settings.hpp"
#include "record/files.hpp"
#include "record/record_reader.hpp"
#include "record/recorded_run.hpp"
#include "record/resolved_config.hpp"
#include "record/run_directory.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <array>
#include <ctime>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <unordered_set>
#include <utility>

#include <sys/stat.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr int kLevels = 3;
constexpr const char* kLatest = "@latest";

/// Returns whether a folder is a record. A damaged record counts, too, so that the command reports the damage.
bool is_record(const fs::path& folder) {
  constexpr std::array<const char*, 3> kParts{"config.yaml", "manifest.jsonl", kSummaryFile};
  return std::any_of(kParts.begin(), kParts.end(), [&](const char* part) { return is_there(folder / part); }) ||
         size_if_there((folder / kRecordFile).c_str()).value_or(0) > 0;
}

bool is_moved_aside(const fs::path& directory) {
  const std::string name = directory.filename().string();
  return begins_with_id(name) && name.compare(kIdLength, 5, ".old-") == 0;
}

/// Returns the start time in seconds and nanoseconds, so that runs started in the same second have an order.
std::pair<std::time_t, long> begun(const fs::path& directory) {
  struct stat what {};
  const bool known = ::stat((directory / "config.yaml").c_str(), &what) == 0;
  return known ? std::pair(what.st_mtim.tv_sec, what.st_mtim.tv_nsec) : std::pair(std::time_t{0}, 0L);
}

/// Adds the records in `folder` and in `levels` levels below it; returns whether there was a record.
bool collect_records(const fs::path& folder, int levels, Catalogue& out) {
  if (is_record(folder)) {
    // A run that was moved aside counts as a record only if the user gave its own path.
    const bool aside = levels < kLevels && is_moved_aside(folder);
    aside ? void(++out.moved_aside) : out.records.push_back(folder);
    return true;
  }
  bool any = false;
  std::error_code none;
  for (const fs::path& one : levels > 0 ? list_folder(folder) : std::vector<fs::path>()) {
    const bool hidden = one.filename().string().front() == '.';
    if (hidden || fs::symlink_status(one, none).type() != fs::file_type::directory) continue;
    any = collect_records(one, levels - 1, out) || any;
  }
  // A folder with a README.md, such as runs/reference of a clone, is not reported.
  if (!any && levels == kLevels - 1 && !is_there(folder / "README.md")) ++out.strangers;
  return any;
}

void add_values(const Tree& tree, const std::string& path, Row& out) {
  const std::string behind = path.empty() ? "" : path + ".";
  if (tree.is_scalar()) out.add(path, tree.text);
  for (const Tree::Entry& entry : tree.entries) add_values(entry.value, behind + entry.key, out);
  for (std::size_t i = 0; i < tree.items.size(); ++i) add_values(tree.items[i], behind + std::to_string(i), out);
}

/// Returns the settings for comparisons; none if the config is damaged.
Row known_settings(const fs::path& directory) {
  Row out;
  catch_error([&] { out = read_settings(directory); });
  return out;
}

/// Returns the Error for a name that several records have. The message lists the most recent records with the settings
/// that distinguish them, and the number of the remaining records.
Error several(const std::string& words, const std::string& base, std::vector<fs::path> records) {
  constexpr std::size_t kShown = 4;
  const std::size_t all = records.size();
  const auto sweeps = static_cast<std::size_t>(std::count_if(records.begin(), records.end(), is_sweep));
  const char* const noun = sweeps == all ? "sweeps" : sweeps == 0 ? "runs" : "runs and sweeps";
  std::reverse(records.begin(), records.end());
  records.resize(std::min(all, kShown));
  std::vector<RecordedSettings> configs;
  for (const fs::path& one : records) configs.push_back({known_settings(one), recorded_groups(recorded_origins(one))});
  const std::vector<std::vector<std::string>> settings = distinguishing_settings(configs);
  std::vector<std::string> shown;
  for (std::size_t i = 0; i < records.size(); ++i) {
    std::string apart = begun_text(records[i]);
    for (const std::string& one : settings[i]) apart += (apart.empty() ? "" : ", ") + one;
    shown.push_back(records[i].string() + (apart.empty() ? "" : " (" + apart + ")"));
  }
  if (all > kShown) shown.push_back(fmt::format("{} that were started earlier", all - kShown));
  return Error(words, fmt::format("matches {} {}: {}", all, noun, fmt::join(shown, "; ")),
               fmt::format("give the directory of one, or {}{} for the latest", base, kLatest));
}

/// Returns the Error for an unknown name, with similar names as its hint.
Error unknown(const std::string& words, const std::string& name, const fs::path& runs) {
  std::vector<std::string> known;
  for (const fs::path& one : list_folder(runs)) known.push_back(one.filename().string());
  const std::string near = nearest(name, known);
  const bool misspelt = name.find('@') != std::string::npos;
  return Error(words, fmt::format("is not a folder, and {} contains no run or sweep of that name", runs.string()),
               misspelt        ? fmt::format("only {} may follow a name", kLatest)
               : !near.empty() ? fmt::format("did you mean '{}'?", near)
                               : "run 'palpate list' to see all runs and sweeps");
}

/// The records that match the user's words.
struct NamedRecords {
  std::string base;  ///< the words, without @latest
  bool latest = false;
  std::vector<fs::path> records;  ///< in the order of their start; empty for a path without a record
};

/// Returns the records that match `words`. Throws Error for an unknown name.
NamedRecords find_named(const std::string& words, RecordKind wanted, const fs::path& runs) {
  NamedRecords out;
  out.latest = !is_there(words) && boost::ends_with(words, kLatest);
  out.base = out.latest ? words.substr(0, words.size() - std::string_view(kLatest).size()) : words;
  const std::string& base = out.base;
  std::vector<fs::path>& records = out.records;
  const bool is_path = is_there(base);
  if (is_path && is_record(base)) return records = {base}, out;
  const bool is_word = base.find('/') == std::string::npos;
  const bool is_slug = base.find('~') != std::string::npos && is_word && is_there(runs / base);
  const fs::path named = is_slug ? runs / base : runs / slug(base);
  records = read_catalogue(is_path ? fs::path(base) : named).records;
  // A folder without records may have the same name as a run, so the runs of this name are searched, too.
  if (is_path && is_word && records.empty()) records = read_catalogue(named).records;
  if (records.empty()) {
    if (is_path || !is_word) return out;
    throw unknown(words, base, runs);
  }
  const auto fits = [&](const fs::path& one) { return is_sweep(one) == (wanted == RecordKind::sweep); };
  if (wanted != RecordKind::any && std::any_of(records.begin(), records.end(), fits))
    records.erase(std::stable_partition(records.begin(), records.end(), fits), records.end());
  return out;
}

/// Returns the only record. If there are several, returns the most recent one if `words` end in @latest, and else
/// throws Error. If there is none, returns the path unchanged.
fs::path only_one(const std::string& words, const NamedRecords& meant) {
  if (meant.records.empty()) return meant.base;
  if (meant.records.size() > 1 && !meant.latest) throw several(words, meant.base, meant.records);
  return meant.records.back();
}

}  // namespace

std::vector<std::string> differing_keys(const std::vector<Row>& configs) {
  // A config from another user may have 100,000 values, so the values are looked up in hash maps.
  std::vector<std::unordered_map<std::string_view, const Scalar*>> values(configs.size());
  for (std::size_t i = 0; i < configs.size(); ++i) {
    for (const auto& [key, value] : configs[i].fields) values[i].emplace(key, &value);
  }
  std::vector<std::string> out;
  std::unordered_set<std::string_view> seen;
  for (const Row& config : configs) {
    for (const auto& [key, value] : config.fields) {
      // `complete`, the version of the format, is not a setting; configs of sweeps do not have it.
      if (key == "complete" || !seen.insert(key).second) continue;
      const auto same = [&, at = &key, there = &value](const auto& other) {
        const auto found = other.find(*at);
        return found != other.end() && *found->second == *there;
      };
      if (!std::all_of(values.begin(), values.end(), same)) out.push_back(key);
    }
  }
  std::stable_partition(out.begin(), out.end(), [](const std::string& key) { return key == "seed"; });
  return out;
}

Catalogue read_catalogue(const fs::path& folder) {
  Catalogue out;
  collect_records(folder, kLevels, out);
  std::sort(out.records.begin(), out.records.end(),
            [](const fs::path& a, const fs::path& b) { return std::tuple(begun(a), a) < std::tuple(begun(b), b); });
  return out;
}

std::string begun_text(const fs::path& directory) {
  const std::time_t seconds = begun(directory).first;
  std::tm local{};
  std::array<char, 32> text{};
  if (seconds == 0 || ::localtime_r(&seconds, &local) == nullptr) return {};
  return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &local)};
}

Row settings_of(const Tree& config) {
  Row out;
  add_values(config, "", out);
  return out;
}

Row read_settings(const fs::path& directory) { return settings_of(read_run_config(directory)); }

fs::path find_record(const std::string& words, RecordKind wanted, const fs::path& runs) {
  return only_one(words, find_named(words, wanted, runs));
}

std::vector<fs::path> find_records(const std::vector<std::string>& words, const fs::path& runs) {
  std::vector<fs::path> out;
  for (const std::string& one : words) {
    // A pattern such as runs/NAME/* also matches tables and figures next to the records.
    std::error_code none;
    if (words.size() > 1 && one.find('/') != std::string::npos && fs::is_regular_file(one, none)) continue;
    const NamedRecords meant = find_named(one, RecordKind::sweep, runs);
    const bool all = !meant.latest && std::none_of(meant.records.begin(), meant.records.end(), is_sweep);
    if (all) out.insert(out.end(), meant.records.begin(), meant.records.end());
    if (!all || meant.records.empty()) out.push_back(only_one(one, meant));
  }
  if (out.empty())
    throw Error("command line", "no sweep and no run is given", "run 'palpate list' to see all runs and sweeps");
  return out;
}

}  // namespace palpate
