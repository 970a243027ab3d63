// SPDX-License-Identifier: MIT
#include "experiment/summary_fields.hpp"

#include "experiment/phases.hpp"

#include <algorithm>
#include <string_view>

namespace palpate {
namespace {

using Type = SummaryField::Type;
using Better = SummaryField::Better;

std::vector<SummaryField> make_fields() {
  const char* const no_truth = "no truth is known";
  std::vector<SummaryField> fields{
      {"name", Type::text, Unit::none, Better::neither, ""},
      {"id", Type::text, Unit::none, Better::neither, ""},
      {"seed", Type::number, Unit::none, Better::neither, ""},
      {"status", Type::text, Unit::none, Better::neither, ""},
      {"stop_reason", Type::text, Unit::none, Better::neither, ""},
      {"taps", Type::number, Unit::none, Better::less, ""},
      {"on_surface_taps", Type::number, Unit::none, Better::more, ""},
      {"off_surface_taps", Type::number, Unit::none, Better::less, ""},
      {"failed_taps", Type::number, Unit::none, Better::less, ""},
      {"first_hit_tap", Type::number, Unit::none, Better::less, "the object was not found"},
      {"found", Type::flag, Unit::none, Better::more, ""},
      {"rmse_m", Type::number, Unit::metre, Better::less, no_truth},
      {"rmse_on_surface_m", Type::number, Unit::metre, Better::less, no_truth},
      {"rmse_height_m", Type::number, Unit::metre, Better::less, no_truth},
      {"footprint_iou", Type::number, Unit::none, Better::more, no_truth},
      {"nlpd", Type::number, Unit::none, Better::less, "no truth is known, or no cell of the object was left untapped"},
      // Best at 0.95: too many are as wrong as too few.
      {"coverage_95", Type::number, Unit::none, Better::neither,
       "no truth is known, or no cell of the object was left untapped"},
      {"robot_seconds", Type::number, Unit::second, Better::less, ""},
      {"wall_seconds", Type::number, Unit::second, Better::less, ""},
      {"compute_seconds", Type::number, Unit::second, Better::less, ""},
  };
  for (const char* phase : kPhaseNames)
    fields.push_back({std::string("compute.") + phase, Type::number, Unit::second, Better::less, ""});
  fields.push_back({"jitter_max", Type::number, Unit::none, Better::less, ""});
  for (const char* kind :
       {"fallback", "fit_failed", "height_refused", "jitter", "pivoted", "set_aside", "variance_clamped"}) {
    fields.push_back({std::string("interventions.") + kind, Type::number, Unit::none, Better::less, ""});
  }
  fields.push_back({"peak_rss_bytes", Type::number, Unit::none, Better::less, ""});
  return fields;
}

bool ends_with(std::string_view text, std::string_view end) {
  return text.size() >= end.size() && text.substr(text.size() - end.size()) == end;
}

}  // namespace

const std::vector<SummaryField>& summary_fields() {
  static const std::vector<SummaryField> fields = make_fields();
  return fields;
}

const SummaryField* find_summary_field(const std::string& name) {
  const auto& fields = summary_fields();
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const SummaryField& one) { return one.name == name; });
  return found != fields.end() ? &*found : nullptr;
}

Unit unit_of_column(const std::string& name) {
  if (const SummaryField* field = find_summary_field(name)) return field->unit;
  return ends_with(name, "_m") ? Unit::metre : ends_with(name, "_seconds") ? Unit::second : Unit::none;
}

}  // namespace palpate
