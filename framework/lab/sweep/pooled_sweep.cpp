// SPDX-License-Identifier: MIT
#include "sweep/pooled_sweep.hpp"

#include "experiment/experiment_options.hpp"
#include "reading/reading.hpp"
#include "record/catalogue.hpp"
#include "record/record_reader.hpp"
#include "record/resolved.hpp"
#include "record/session.hpp"
#include "sweep/description.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
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

bool contains(const PoolTexts& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

bool is_scene(const std::string& key) { return is_at_or_below(key, kScene); }

/// Whether an option may change what a run computes. A folder is where a program begins.
bool decides(const std::string& path) {
  static const std::set<std::string> kNeutral{kName, "log", "expect", "complete", "sweep"};
  return kNeutral.count(first_key(path)) == 0 && last_key(path) != "folder" && path != kThreads;
}

/// A sweep or a run, which is a sweep of one job without keys.
struct PoolRecord {
  Sweep sweep;
  std::string name;
};

/// Jobs of a source that differ in nothing but the seed: one config tells of all.
struct PoolSetting {
  std::size_t source = 0;
  Tree config;
  std::map<std::string, std::string> origins;  ///< see recorded_origins()
  std::map<std::string, std::string> swept;    ///< their values of the source's keys
};

/// A job that is not among those before it.
struct PoolMember {
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

/// The values that are equal and have one name, found by what connects them.
class ValueClasses {
 public:
  /// Connects two marks of the same value.
  void connect(const std::string& a, const std::string& b) { parents_[find(a)] = find(b); }
  std::string find(const std::string& mark) {
    const auto [at, is_new] = parents_.emplace(mark, mark);
    return is_new || at->second == mark ? mark : at->second = find(at->second);
  }

 private:
  std::map<std::string, std::string> parents_;
};

/// The part of a config at `key`, without what other keys say; "" where there is none.
std::string identity_at(const Tree& config, const std::string& key, const PoolTexts& keys) {
  const Tree* found = config.find_path(key);
  if (found == nullptr) return {};
  Tree part = *found;
  for (const std::string& other : keys) {
    if (other != key && is_at_or_below(other, key)) part.erase_path(other.substr(key.size() + 1));
  }
  return part.canonical();
}

/// The words for a value that no sweep has written: the name of its group, else of a plugin its type, of a scene those
/// of its objects.
std::string words_at(const PoolSetting& setting, const std::string& key) {
  const Tree* found = setting.config.find_path(key);
  if (found == nullptr) return {};
  const std::string path = key + (found->find("type") != nullptr ? ".type" : ".");
  std::string group = found->is_map() ? recorded_group(setting.origins, path, last_key(key)) : std::string();
  if (!group.empty()) return group;
  if (found->is_map() && found->entries.empty()) return "none";
  const Tree* objects = key == kScene ? found->find("objects") : nullptr;
  if (objects == nullptr) return condition_text(*found);
  PoolTexts types;
  for (const Tree& object : objects->items) {
    if (const Tree* type = object.find("type")) types.push_back(type->text);
  }
  return types.empty() ? "desk" : fmt::format("{}", fmt::join(types, "+"));
}

/// Makes one sweep of several sources.
class Pool {
 public:
  Pool(const std::vector<fs::path>& records, const PoolTexts& by) : by_(by) {
    for (const fs::path& one : records) sources_.push_back(read_source(one));
    collect_members();
    collect_keys();
    make_values();
    make_sweep(records);
  }

  PooledSweep take() { return std::move(out_); }

 private:
  void collect_members() {
    std::map<std::pair<std::string, std::string>, std::size_t> known;  // by record, if these are groups, and id
    int repeated = 0;
    for (std::size_t source = 0; source < sources_.size(); ++source) {
      for (const Job& job : sources_[source].sweep.jobs) {
        const std::string record = contains(by_, kName) ? sources_[source].name : "";
        const auto [at, is_new] = known.emplace(std::pair(record, job.id), members_.size());
        if (is_new) {
          members_.push_back({&job, source, setting_of(source, job)});
          continue;
        }
        ++repeated;
        PoolMember& first = members_[at->second];
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

  /// Throws Error for two runs with the same id that measured something else: neither stands for the other.
  static void check_same_taps(const fs::path& first, const fs::path& second) {
    const auto taps = [](const fs::path& directory) {
      return read_bounded(directory / kTapsTable, kMostLogBytes, Origin::record).text;
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
    settings_.push_back({source, read_run_config(directory), recorded_origins(directory), std::move(swept)});
    return at->second;
  }

  void collect_keys() {
    const auto add = [&](const std::string& key) {
      if (!contains(keys_, key) && key != kSeed) keys_.push_back(key);
    };
    for (const PoolRecord& one : sources_) {
      for (const std::string& key : one.sweep.keys) {
        if (decides(key)) add(key);
      }
    }
    for (const std::string& key : by_) {
      const auto has = [&](const PoolSetting& one) { return one.config.find_path(key) != nullptr; };
      if (std::any_of(settings_.begin(), settings_.end(), has)) add(key);
    }
    const PoolTexts others = other_differences();
    std::for_each(others.begin(), others.end(), add);
    if (!others.empty() && !contains(by_, kName))
      out_.notes.push_back(fmt::format("besides the swept keys, the records differ in {}", fmt::join(others, ", ")));
    keys_.emplace_back(kSeed);
  }

  /// The options in which the configs differ though no key says so, those of a plugin of another type as one.
  PoolTexts other_differences() const {
    std::vector<Row> configs;
    for (const PoolSetting& one : settings_) configs.push_back(settings_of(one.config));
    const PoolTexts paths = differing_keys(configs);
    PoolTexts out;
    for (const std::string& path : paths) {
      if (path == kSeed || !decides(path) || is_said(path, keys_, configs)) continue;
      std::string whole = enclosing_choice(path, paths);
      if (!is_said(whole, out, configs) && !is_said(path, out, configs)) out.push_back(std::move(whole));
    }
    const PoolTexts all = out;
    const auto is_below = [&](const std::string& path) {
      return std::any_of(all.begin(), all.end(),
                         [&](const std::string& other) { return path != other && is_at_or_below(path, other); });
    };
    out.erase(std::remove_if(out.begin(), out.end(), is_below), out.end());
    return out;
  }

  /// Whether one of `keys` decides the option at `path`: one above it, that of which it takes its value over, a
  /// strategy, or a choice beside it that brings it along.
  static bool is_said(const std::string& path, const PoolTexts& keys, const std::vector<Row>& configs) {
    return std::any_of(keys.begin(), keys.end(), [&](const std::string& key) {
      if (is_at_or_below(path, key) || contains(config_keys().heirs_of(key), path)) return true;
      if (key == kStrategy) return config_keys().is_of_strategy(path);
      const auto dot = path.rfind('.');
      const bool beside = dot != std::string::npos && key.rfind('.') == dot && key.compare(0, dot, path, 0, dot) == 0;
      const auto lacks = [&](const Row& one) { return one.find(path) == nullptr; };
      return beside && std::any_of(configs.begin(), configs.end(), lacks);
    });
  }

  /// The topmost group above `path` whose type is among the `differing` options, or the nearest one above a list;
  /// `path` itself where there is none.
  static std::string enclosing_choice(const std::string& path, const PoolTexts& differing) {
    std::string group;
    for (auto dot = path.find('.'); dot != std::string::npos; dot = path.find('.', dot + 1)) {
      std::string part = path.substr(0, dot);
      if (config_keys().is_group(part)) group = part;
      if (group == part && contains(differing, part + ".type")) return part;
      if (std::isdigit(static_cast<unsigned char>(path[dot + 1])) != 0) return group.empty() ? part : group;
    }
    return path;
  }

  /// The text of each setting at each key.
  void make_values() {
    values_.assign(settings_.size(), {});
    for (const std::string& key : keys_) {
      if (key != kSeed) make_values(key);
    }
    if (contains(keys_, kStrategy)) {
      give_to(kStrategy, "strategies", [](const std::string& key) { return config_keys().is_of_strategy(key); });
    }
    if (contains(by_, kName)) give_to(kName, "names", [](const std::string& key) { return !is_scene(key); });
  }

  /// Takes away those of the keys that may belong to `owner` which have one value for each of its values and are not
  /// asked for: they are a part of it.
  void give_to(const std::string& owner, const char* plural,
               const std::function<bool(const std::string&)>& may_belong) {
    const auto place = std::find(keys_.begin(), keys_.end(), owner) - keys_.begin();
    PoolTexts owners;
    for (const PoolTexts& values : values_) owners.push_back(values[static_cast<std::size_t>(place)]);
    PoolTexts given;
    for (std::size_t key = keys_.size() - 1; key-- > 0;) {  // the last is the seed
      if (keys_[key] == owner || contains(by_, keys_[key]) || !may_belong(keys_[key])) continue;
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

  void make_values(const std::string& key) {
    const bool in_configs = std::any_of(settings_.begin(), settings_.end(),
                                        [&](const PoolSetting& one) { return one.config.find_path(key) != nullptr; });
    ValueClasses classes;
    std::vector<std::pair<std::string, std::string>> marks;  // of each setting a mark and words
    std::map<std::string, std::string> names;                // of a class, from its mark
    for (const PoolSetting& one : settings_) {
      const auto swept = one.swept.find(key);
      const bool is_swept = swept != one.swept.end();
      std::string words = is_swept ? swept->second : in_configs ? words_at(one, key) : sources_[one.source].name;
      const std::string identity = "=" + identity_at(one.config, key, keys_);
      const std::string written = is_swept ? fmt::format("{} {}", one.source, words) : identity;
      if (!in_configs) {
        marks.emplace_back(words, words);
        continue;
      }
      classes.connect(written, identity);
      marks.emplace_back(written, std::move(words));
    }
    // What a sweep has written comes before what is read from a config.
    for (const bool swept : {true, false}) {
      for (std::size_t i = 0; i < settings_.size(); ++i) {
        if ((settings_[i].swept.count(key) > 0) != swept) continue;
        name_class(classes.find(marks[i].first), marks[i].second, sources_[settings_[i].source].name, names);
      }
    }
    for (std::size_t i = 0; i < settings_.size(); ++i) values_[i].push_back(names.at(classes.find(marks[i].first)));
  }

  /// Gives a class of values its name, unless it has one: `words`, or where another class has these, more.
  static void name_class(const std::string& mark, const std::string& words, const std::string& record,
                         std::map<std::string, std::string>& names) {
    if (names.count(mark) > 0) return;
    const auto taken = [&](const std::string& name) {
      return std::any_of(names.begin(), names.end(), [&](const auto& one) { return one.second == name; });
    };
    std::string name = words;
    if (taken(name)) name = fmt::format("{} ({})", words, record);
    for (int n = 2; taken(name); ++n) name = fmt::format("{} ({} {})", words, record, n);
    names.emplace(mark, std::move(name));
  }

  void make_sweep(const std::vector<fs::path>& records) {
    Sweep& sweep = out_.sweep;
    sweep.directory = common_folder(records);
    sweep.keys = keys_;
    PoolTexts names;
    for (const PoolRecord& one : sources_) {
      if (!contains(names, one.name)) names.push_back(one.name);
    }
    sweep.name = fmt::format("{}", fmt::join(names, ", "));
    for (const PoolMember& one : members_) {
      const PoolRecord& source = sources_[one.source];
      Job job{static_cast<int>(sweep.jobs.size()), one.job->id, values_[one.setting],
              job_directory(source.sweep, *one.job)};
      job.values.push_back(seed_of(one));
      sweep.jobs.push_back(std::move(job));
    }
    note_scenes();
  }

  std::string seed_of(const PoolMember& member) const {
    const PoolTexts& keys = sources_[member.source].sweep.keys;
    const auto at = std::find(keys.begin(), keys.end(), kSeed);
    if (at != keys.end()) return member.job->values[static_cast<std::size_t>(at - keys.begin())];
    const Tree* seed = settings_[member.setting].config.find(kSeed);
    return seed != nullptr ? seed->text : std::string();
  }

  /// Says which records lack a scene that others have: their means are over other scenes.
  void note_scenes() {
    for (std::size_t key = 0; key < keys_.size(); ++key) {
      if (!is_scene(keys_[key])) continue;
      std::map<std::string, std::set<std::size_t>> having;
      std::set<std::size_t> all;
      for (const PoolMember& one : members_) {
        having[values_[one.setting][key]].insert(one.source);
        all.insert(one.source);
      }
      for (const auto& [value, sources] : having) {
        if (sources.size() == all.size()) continue;
        PoolTexts lacking;
        for (const std::size_t source : all) {
          if (sources.count(source) == 0 && !contains(lacking, sources_[source].name))
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
  std::vector<PoolSetting> settings_;
  std::vector<PoolMember> members_;
  PoolTexts keys_;                 ///< the seed last
  std::vector<PoolTexts> values_;  ///< of each setting, one for each key but the seed
  PooledSweep out_;
};

}  // namespace

PooledSweep read_pooled(const std::vector<fs::path>& records, const PoolTexts& by) {
  if (records.empty()) throw Error("", "no sweep and no run is given", "name at least one");
  if (records.size() == 1 && is_sweep(records.front())) return {read_sweep(records.front()), {}};
  return Pool(records, by).take();
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
