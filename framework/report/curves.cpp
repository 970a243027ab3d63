// SPDX-License-Identifier: MIT
#include "report/curves.hpp"

#include "record/fields.hpp"
#include "report/words/titles.hpp"
#include "report/words/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr double kMillimetres = 1e3;

/// Returns a curve with the value of `get` at every moment.
template <class Get>
Curve curve_of(const History& history, const std::string& name, const Get& get) {
  Curve curve{name, {}};
  for (const RunAtTap& moment : history.moments) curve.values.push_back(get(moment));
  return curve;
}

/// Returns one curve per number in the row that `numbers` returns for the state at the last moment.
template <class Numbers>
std::vector<Curve> named_curves(const History& history, const Numbers& numbers) {
  const auto row_at = [&](const RunAtTap& moment) { return numbers(Row{moment.result.state.fields}); };
  const Row last = row_at(history.moments.back());
  std::vector<Curve> out;
  for (const auto& field : last.fields)
    out.push_back(
        curve_of(history, field.first, [&](const RunAtTap& moment) { return row_at(moment).number(field.first); }));
  return out;
}

struct NamedGp {
  const char* name;
  const char* field;  ///< prefix of the fields in the record, with the dot
};
constexpr std::array<NamedGp, 3> kStates{
    {{"height GP", "height_gp."}, {"label GP", "label_gp."}, {"surface GP", "surface_gp."}}};

Row likelihoods_of(const Row& state) {
  Row out;
  for (const NamedGp& one : kStates) {
    if (const auto value = state.number(std::string(one.field) + "log_marginal_likelihood")) out.add(one.name, *value);
  }
  return out;
}

Row parameters_of(const Row& state, const std::string& gp) {
  Row out = numbers_below(state, gp + "kernel.");
  for (const char* name : {"noise", "signal"}) {
    if (const auto value = state.number(gp + name)) out.fields.insert(out.fields.begin(), {name, *value});
  }
  return out;
}

Row footprint_numbers(const Row& state) {
  Row out = numbers_below(state, "footprint.");
  for (auto& field : out.fields) std::replace(field.first.begin(), field.first.end(), '_', ' ');
  return out;
}

/// Returns one curve per phase of a tap: the time that the phase took, milliseconds. A tap during which the program was
/// killed has no values.
std::vector<Curve> times(const RecordedRun& recording, const History& history) {
  std::vector<Curve> out;
  for (const char* phase : kPhaseNames)
    out.push_back({phase, std::vector<std::optional<double>>(history.moments.size())});
  for (const TapTimes& tap : recording.timings) {
    const auto moment = static_cast<std::size_t>(tap.tap);
    if (moment >= history.moments.size()) continue;
    for (std::size_t i = 0; i < kPhases; ++i) out[i].values[moment] = 1e3 * tap.seconds[i];
  }
  return out;
}

/// Removes values that the axis cannot show, and curves that have no value. A logarithmic axis becomes linear if the
/// largest value is less than 20 times the least.
void fit_axis(CurvePanel& panel) {
  if (panel.axis == ValueAxisScale::logarithmic) {
    double least = std::numeric_limits<double>::infinity();
    double most = 0.0;
    for (Curve& curve : panel.curves) {
      for (std::optional<double>& value : curve.values) {
        if (value && !(*value > 0.0)) value.reset();
        least = std::min(least, value.value_or(least));
        most = std::max(most, value.value_or(most));
      }
    }
    constexpr double kMostLinear = 20.0;
    if (most <= kMostLinear * least) panel.axis = ValueAxisScale::from_zero;
  }
  const auto empty = [](const Curve& curve) {
    return std::none_of(curve.values.begin(), curve.values.end(), [](const auto& value) { return value.has_value(); });
  };
  panel.curves.erase(std::remove_if(panel.curves.begin(), panel.curves.end(), empty), panel.curves.end());
}

/// Returns the constant value of a curve; nullopt if the curve visibly changes. On a free axis, any change is visible.
/// On other axes, changes of at most a thousandth of the largest absolute value are invisible.
std::optional<double> constant_value(const Curve& curve, ValueAxisScale axis) {
  double least = std::numeric_limits<double>::infinity();
  double most = -least;
  for (const std::optional<double>& value : curve.values) {
    least = std::min(least, value.value_or(least));
    most = std::max(most, value.value_or(most));
  }
  const double visible = axis == ValueAxisScale::free ? 0.0 : 1e-3 * std::max(std::abs(least), std::abs(most));
  return most - least <= visible ? std::optional(most) : std::nullopt;
}

/// Returns title and values of a panel if all its curves are constant, else "".
std::string constant_words(const CurvePanel& panel) {
  std::string out = panel.title + ":";
  for (const Curve& curve : panel.curves) {
    const std::optional<double> value = constant_value(curve, panel.axis);
    if (!value) return {};
    out += fmt::format("{} {}{:.4g}", &curve == &panel.curves.front() ? "" : ",",
                       curve.name.empty() ? "" : curve.name + " ", *value);
  }
  return out + (panel.unit.empty() ? "" : " " + panel.unit);
}

/// Returns a panel with all errors that are lengths, in millimetres, followed by one panel for each other error.
std::vector<CurvePanel> error_panels(bool any_side, const History& history) {
  std::vector<CurvePanel> out(1);
  std::vector<Curve> lengths;
  const auto in_millimetres = [](const std::optional<double>& metres) {
    return metres ? std::optional(kMillimetres * *metres) : std::nullopt;
  };
  for (const RecordField& error : error_fields()) {
    const bool is_length = error.unit == Unit::metre;
    Curve curve = curve_of(history, is_length ? error.label : "", [&](const RunAtTap& moment) {
      Row row;
      add_errors(row, moment.result.errors);
      return is_length ? in_millimetres(row.number(error.name)) : row.number(error.name);
    });
    if (is_length) {
      lengths.push_back(std::move(curve));
    } else {
      out.push_back({error.label, "", ValueAxisScale::share, {std::move(curve)}});
    }
  }
  lengths.push_back(curve_of(history, find_summary_field(kExpectedError)->label, [&](const RunAtTap& moment) {
    return in_millimetres(Row{moment.result.state.fields}.number(kExpectedError));
  }));
  out.front() = {surface_error_title(any_side), "mm", ValueAxisScale::from_zero, std::move(lengths)};
  return out;
}

/// Turns panels whose curves never change into texts, and removes panels that have no value.
Curves without_constants(std::vector<CurvePanel> panels) {
  Curves out;
  for (CurvePanel& panel : panels) {
    fit_axis(panel);
    if (panel.curves.empty()) continue;
    std::string words = constant_words(panel);
    if (words.empty()) {
      out.panels.push_back(std::move(panel));
    } else {
      out.constants.push_back(std::move(words));
    }
  }
  return out;
}

}  // namespace

Curves curves_of(const RecordedRun& recording, const History& history) {
  const ExperimentOptions& options = recording.config.options;
  const bool any_side = recording.is_any_side();
  std::vector<CurvePanel> panels = error_panels(recording.is_any_side(), history);
  const auto add = [&](std::string title, const char* unit, ValueAxisScale axis, std::vector<Curve> curves) {
    panels.push_back({std::move(title), unit, axis, std::move(curves)});
  };
  const auto one = [&](const auto& get) { return std::vector<Curve>{curve_of(history, "", get)}; };
  add(any_side ? "Largest standard deviation of the surface" : "Largest standard deviation of a height", "cm",
      ValueAxisScale::from_zero, one([&](const RunAtTap& moment) {
        const bool drawn = !any_side || moment.largest_deviation > 0.0;
        return drawn ? std::optional(100.0 * moment.largest_deviation) : std::nullopt;
      }));
  add("Share of the taps on the object", "", ValueAxisScale::share, one([](const RunAtTap& moment) {
        const RunResult& result = moment.result;
        return moment.taps > 0 ? std::optional(static_cast<double>(result.object_taps) / moment.taps) : std::nullopt;
      }));
  add("Log marginal likelihood", "nat", ValueAxisScale::free, named_curves(history, likelihoods_of));
  for (const NamedGp& state : kStates) {
    add(fmt::format("Hyperparameters of the {}", state.name), "SI units", ValueAxisScale::logarithmic,
        named_curves(history, [&](const Row& row) { return parameters_of(row, state.field); }));
  }
  add(fmt::format("Numbers of footprint/{}", belief_option(options, "footprint.type")), "", ValueAxisScale::free,
      named_curves(history, footprint_numbers));
  add("Time of a tap, by phase", "ms", ValueAxisScale::logarithmic, times(recording, history));
  if (history.moments.back().result.robot_seconds > 0.0)
    add("Robot time so far", "s", ValueAxisScale::from_zero,
        one([](const RunAtTap& moment) { return moment.result.robot_seconds; }));
  return without_constants(std::move(panels));
}

}  // namespace palpate
