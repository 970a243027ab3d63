// SPDX-License-Identifier: MIT
#include "record/tap_row.hpp"

#include "record/fields.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace palpate {
namespace {

constexpr std::array<const char*, 4> kSources{"initial", "acquisition", "fallback", "caller"};
constexpr std::array<const char*, 6> kOutcomes{"contact", "no_contact", "unreachable", "timeout", "aborted", "unknown"};

/// A number that may have been written without a point.
double number_at(const Row& row, const char* name, double absent, const std::string& where) {
  if (const std::optional<double> value = row.number(name); value && !row.flag(name)) return *value;
  if (const Scalar* value = row.find(name); value != nullptr && *value == Scalar()) return absent;
  throw Error(where, std::string("has no number '") + name + "'", "the file is damaged");
}

template <std::size_t N>
std::size_t name_at(const Row& row, const char* field, const std::array<const char*, N>& names,
                    const std::string& where) {
  const auto found = std::find(names.begin(), names.end(), row.text(field));
  if (found == names.end()) throw Error(where, std::string("has no valid '") + field + "'", "the file is damaged");
  return static_cast<std::size_t>(found - names.begin());
}

PastTap past_tap(const Row& row, const std::string& where) {
  PastTap out;
  out.source = static_cast<Source>(name_at(row, "source", kSources, where));
  out.target = {number_at(row, "x", 0.0, where), number_at(row, "y", 0.0, where)};
  out.contact.outcome = static_cast<Outcome>(name_at(row, "outcome", kOutcomes, where));
  out.contact.height = number_at(row, "height", 0.0, where);
  out.contact.force = number_at(row, "force", 0.0, where);
  out.contact.seconds = number_at(row, "robot_seconds", 0.0, where);
  out.contact.reason = row.text("reason");
  out.contact.peak = row.number("peak_force");
  if (const std::optional<double> z = row.number("z")) {
    const auto number = [&](const char* name) { return number_at(row, name, 0.0, where); };
    out.approach = Approach{
        {{out.target.x, out.target.y, *z}, {number("direction.x"), number("direction.y"), number("direction.z")}},
        number("length")};
    out.contact.along = row.number("along");
    if (out.contact.outcome == Outcome::contact && !out.contact.along)
      throw Error(where, "has no number 'along', how far the tool went to its contact", "the file is damaged");
  }
  out.why = row.text("why");
  out.unreached = row.text("unreached");
  if (out.unreached.find_first_not_of("0123456789abcdef") != std::string::npos)
    throw Error(where, "has no valid 'unreached'", "the file is damaged");
  out.motion = static_cast<int>(row.number("motion").value_or(0.0));
  if (const std::optional<double> height = row.number("predicted.height")) {
    out.predicted = Prediction{*height, number_at(row, "predicted.standard_deviation", 0.0, where),
                               row.number("predicted.probability")};
  }
  return out;
}

}  // namespace

const char* outcome_name(Outcome outcome) { return kOutcomes[static_cast<std::size_t>(outcome)]; }

const char* source_name(Source source) { return kSources[static_cast<std::size_t>(source)]; }

Row tap_row(const TapRecord& tap) { return tap_list().row(tap); }

Row intent_row(const TapRecord& tap) {
  TapRecord before = tap;
  before.contact = {};
  before.on_object.reset();
  Row row = tap_row(before);
  row.fields.front().first = "intent";
  return row;
}

std::optional<bool> label_now(const Row& row, const RunResult& counts) {
  const std::optional<bool> then = row.flag("on_object");
  if (!then) return std::nullopt;
  const auto number = static_cast<int>(row.number("tap").value_or(0.0));
  const bool changed = std::any_of(counts.relabelled.begin(), counts.relabelled.end(),
                                   [&](const Relabelled& one) { return one.tap == number; });
  return changed != *then;
}

Row unknown_result_of(const Row& intent) {
  Row row = intent;
  row.fields.front().first = "tap";
  for (auto& [name, value] : row.fields) {
    if (name == "reason") value = std::string("the program ended during this tap");
  }
  return row;
}

std::vector<PastTap> past_taps(const std::vector<Row>& rows, const std::filesystem::path& file) {
  std::vector<PastTap> out;
  for (const Row& row : rows) out.push_back(past_tap(row, fmt::format("{}: tap {}", file.string(), out.size() + 1)));
  return out;
}

}  // namespace palpate
