// SPDX-License-Identifier: MIT
#include "tune/description.hpp"

#include "analysis/bootstrap.hpp"
#include "config/keys.hpp"
#include "config/quantity.hpp"
#include "record/fields.hpp"
#include "sweep/description.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

constexpr std::int64_t kMostJobs = 1'000'000;
constexpr std::int64_t kMostFresh = 100'000;
const std::vector<std::string> kNames{"keys", "metric", "cost", "jobs", "time", "within", "fresh", "over", "where"};

[[noreturn]] void refuse(const Tree& at, const std::string& reason, const std::string& hint) {
  throw Error(at.place.text(), "tune" + reason, hint);
}

/// Throws Error for a key whose values would change the meaning of the metric, or that the race itself sets.
void check_key(const std::string& key, const Tree& value, bool is_searched) {
  const std::string top = first_key(key);
  check_path(key, value.place.text());
  if (describes_many_runs(top) || top == "defaults" || top == "expect" || top == "log" || top == "name")
    refuse(value, fmt::format(": '{}' cannot be tuned", key), "name an option of the strategy");
  if (!is_searched) return;
  if (key == "seed")
    refuse(value, ": the seeds are chosen by 'palpate tune'", "give one value, for example seed=1000: the first seed");
  if (top == "scene")
    refuse(value, fmt::format(": '{}' changes the scene and with it the meaning of the metric", key),
           "tune over several scenes with --over block,ring");
}

/// Returns the value of an option of the command line as the config would have it.
Tree word_value(const std::string& name, const std::string& text) { return parse_override(name + "=" + text).value; }

/// Returns a text that equal quantities share, such as 1.7 cm and 17 mm.
std::string comparable_text(const std::string& text) {
  const auto quantity = any_quantity(text);
  return quantity ? fmt::format("{} {}", quantity->value, unit_symbol(quantity->unit)) : text;
}

std::int64_t read_count(const Tree& value, const char* name, std::int64_t least, std::int64_t most) {
  const std::int64_t count = read_integer(value, std::string("tune.") + name);
  if (count >= least && count <= most) return count;
  refuse(value, fmt::format(".{}: {} is out of range", name, count), fmt::format("it must be {} to {}", least, most));
}

/// Returns the field of the summary that the block names. Throws Error if there is none, or if neither less nor more of
/// it is better.
const RecordField& read_field(const Tree& block, const char* option) {
  const Tree& name = *block.find(option);
  const RecordField* field = find_summary_field(name.text);
  if (field != nullptr && field->better != RecordField::Better::neither) return *field;
  std::vector<std::string> known;
  for (const RecordField& one : summary_fields()) {
    if (one.better != RecordField::Better::neither) known.push_back(one.name);
  }
  refuse(name,
         field == nullptr ? fmt::format(".{}: no summary has a field '{}'", option, name.text)
                          : fmt::format(".{}: neither less nor more of '{}' is better", option, name.text),
         suggestion(name.text, known));
}

}  // namespace

std::optional<double> TunedKey::position(const std::string& text) const {
  if (range) {
    const auto quantity = any_quantity(text);
    const auto unit = any_quantity("1 " + range->unit);
    return quantity && unit && quantity->unit == unit->unit ? std::optional(quantity->value / unit->value)
                                                            : std::nullopt;
  }
  // A list may contain a type both with options and as a name, so the whole text is compared first.
  for (std::string (*text_of)(const Tree&) : {value_text, condition_text}) {
    const auto found = std::find_if(values.begin(), values.end(), [&](const Tree& one) {
      return comparable_text(text_of(one)) == comparable_text(text);
    });
    if (found != values.end()) return static_cast<double>(found - values.begin());
  }
  return std::nullopt;
}

TuneDescription::TuneDescription(const Tree* config, const TuneWords& words)
    : written(config != nullptr ? *config : Tree::map()) {
  if (!written.is_map()) refuse(written, ": expects a map", "write tune: {keys: {key: [values]}, metric: rmse_m}");
  for (const Tree::Entry& entry : written.entries) check_option(entry.key, entry.place, kNames, "tune");
  check_given_once(words.keys);
  ValueCount count;
  for (const std::string& word : words.keys) {
    const SweepAxis axis = parse_axis(word, count);
    if (written.find("keys") == nullptr) written.at("keys") = Tree::map();
    if (Tree& all = written.at("keys"); all.is_map()) all.at(axis.key) = axis.written;
  }
  for (const auto& [name, text] : words.settings) {
    written.at(name) = word_value(name, text);
    if (name == "jobs") written.erase("time");  // the command line replaces the kind of the budget, too
    if (name == "time") written.erase("jobs");
  }
  if (!words.scenes.empty()) {
    Tree list = Tree::list();
    for (const std::string& scene : words.scenes) list.items.push_back(word_value("over", scene));
    written.at("over") = list;
  }
  read_keys(count);
  read_metric();
  read_budget();
}

void TuneDescription::read_keys(ValueCount& count) {
  const Tree* all = written.find("keys");
  if (all == nullptr || !all->is_map() || all->entries.empty())
    refuse(all != nullptr ? *all : written, ".keys: expects a map of keys to lists or ranges",
           "give KEY=RANGE, for example \"kernel.length_scale=log_uniform(5mm,10cm)\"");
  for (const Tree::Entry& entry : all->entries) {
    if (const auto range = parse_continuous(entry.value, entry.key)) {
      check_key(entry.key, entry.value, true);
      keys.push_back({entry.key, {}, range, entry.value});
      continue;
    }
    std::vector<Tree> values = expand_values(entry.value, entry.key, count);
    check_key(entry.key, entry.value, values.size() > 1);
    if (values.size() > 1) {
      keys.push_back({entry.key, std::move(values), std::nullopt, entry.value});
    } else {
      fixed.push_back({entry.key, std::move(values), entry.value});
    }
  }
  if (keys.empty())
    refuse(*all, ".keys: no key has several values", "give a list or a range, for example acquisition=weighted,random");
  if (const Tree* over = written.find("over")) {
    if (over->kind != Tree::Kind::list || over->items.empty())
      refuse(*over, ".over: expects a list of scenes", "write over: [block, ring]");
    for (const SweepAxis& one : fixed) {
      if (one.key == "scene") refuse(*over, ": 'scene' is given as well as several scenes", "leave one of them out");
    }
    scenes = SweepAxis{"scene", over->items, *over};
  }
  const Tree* condition = written.find("where");
  if (condition == nullptr) return;
  const bool many = condition->kind == Tree::Kind::list;
  for (const Tree& one : many ? condition->items : std::vector<Tree>{*condition}) where.emplace_back(one);
}

void TuneDescription::read_metric() {
  if (written.find("metric") == nullptr)
    refuse(written, ": no metric is given", "add --metric rmse_m, or another field of the summary");
  const RecordField& field = read_field(written, "metric");
  metric = field.name;
  more_is_better = field.better == RecordField::Better::more;
  const Tree* bound = written.find("within");
  if (bound != nullptr) {
    within = read_quantity(*bound, "tune.within", unit_of_column(metric));
    if (!(within >= 0.0)) refuse(*bound, ".within: is negative", "write for example within: 0.5 mm");
  }
  const Tree* second = written.find("cost");
  if (second == nullptr) return;
  if (read_field(written, "cost").better == RecordField::Better::more || second->text == metric)
    refuse(*second, fmt::format(".cost: '{}' is not a cost", second->text), "name a field of which less is better");
  if (bound != nullptr) refuse(*bound, ".within: there is no best setting on a front", "leave out within or cost");
  cost = second->text;
}

void TuneDescription::read_budget() {
  const Tree* runs = written.find("jobs");
  const Tree* time = written.find("time");
  if ((runs == nullptr) == (time == nullptr))
    refuse(written, runs == nullptr ? ": no budget is given" : ": 'jobs' and 'time' exclude each other",
           "give one of them: --jobs 400 or --time 10min");
  if (runs != nullptr) jobs = static_cast<std::size_t>(read_count(*runs, "jobs", 1, kMostJobs));
  if (time != nullptr) {
    seconds = read_quantity(*time, "tune.time", Unit::second);
    if (!(*seconds > 0.0)) refuse(*time, ".time: is not above 0", "write for example time: 10 min");
  }
  if (const Tree* seeds = written.find("fresh")) {
    fresh = static_cast<std::size_t>(read_count(*seeds, "fresh", 0, kMostFresh));
    if (fresh > 0 && fresh < kLeastForInterval)
      refuse(*seeds, ".fresh: so few seeds have no interval",
             fmt::format("write 0, or at least {}", kLeastForInterval));
  }
}

std::vector<std::string> TuneDescription::job_keys() const {
  std::vector<std::string> out;
  if (scenes) out.push_back(scenes->key);
  for (const SweepAxis& one : fixed) {
    if (one.key != "seed") out.push_back(one.key);
  }
  for (const TunedKey& one : keys) out.push_back(one.key);
  out.emplace_back("seed");
  return out;
}

}  // namespace palpate
