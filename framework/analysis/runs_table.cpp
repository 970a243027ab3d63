// SPDX-License-Identifier: MIT
#include "analysis/runs_table.hpp"

#include "analysis/groups.hpp"
#include "analysis/mean_output.hpp"
#include "analysis/table.hpp"
#include "launch/execute_jobs.hpp"
#include "record/catalogue.hpp"
#include "record/fields.hpp"
#include "record/files.hpp"
#include "record/record_reader.hpp"
#include "record/run.hpp"
#include "record/run_directory.hpp"
#include "sweep/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>
#include <unordered_set>

namespace palpate {
namespace {

namespace fs = std::filesystem;
using State = RunStatus::State;

constexpr const char* kIou = "footprint_iou";

/// Returns the different names if there are at most three, else their number and `noun`, such as "5 shapes".
std::string in_short(const std::vector<std::string>& names, const char* noun) {
  constexpr std::size_t kShown = 3;
  std::vector<std::string> out;
  for (const std::string& name : names) {
    if (!name.empty() && std::find(out.begin(), out.end(), name) == out.end()) out.push_back(name);
  }
  return out.size() <= kShown ? fmt::format("{}", fmt::join(out, ", ")) : fmt::format("{} {}", out.size(), noun);
}

using Origins = std::map<std::string, std::string>;

std::string first_of(const std::vector<std::string>& names) {
  const auto found = std::find_if(names.begin(), names.end(), [](const std::string& name) { return !name.empty(); });
  return found != names.end() ? *found : "";
}

std::string shapes_in(const Row& config) {
  std::vector<std::string> shapes;
  for (std::size_t i = 0;; ++i) {
    const std::string shape = config.text(fmt::format("scene.objects.{}.type", i));
    if (shape.empty()) return in_short(shapes, "shapes");
    shapes.push_back(shape);
  }
}

/// Returns the values of a swept key as text. Returns "" if the key is not swept.
std::string swept_at(const Sweep& sweep, const char* key) {
  const auto found = std::find(sweep.keys.begin(), sweep.keys.end(), key);
  if (found == sweep.keys.end()) return {};
  std::vector<std::string> values;
  for (const Job& job : sweep.jobs) values.push_back(job.values[static_cast<std::size_t>(found - sweep.keys.begin())]);
  return in_short(values, "values");
}

std::string strategy_of(const Origins& origins, const Row& config) {
  const char* const chosen = "acquisition.type";
  return first_of({recorded_group(origins, chosen, "strategy"), recorded_group(origins, chosen, "acquisition"),
                   config.text(chosen)});
}

std::string scene_of(const Origins& origins, const Row& config) {
  return first_of({recorded_group(origins, "scene.", "scene"), shapes_in(config)});
}

/// Returns the swept keys with their numbers of values: "seed (30), acquisition (2)".
std::string swept_words(const Sweep& sweep) {
  std::vector<std::string> out;
  for (const std::string& key : varying_keys(sweep, sweep.keys))
    out.push_back(fmt::format("{} ({})", key, group_jobs(sweep, {}, {key}).size()));
  return fmt::format("{}", fmt::join(out, ", "));
}

/// Returns whether the scores of a calling program chose any tap, instead of the acquisition in the config.
bool by_callers_scores(const fs::path& directory, const Row& config) {
  if (config.text("backend.type") != "caller") return false;
  const std::vector<Row> taps = read_run_record(directory).taps;
  return std::any_of(taps.begin(), taps.end(), [](const Row& tap) { return tap.text("source") == "caller"; });
}

/// Returns the text as a scalar; null for "".
Scalar text_or_null(const std::string& text) { return text.empty() ? Scalar() : Scalar(text); }

void add_run(ListedRecord& out, const fs::path& directory, const Row& config) {
  const Origins origins = recorded_origins(directory);
  out.config.groups = recorded_groups(origins);
  Row& row = out.row;
  row.add("name", text_or_null(config.text("name")));
  row.add("begun", text_or_null(begun_text(directory)));
  const std::string by_caller = by_callers_scores(directory, config) ? "scores of the caller" : "";
  row.add("strategy", text_or_null(first_of({config.text("backend.label"), by_caller, strategy_of(origins, config)})));
  row.add("scene", text_or_null(scene_of(origins, config)));
  const std::optional<Row> summary = read_summary(directory);
  // Taps are counted only for runs that have not ended; for others, the summary has the number.
  const RunStatus status = summary ? read_ending(directory) : read_status(directory);
  row.add("taps", summary ? summary->number("taps").value_or(0.0) : status.taps);
  const auto add_error = [&](const std::string& field) {
    row.add(field, summary ? summary->number(field) : std::nullopt);
  };
  add_error(main_error({}));
  if (summary && main_error({*summary}) != main_error({})) add_error(main_error({*summary}));
  add_error(kIou);
  row.add("state", state_name(status.state));
  if (summary) out.beside = *summary;
}

void add_sweep(ListedRecord& out, const fs::path& directory, const Row& config) {
  const Sweep sweep = read_sweep(directory);
  Row& row = out.row;
  row.add("name", text_or_null(sweep_name(sweep)));
  row.add("begun", text_or_null(begun_text(directory)));
  // Keys that are not swept have the same value in all jobs, so it suffices to read the first job.
  const fs::path first = job_directory(sweep, sweep.jobs.front());
  const Origins origins = recorded_origins(first);
  const Row job = is_there(first / "config.yaml") ? read_settings(first) : config;
  row.add("strategy", text_or_null(first_of({swept_at(sweep, "backend.label"), swept_at(sweep, "strategy"),
                                             swept_at(sweep, "acquisition"), strategy_of(origins, job)})));
  row.add("scene", text_or_null(first_of({swept_at(sweep, "scene"), scene_of(origins, job)})));
  out.swept = swept_words(sweep);
  JobStates now = read_job_states(sweep, all_jobs(sweep), JobCheck::running);
  row.add("jobs", static_cast<int>(sweep.jobs.size()));
  for (const State state : {State::done, State::failed, State::running})
    row.add(fmt::format("jobs_{}", state_name(state)), now.counts[state]);
}

/// Returns "done" or "7 of 8 jobs done, 1 failed".
std::string state_words(const Row& row) {
  if (row.find("jobs") == nullptr) return row.text("state");
  std::string out = fmt::format("{} of {} jobs done", row.cell("jobs_done"), row.cell("jobs"));
  for (const State state : {State::failed, State::running}) {
    const std::string count = row.cell(fmt::format("jobs_{}", state_name(state)));
    if (count != "0") out += fmt::format(", {} {}", count, state_name(state));
  }
  return out;
}

}  // namespace

ListedRecord list_record(const fs::path& directory) {
  ListedRecord out;
  const Row config = read_settings(directory);
  (is_sweep(directory) ? add_sweep : add_run)(out, directory, config);
  out.row.add("directory", directory.string());
  out.config.values = config;
  // A config may have a hundred thousand values, so names are looked up in a set.
  std::unordered_set<std::string> known;
  for (const auto& field : out.beside.fields) known.insert(field.first);
  for (const auto& field : config.fields) {
    if (known.insert(field.first).second) out.beside.fields.push_back(field);
  }
  return out;
}

std::vector<Row> rows_where(const std::vector<ListedRecord>& records, const WhereCondition& where) {
  std::vector<std::string> known;
  for (const ListedRecord& one : records) {
    for (const Row* part : {&one.row, &one.beside}) {
      for (const auto& field : part->fields) known.push_back(field.first);
    }
  }
  // The fields of the summary are valid names even for runs that have not ended.
  for (const RecordField& field : summary_fields()) known.push_back(field.name);
  std::sort(known.begin(), known.end());
  known.erase(std::unique(known.begin(), known.end()), known.end());
  std::vector<Row> out;
  for (const ListedRecord& one : records) {
    const WhereCondition::Values value_of = [&](const std::string& name) -> std::optional<WhereCondition::Value> {
      const Scalar* value = one.row.find(name);
      if (value == nullptr) value = one.beside.find(name);
      const bool is_result = find_summary_field(name) != nullptr;
      if (value != nullptr) return WhereCondition::Value{written_in(name, *value), is_result};
      if (!std::binary_search(known.begin(), known.end(), name)) return std::nullopt;
      return WhereCondition::Value{"", is_result};
    };
    if (where.holds(value_of, known)) out.push_back(one.row);
  }
  return out;
}

void add_differences(std::vector<ListedRecord>& records) {
  std::map<std::pair<std::string, bool>, std::vector<ListedRecord*>> named;
  for (ListedRecord& one : records) {
    const bool is_sweep = one.row.find("jobs") != nullptr;
    named[{one.row.text("name"), is_sweep}].push_back(&one);
  }
  for (const auto& [name, same] : named) {
    std::vector<RecordedSettings> configs;
    for (ListedRecord* const one : same) configs.push_back(std::move(one->config));
    const std::vector<std::vector<std::string>> settings = distinguishing_settings(configs);
    for (std::size_t i = 0; i < same.size(); ++i) {
      std::vector<std::string> words = settings[i];
      if (!same[i]->swept.empty()) words.insert(words.begin(), same[i]->swept);
      same[i]->row.add("apart", text_or_null(fmt::format("{}", fmt::join(words, ", "))));
    }
  }
}

std::string runs_table(const std::vector<Row>& rows) {
  if (rows.empty()) return {};
  std::vector<double> errors;
  std::set<std::string> metrics;  // There are two metrics if some runs tap from above and others from any side.
  for (const Row& row : rows) {
    const std::string metric = main_error({row});
    const std::optional<double> error = row.number(metric);
    if (!error) continue;
    errors.push_back(*error);
    metrics.insert(metric);
  }
  const std::string title = metrics.size() > 1 ? "RMS error" : main_error(rows);
  const DisplayScale scale = readable_scale(unit_of_column(main_error(rows)), errors);
  Table table;
  for (const Row& row : rows) {
    const auto show_text = [&](const char* heading, const char* field) {
      table.show(heading, one_line(row.text(field)), Table::Kind::text);
    };
    const std::optional<double> error = row.number(main_error({row}));
    const std::optional<double> outline = row.number(kIou);
    table.add_row();
    for (const char* const field : {"name", "begun", "strategy", "scene"}) show_text(field, field);
    table.show("taps", row.cell("taps"));
    table.show(scale.title(title), error ? scale.number(*error) : "");
    table.show("IoU", outline ? fmt::format("{:.2f}", *outline) : "");
    table.show("state", state_words(row), Table::Kind::text);
    show_text("set apart by", "apart");
    show_text("directory", "directory");
  }
  return table.text();
}

}  // namespace palpate
