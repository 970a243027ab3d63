// SPDX-License-Identifier: MIT
#include "sweep/pooled_sweep.hpp"

#include "experiment/experiment_options.hpp"
#include "reading/read_file.hpp"
#include "record/record_reader.hpp"
#include "record/run.hpp"
#include "sweep/pooled_settings.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace palpate {
namespace {

namespace fs = std::filesystem;

using PoolTexts = std::vector<std::string>;

constexpr const char* kName = "name";
constexpr const char* kSeed = "seed";
constexpr const char* kScene = "scene";

bool is_scene(const std::string& key) { return is_at_or_below(key, kScene); }

/// A record to combine: a sweep, or a run as a sweep of one job without keys.
struct PoolRecord {
  Sweep sweep;
  std::string name;
};

/// One job of the pooled sweep. `source` and `setting` are indices into PooledSweepBuilder::sources_ and
/// PooledSweepBuilder::settings_.
struct PooledJob {
  const Job* job = nullptr;
  std::size_t source = 0;
  std::size_t setting = 0;
};

PoolRecord read_source(const fs::path& directory) {
  if (is_sweep(directory)) {
    PoolRecord out{read_sweep(directory), {}};
    out.name = sweep_name(out.sweep);
    return out;
  }
  const std::optional<Tree> manifest = read_manifest(directory);
  const Tree* id = manifest ? manifest->find("id") : nullptr;
  const Tree* name = manifest ? manifest->find(kName) : nullptr;
  if (id == nullptr || name == nullptr)
    throw Error(directory.string(), "is neither a run nor a sweep", "it has no record of one");
  return {{directory, {}, {{0, id->text, {}, directory}}}, name->text};
}

/// Builds one sweep from several records.
class PooledSweepBuilder {
 public:
  PooledSweepBuilder(const std::vector<fs::path>& records, const PoolTexts& by) : by_(by) {
    for (const fs::path& one : records) sources_.push_back(read_source(one));
    collect_members();
    collect_keys();
    make_values();
    make_sweep(records);
  }

  PooledSweep take() { return std::move(out_); }

 private:
  void collect_members() {
    // index into members_ by record name ("" unless `by` contains `name`) and job id
    std::map<std::pair<std::string, std::string>, std::size_t> known;
    int repeated = 0;
    for (std::size_t source = 0; source < sources_.size(); ++source) {
      for (const Job& job : sources_[source].sweep.jobs) {
        const std::string record = is_one_of(by_, kName) ? sources_[source].name : "";
        const auto [at, is_new] = known.emplace(std::pair(record, job.id), members_.size());
        if (is_new) {
          members_.push_back({&job, source, setting_of(source, job)});
          continue;
        }
        ++repeated;
        PooledJob& first = members_[at->second];
        if (!has_ended(first.source, *first.job)) {
          if (has_ended(source, job)) first = {&job, source, setting_of(source, job)};
        } else if (has_ended(source, job)) {
          check_same_taps(job_directory(sources_[first.source].sweep, *first.job),
                          job_directory(sources_[source].sweep, job));
        }
      }
    }
    if (repeated > 0)
      out_.notes.push_back(fmt::format("{} of {} jobs are also in an earlier record and count once", repeated,
                                       members_.size() + static_cast<std::size_t>(repeated)));
  }

  /// Throws Error for two runs with the same id but different taps, which cannot count as one job.
  static void check_same_taps(const fs::path& first, const fs::path& second) {
    const auto taps = [](const fs::path& directory) {
      return read_bounded(directory / kTapsTable, kMostLogBytes, FileOrigin::record).text;
    };
    const std::string one = taps(first);
    const std::string other = taps(second);
    if (one.empty() || other.empty() || one == other) return;
    throw Error(second.string(), fmt::format("has the same id as {} but other taps", first.string()),
                "give each run its own seed or backend.label, or leave one out", Error::Kind::run);
  }

  bool has_ended(std::size_t source, const Job& job) const {
    return read_ending(job_directory(sources_[source].sweep, job)).end.has_value();
  }

  std::size_t setting_of(std::size_t source, const Job& job) {
    const Sweep& sweep = sources_[source].sweep;
    std::map<std::string, std::string> swept;
    for (std::size_t i = 0; i < sweep.keys.size(); ++i) {
      if (sweep.keys[i] != kSeed) swept.emplace(sweep.keys[i], job.values[i]);
    }
    const auto [at, is_new] = known_settings_.emplace(std::pair(source, swept), settings_.size());
    if (!is_new) return at->second;
    const fs::path directory = job_directory(sweep, job);
    settings_.push_back(
        {source, sources_[source].name, read_run_config(directory), recorded_origins(directory), std::move(swept)});
    return at->second;
  }

  void collect_keys() {
    const auto add = [&](const std::string& key) {
      if (!is_one_of(keys_, key) && key != kSeed) keys_.push_back(key);
    };
    for (const PoolRecord& one : sources_) {
      for (const std::string& key : one.sweep.keys) {
        if (decides_run(key)) add(key);
      }
    }
    for (const std::string& key : by_) {
      const auto has = [&](const PooledSetting& one) { return one.config.find_path(key) != nullptr; };
      if (std::any_of(settings_.begin(), settings_.end(), has)) add(key);
    }
    const PoolTexts others = further_differences(settings_, keys_);
    std::for_each(others.begin(), others.end(), add);
    if (!others.empty() && !is_one_of(by_, kName))
      out_.notes.push_back(fmt::format("besides the swept keys, the records differ in {}", fmt::join(others, ", ")));
    keys_.emplace_back(kSeed);
  }

  /// Computes the value of each setting at each key.
  void make_values() {
    values_.assign(settings_.size(), {});
    for (const std::string& key : keys_) {
      if (key == kSeed) continue;
      PoolTexts of_key = pooled_values(settings_, key, keys_);
      for (std::size_t i = 0; i < of_key.size(); ++i) values_[i].push_back(std::move(of_key[i]));
    }
    if (is_one_of(keys_, kStrategy)) {
      give_to(kStrategy, "strategies", [](const std::string& key) { return config_keys().is_of_strategy(key); });
    }
    if (is_one_of(by_, kName)) give_to(kName, "names", [](const std::string& key) { return !is_scene(key); });
  }

  /// Removes the keys that have only one value for each value of `owner`, because they are a part of `owner`. Keys in
  /// `by` and keys for which `may_belong` is false are kept.
  void give_to(const std::string& owner, const char* plural,
               const std::function<bool(const std::string&)>& may_belong) {
    const auto place = std::find(keys_.begin(), keys_.end(), owner) - keys_.begin();
    PoolTexts owners;
    for (const PoolTexts& values : values_) owners.push_back(values[static_cast<std::size_t>(place)]);
    PoolTexts given;
    for (std::size_t key = keys_.size() - 1; key-- > 0;) {  // the last key is the seed
      if (keys_[key] == owner || is_one_of(by_, keys_[key]) || !may_belong(keys_[key])) continue;
      std::map<std::string, std::string> of_owner;
      bool one_each = true;
      bool differs = false;
      for (std::size_t i = 0; i < values_.size(); ++i) {
        const std::string& value = values_[i][key];
        one_each = of_owner.emplace(owners[i], value).first->second == value && one_each;
        differs = differs || value != values_.front()[key];
      }
      if (!one_each) continue;
      if (differs) given.insert(given.begin(), keys_[key]);
      keys_.erase(keys_.begin() + static_cast<std::ptrdiff_t>(key));
      for (PoolTexts& values : values_) values.erase(values.begin() + static_cast<std::ptrdiff_t>(key));
    }
    if (!given.empty()) out_.notes.push_back(fmt::format("the {} differ in {}", plural, fmt::join(given, ", ")));
  }

  void make_sweep(const std::vector<fs::path>& records) {
    Sweep& sweep = out_.sweep;
    sweep.directory = common_folder(records);
    sweep.keys = keys_;
    PoolTexts names;
    for (const PoolRecord& one : sources_) {
      if (!is_one_of(names, one.name)) names.push_back(one.name);
    }
    sweep.name = fmt::format("{}", fmt::join(names, ", "));
    for (const PooledJob& one : members_) {
      const PoolRecord& source = sources_[one.source];
      Job job{static_cast<int>(sweep.jobs.size()), one.job->id, values_[one.setting],
              job_directory(source.sweep, *one.job)};
      job.values.push_back(seed_of(one));
      sweep.jobs.push_back(std::move(job));
    }
    note_scenes();
  }

  std::string seed_of(const PooledJob& member) const {
    const PoolTexts& keys = sources_[member.source].sweep.keys;
    const auto at = std::find(keys.begin(), keys.end(), kSeed);
    if (at != keys.end()) return member.job->values[static_cast<std::size_t>(at - keys.begin())];
    const Tree* seed = settings_[member.setting].config.find(kSeed);
    return seed != nullptr ? seed->text : std::string();
  }

  /// Adds a note for each scene that only some records contain, because the means of the records are then over
  /// different scenes.
  void note_scenes() {
    for (std::size_t key = 0; key < keys_.size(); ++key) {
      if (!is_scene(keys_[key])) continue;
      std::map<std::string, std::set<std::size_t>> having;
      std::set<std::size_t> all;
      for (const PooledJob& one : members_) {
        having[values_[one.setting][key]].insert(one.source);
        all.insert(one.source);
      }
      for (const auto& [value, sources] : having) {
        if (sources.size() == all.size()) continue;
        PoolTexts lacking;
        for (const std::size_t source : all) {
          if (sources.count(source) == 0 && !is_one_of(lacking, sources_[source].name))
            lacking.push_back(sources_[source].name);
        }
        out_.notes.push_back(fmt::format("{}={} is missing in {}: compare scene by scene, or exclude it with --where",
                                         keys_[key], value, fmt::join(lacking, ", ")));
      }
    }
  }

  const PoolTexts& by_;
  std::vector<PoolRecord> sources_;
  std::map<std::pair<std::size_t, std::map<std::string, std::string>>, std::size_t> known_settings_;
  std::vector<PooledSetting> settings_;
  std::vector<PooledJob> members_;
  PoolTexts keys_;                 ///< the last key is the seed
  std::vector<PoolTexts> values_;  ///< values of each setting, one per key except the seed
  PooledSweep out_;
};

}  // namespace

PooledSweep read_pooled(const std::vector<fs::path>& records, const PoolTexts& by) {
  if (records.empty()) throw Error("", "no sweep and no run is given", "name at least one");
  if (records.size() == 1 && is_sweep(records.front())) return {read_sweep(records.front()), {}};
  return PooledSweepBuilder(records, by).take();
}

fs::path common_folder(const std::vector<fs::path>& directories) {
  const auto parent = [](const fs::path& one) { return fs::weakly_canonical(one).parent_path(); };
  fs::path out = parent(directories.front());
  for (const fs::path& one : directories) {
    const fs::path other = parent(one);
    fs::path both;
    for (auto a = out.begin(), b = other.begin(); a != out.end() && b != other.end() && *a == *b; ++a, ++b) both /= *a;
    out = both;
  }
  return fs::proximate(out);
}

}  // namespace palpate
