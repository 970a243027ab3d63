// SPDX-License-Identifier: MIT
#include "record/tap_row.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <array>

namespace palpate {
namespace {

constexpr std::array<const char*, 3> kSources{"initial", "acquisition", "fallback"};
constexpr std::array<const char*, 6> kOutcomes{"contact", "no_contact", "unreachable", "timeout", "aborted", "unknown"};

void add_head(Row& row, const TapRecord& tap) {
  row.add("tap", tap.number);
  row.add("source", source_name(tap.source));
  row.add("why", tap.why.empty() ? std::nullopt : std::optional<std::string>(tap.why));
  row.add("x", tap.target.x);
  row.add("y", tap.target.y);
}

void add_contact(Row& row, const Contact& contact, const std::optional<bool>& on_surface) {
  const bool touched = contact.outcome == Outcome::contact;
  row.add("outcome", outcome_name(contact.outcome));
  row.add("reason", contact.reason.empty() ? std::nullopt : std::optional<std::string>(contact.reason));
  row.add("on_surface", on_surface);
  row.add("height", touched ? std::optional<double>(contact.height) : std::nullopt);
  row.add("force", touched ? std::optional<double>(contact.force) : std::nullopt);
  row.add("robot_seconds", contact.seconds);
}

void add_state(Row& row, const TapRecord& tap) {
  row.add("score", tap.score);
  row.add("u", tap.uncertainty);
  row.add("w", tap.weight);
  row.add("e", tap.exploration);
  if (tap.footprint) row.add("p", tap.probability);
  row.add("ties", tap.ties);
  row.add("runner_up.x", tap.runner_up ? std::optional<double>(tap.runner_up->x) : std::nullopt);
  row.add("runner_up.y", tap.runner_up ? std::optional<double>(tap.runner_up->y) : std::nullopt);
  row.add("runner_up.score", tap.runner_up_score);
  row.add("max_standard_deviation", tap.max_standard_deviation);
  row.add("mean_standard_deviation", tap.mean_standard_deviation);
  row.add("min_weight", tap.min_weight);
  row.add("max_weight", tap.max_weight);
  if (tap.predicted) {
    row.add("predicted.height", tap.predicted->height);
    row.add("predicted.standard_deviation", tap.predicted->standard_deviation);
  }
  add_process(row, "height_process", tap.height_process);
  add_process(row, "weight_process", tap.weight_process);
  if (tap.surface_process) add_process(row, "surface_process", tap.surface_process);
  add_footprint(row, tap.footprint);
  add_forecast(row, tap.forecast);
  row.add("true_on_surface", tap.true_on_surface);
  row.add("rmse_m", tap.errors.rmse);
  row.add("rmse_on_surface_m", tap.errors.rmse_on_surface);
  row.add("rmse_height_m", tap.errors.rmse_height);
  row.add("footprint_iou", tap.errors.footprint_iou);
}

/// A number that may have been written without a point.
double number_at(const Row& row, const char* name, double absent, const std::string& where) {
  const Scalar* value = row.find(name);
  if (value != nullptr) {
    if (const auto* real = std::get_if<double>(value)) return *real;
    if (const auto* whole = std::get_if<std::int64_t>(value)) return static_cast<double>(*whole);
    if (std::holds_alternative<std::monostate>(*value)) return absent;
  }
  throw Error(where, std::string("has no number '") + name + "'", "the file is damaged");
}

template <std::size_t N>
std::size_t name_at(const Row& row, const char* field, const std::array<const char*, N>& names,
                    const std::string& where) {
  const Scalar* value = row.find(field);
  const auto* text = value != nullptr ? std::get_if<std::string>(value) : nullptr;
  const auto found =
      std::find_if(names.begin(), names.end(), [&](const char* one) { return text != nullptr && *text == one; });
  if (found == names.end()) throw Error(where, std::string("has no valid '") + field + "'", "the file is damaged");
  return static_cast<std::size_t>(found - names.begin());
}

}  // namespace

void add_process(Row& row, const std::string& name, const std::optional<ProcessState>& state) {
  if (state) {
    for (const KernelParameter& one : state->kernel) row.add(name + ".kernel." + one.name, one.value);
  }
  const auto add = [&](const char* field, auto get) {
    row.add(name + "." + field, state ? std::optional<double>(get(*state)) : std::nullopt);
  };
  add("signal", [](const ProcessState& s) { return s.settings.signal; });
  add("noise", [](const ProcessState& s) { return s.settings.noise; });
  add("mean", [](const ProcessState& s) { return s.settings.mean; });
  add("log_marginal_likelihood", [](const ProcessState& s) { return s.log_marginal_likelihood; });
  add("jitter", [](const ProcessState& s) { return s.jitter; });
  add("condition", [](const ProcessState& s) { return s.condition; });
  row.add(name + ".engine", state ? std::optional<std::string>(state->engine) : std::nullopt);
  add("error_bound", [](const ProcessState& s) { return s.error_bound; });
  if (state && state->fit) {
    row.add(name + ".fit.changed", state->fit->changed);
    row.add(name + ".fit.objective", state->fit->objective);
    row.add(name + ".fit.evaluations", state->fit->evaluations);
    row.add(name + ".fit.reason", state->fit->reason);
  }
}

void add_footprint(Row& row, const std::optional<FootprintState>& state) {
  if (!state) return;
  for (const FootprintNumber& one : state->numbers) row.add("footprint." + one.name, one.value);
  row.add("footprint.remark", state->remark.empty() ? std::nullopt : std::optional(state->remark));
}

void add_forecast(Row& row, const std::optional<Forecast>& forecast) {
  if (forecast) row.add("expected_rmse_m", forecast->rmse);
}

const char* outcome_name(Outcome outcome) { return kOutcomes[static_cast<std::size_t>(outcome)]; }

const char* source_name(Source source) { return kSources[static_cast<std::size_t>(source)]; }

Row tap_row(const TapRecord& tap) {
  Row row;
  add_head(row, tap);
  add_contact(row, tap.contact, tap.on_surface);
  add_state(row, tap);
  return row;
}

Row intent_row(const TapRecord& tap) {
  TapRecord before = tap;
  before.contact = {};
  before.on_surface.reset();
  Row row = tap_row(before);
  row.fields.insert(row.fields.begin() + 1, {"intent", true});
  return row;
}

bool is_intent(const Row& row) { return row.find("intent") != nullptr; }

Row unknown_result_of(const Row& intent) {
  Row row = intent;
  row.fields.erase(
      std::remove_if(row.fields.begin(), row.fields.end(), [](const auto& field) { return field.first == "intent"; }),
      row.fields.end());
  for (auto& [name, value] : row.fields) {
    if (name == "reason") value = std::string("the program ended during this tap");
  }
  return row;
}

PastTap past_tap(const Row& row, const std::string& where) {
  PastTap out;
  out.source = static_cast<Source>(name_at(row, "source", kSources, where));
  out.target = {number_at(row, "x", 0.0, where), number_at(row, "y", 0.0, where)};
  out.contact.outcome = static_cast<Outcome>(name_at(row, "outcome", kOutcomes, where));
  out.contact.height = number_at(row, "height", 0.0, where);
  out.contact.force = number_at(row, "force", 0.0, where);
  out.contact.seconds = number_at(row, "robot_seconds", 0.0, where);
  if (const Scalar* reason = row.find("reason")) {
    if (const auto* text = std::get_if<std::string>(reason)) out.contact.reason = *text;
  }
  return out;
}

}  // namespace palpate
