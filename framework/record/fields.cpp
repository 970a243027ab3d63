// SPDX-License-Identifier: MIT
#include "record/fields.hpp"

#include "experiment/unreached.hpp"
#include "record/quantiles.hpp"

#include <fmt/format.h>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <set>
#include <sstream>

namespace palpate {
namespace {

const char* const kNoTruth = "no truth is known";

struct ErrorField {
  RecordField field;
  std::optional<double> Errors::*value;
  bool any_side = false;  ///< the field exists only in runs that tap from any side
};

const std::vector<ErrorField>& error_list() {
  static const std::vector<ErrorField> list{
      {RecordField("rmse_m",
                   "RMSE of the reconstruction over all candidate cells, desk included. With `surface: two_part` the "
                   "reconstruction is the object's height where the footprint's probability is >= 1/2, and the desk "
                   "elsewhere. From any side: null")
           .in(Unit::metre)
           .less()
           .called("over the scene")
           .headline(),
       &Errors::rmse},
      {RecordField("rmse_object_m",
                   "RMSE of the reconstruction over the cells that truly lie on an object; from any side, over the "
                   "points of the true surface")
           .in(Unit::metre)
           .less()
           .called("on the object")
           .headline(),
       &Errors::rmse_object},
      {RecordField("rmse_height_m",
                   "RMSE of the mean height, without the footprint, over the cells that truly lie on an object")
           .in(Unit::metre)
           .less()
           .called("of the height mean on the object"),
       &Errors::rmse_height},
      {RecordField(
           "footprint_iou",
           "intersection over union of the cells with a footprint probability >= 1/2 and the cells truly on an object")
           .more()
           .called("footprint IoU")
           .headline(),
       &Errors::footprint_iou},
      {RecordField(
           "surface_distance_m",
           "from any side: mean distance from points of the reconstructed surface to the nearest true point and vice "
           "versa, each at most 10 cm. It is 10 cm before an object is known. Points of the true surface are those "
           "where lines from all sides first meet the scene. Reconstructed points are those where the lines meet the "
           "most probable particle, each then moved along its normal by the residual GP's mean. Each cloud has one "
           "point "
           "per cube of 1 mm; the points whose distance counts are one per cube of 3 mm")
           .in(Unit::metre)
           .less()
           .called("to the nearest point"),
       &Errors::surface_distance, true},
      {RecordField("rms_surface_distance_m",
                   "from any side: root mean square of the distances whose mean is `surface_distance_m`")
           .in(Unit::metre)
           .less()
           .called("to the nearest point (RMS)")
           .headline(),
       &Errors::rms_surface_distance, true},
      {RecordField("f_score",
                   "from any side: harmonic mean of two shares, the reconstructed points within 5 mm of the true "
                   "surface and the true points within 5 mm of the reconstructed surface")
           .more()
           .called("F-score at 5 mm"),
       &Errors::f_score, true},
      {RecordField("surface_coverage_95",
                   "from any side: share of reconstructed points whose distance to the true surface is at most 1.96 of "
                   "their standard deviations, best at 0.95. Absent before an object is known")
           .called("coverage of 95 % intervals"),
       &Errors::coverage, true},
      {RecordField("volume_iou",
                   "from any side: intersection over union of the reconstructed and the true solid volume, by the "
                   "centres of cubes of 4 mm. Spaces that walls enclose belong to neither")
           .more()
           .called("volume IoU"),
       &Errors::volume_iou, true},
  };
  return list;
}

std::optional<std::string> if_any(const std::string& text) { return text.empty() ? std::nullopt : std::optional(text); }

/// Returns the number at `name` in the state of a belief.
std::optional<double> number_of(const BeliefState& state, std::string_view name) {
  const Scalar* const value = state.find(name);
  const double* const number = value != nullptr ? std::get_if<double>(value) : nullptr;
  return number != nullptr ? std::optional(*number) : std::nullopt;
}

bool has(const BeliefState& state, std::string_view name) { return state.find(name) != nullptr; }

constexpr const char* kObject = "object";

/// Returns the text of the field `relabelled`, such as "5 object; 9 desk".
std::string words(const std::vector<RelabelledContact>& relabelled) {
  std::string out;
  for (const RelabelledContact& one : relabelled)
    out += fmt::format("{}{} {}", out.empty() ? "" : "; ", one.tap, one.on_object ? kObject : "desk");
  return out;
}

/// Adds the fields for the state of the models, which taps and run results have in common. Fields whose names contain a
/// dot are written as the belief reports them, in the order of the belief.
template <class Record>
void list_models(FieldList<Record>& list) {
  const auto family = [&](const char* pattern, const char* meaning) {
    list.add_family(pattern, meaning, [](Row&, const Record&) {});
  };
  family("height_gp.*",
         "state of the height GP: hyperparameters by the names of their options (`kernel.kernels.0.length_scale`), "
         "`log_marginal_likelihood`, and `jitter` as a variance. `condition` is a lower bound of the condition "
         "number, most often within a factor of 3. `engine` computes the posterior. `error_bound` limits the error "
         "that `engine` adds to the rounding of `dense`: of means in signals or of variances in signals squared, "
         "whichever is larger. `fit.*` describes the fit after the latest tap, if one was due: `changed` (false if "
         "the old hyperparameters stay), `objective` (larger is better), `evaluations`, and `reason` for its end");
  family("label_gp.*", "state of the label GP, with the same fields as `height_gp`");
  family("surface_gp.*",
         "state of the GP over the heights of taps on an object, with the fields of `height_gp`. Present only with "
         "`surface: two_part`, and only if the strategy, a stop rule or the backend reads the height");
  family("footprint.*",
         "numbers that the footprint reports about itself, and `remark` if their computation needs a comment; "
         "absent with `footprint: gp_regression`");
  family("suspected_outliers",
         "list of `tap` and `probability` of the contacts whose height or label is an outlier with a "
         "probability of 0.1 or more. Null if there are none; only with `belief.height.outlier_probability`");
  list.add_family("*.*", "any other name with a dot: a value that a belief of your own reports about itself",
                  [](Row& row, const Record& record) {
                    for (const auto& [name, value] : record.state.fields) {
                      if (name.find('.') != std::string::npos || name == "suspected_outliers") row.add(name, value);
                    }
                  });
}

template <class T, class Member>
auto part(const std::optional<T>& whole, Member T::*member) {
  return whole ? std::optional<Member>((*whole).*member) : std::nullopt;
}

/// Returns `value` if the tap made contact, else nullopt.
std::optional<double> if_contact(const TapRecord& tap, double value) {
  return tap.is_contact() ? std::optional(value) : std::nullopt;
}

const std::vector<const char*> kSources{"initial", "acquisition", "fallback", "caller"};
const std::vector<const char*> kOutcomes{"contact", "no_contact", "unreachable", "timeout", "aborted", "unknown"};

/// Adds the fields for the line along which the tool moves, and for the result along this line.
void list_line(FieldList<TapRecord>& list) {
  using Tap = TapRecord;
  const auto of_line = [&](const char* name, const char* meaning, auto get, Unit unit) {
    list.add_where([](const Tap& t) { return !t.request.line.from_above; }, name, meaning,
                   [get](const Tap& t) { return std::optional<double>(get(t.request.line)); })
        .in(unit);
  };
  list.add("x", "x of the target", [](const Tap& t) { return t.request.line.start.x(); }).in(Unit::metre);
  list.read_by([](Tap& t, const RowReader& in) {
    t.request.line = line_from_above({in.number("x", 0.0), in.number("y", 0.0)});
  });
  list.add("y", "y of the target", [](const Tap& t) { return t.request.line.start.y(); }).in(Unit::metre);
  of_line(
      "z", "from any side: z of the start of the tool, as are `x` and `y`",
      [](const TapLine& line) { return line.start.z(); }, Unit::metre);
  list.read_by([](Tap& t, const RowReader& in) {
    constexpr std::array<const char*, 5> kParts{"z", "direction.x", "direction.y", "direction.z", "length"};
    const auto known = std::count_if(kParts.begin(), kParts.end(),
                                     [&](const char* part) { return in.row().number(part).has_value(); });
    if (known == 0) return;
    if (known < std::ptrdiff_t{kParts.size()}) in.refuse("has some of z, direction and length, but not all");
    TapLine& line = t.request.line;
    line.from_above = false;
    line.start.z() = in.number("z", 0.0);
    line.direction << in.number("direction.x", 0.0), in.number("direction.y", 0.0), in.number("direction.z", 0.0);
    line.length = in.number("length", 0.0);
  });
  of_line(
      "direction.x", "x of the unit vector along which the tool moves",
      [](const TapLine& line) { return line.direction.x(); }, Unit::none);
  of_line(
      "direction.y", "y of the same unit vector", [](const TapLine& line) { return line.direction.y(); }, Unit::none);
  of_line(
      "direction.z", "z of the same unit vector", [](const TapLine& line) { return line.direction.z(); }, Unit::none);
  list.add_where([](const Tap& t) { return !t.unreached.empty(); }, "unreached",
                 "from any side: the drawn approaches that the backend rejected, if any, as hexadecimal digits. Each "
                 "digit stands for four approaches in their order, its highest bit for the first",
                 [](const Tap& t) { return t.unreached; });
  list.read_by([](Tap& t, const RowReader& in) {
    t.unreached = in.row().text("unreached");
    if (t.unreached.find_first_not_of(kHexDigits) != std::string::npos) in.refuse("has no valid 'unreached'");
  });
  of_line(
      "length", "largest distance that the tool may move along its approach",
      [](const TapLine& line) { return line.length; }, Unit::metre);
  list.add_where([](const Tap& t) { return t.result.distance.has_value(); }, "along",
                 "distance that the tool moved along its approach", [](const Tap& t) { return t.result.distance; })
      .in(Unit::metre);
  list.read_by([](Tap& t, const RowReader& in) { t.result.distance = in.row().number("along"); });
}

/// Adds the fields for the result of the tap.
void list_result(FieldList<TapRecord>& list) {
  using Tap = TapRecord;
  list.add("outcome", "result of the tap: `contact`, `no_contact`, `unreachable`, `timeout`, `aborted` or `unknown`",
           [](const Tap& t) { return outcome_name(t.result.outcome); });
  list.read_by([](Tap& t, const RowReader& in) {
    t.result.outcome = static_cast<Outcome>(in.index("outcome", kOutcomes));
    const bool is_whole = t.request.line.from_above || !t.is_contact() || t.result.distance;
    if (!is_whole) in.refuse("has no number 'along', how far the tool went to its contact");
  });
  list.add("reason", "cause of the failure, if the tap failed", [](const Tap& t) { return if_any(t.result.reason); });
  list.read_by([](Tap& t, const RowReader& in) { t.result.reason = in.row().text("reason"); });
  list.add(
      "on_object",
      "whether a contact was classified as on an object right after the tap. `relabelled` in the summary lists "
      "the taps that are classified differently at the end",
      [](const Tap& t) { return t.reading && t.is_contact() ? std::optional(t.reading->on_object) : std::nullopt; });
  list.add("height", "height of the contact", [](const Tap& t) { return if_contact(t, t.result.height()); })
      .in(Unit::metre);
  list.read_by([](Tap& t, const RowReader& in) {
    const double height = in.number("height", 0.0);
    if (!t.is_contact()) return;
    Eigen::Vector3d at = t.request.line.at(t.result.distance.value_or(0.0));
    at.z() = height;
    t.result.contact = at;
    t.reading.emplace();
    t.reading->position = at;
    t.reading->on_object = in.row().flag("on_object").value_or(false);
  });
  list.add_where([](const Tap& t) { return t.reading && t.reading->is_corrected; }, "corrected_height",
                 "`height` minus the offset that motion and arm add to all heights, as estimated at the time of the "
                 "tap; only with `belief.height.offset`",
                 [](const Tap& t) { return t.reading->position.z(); })
      .in(Unit::metre);
  list.add("force", "largest force measured in a contact (the threshold, if the scene has no effects)",
           [](const Tap& t) { return if_contact(t, t.result.force); })
      .in(Unit::newton);
  list.read_by([](Tap& t, const RowReader& in) { t.result.force = in.number("force", 0.0); });
  list.add_where([](const Tap& t) { return t.result.peak_force.has_value(); }, "peak_force",
                 "largest force against the tool during the whole tap, also of a failed tap: the true force from a "
                 "simulator, else the measured one. Present only if forces are simulated or measured",
                 [](const Tap& t) { return t.result.peak_force; })
      .in(Unit::newton);
  list.read_by([](Tap& t, const RowReader& in) { t.result.peak_force = in.row().number("peak_force"); });
  list.add("robot_seconds", "robot time of this tap: travel, rest, descent, contact, retreat",
           [](const Tap& t) { return t.result.seconds; })
      .in(Unit::second);
  list.read_by([](Tap& t, const RowReader& in) { t.result.seconds = in.number("robot_seconds", 0.0); });
}

/// Adds the fields for the choice of the tap and for the state of the models before it.
void list_choice(FieldList<TapRecord>& list) {
  using Tap = TapRecord;
  const auto of_state = [&](const char* name, const char* meaning) -> RecordField& {
    return list.add(name, meaning, [=](const Tap& t) { return number_of(t.state, name); });
  };
  list.add("score", "score of the chosen candidate", &Tap::score);
  list.read_by([](Tap& t, const RowReader& in) { t.score = in.row().number("score"); });
  of_state("u", "relative variance u of the height GP at the chosen candidate, before the tap");
  of_state("w", "mean w of the label GP (the weight) at the chosen candidate, before the tap, not clipped");
  of_state("e", "product of `u` and `w`");
  list.add_where([](const Tap& t) { return has(t.state, "p"); }, "p",
                 "footprint's probability of an object at the chosen candidate. Absent with `footprint: "
                 "gp_regression`, whose probability is the clipped `w`",
                 [](const Tap& t) { return number_of(t.state, "p"); });
  list.add("ties", "number of candidates tied for the best score, including the best", &Tap::ties);
  list.read_by([](Tap& t, const RowReader& in) {
    if (const auto ties = in.row().number("ties")) t.ties = static_cast<int>(*ties);
  });
  list.add("runner_up.x", "x of the best other candidate", [](const Tap& t) { return part(t.runner_up, &Target::x); })
      .in(Unit::metre);
  list.read_by([](Tap& t, const RowReader& in) {
    if (const auto x = in.row().number("runner_up.x"))
      t.runner_up = Target{*x, in.row().number("runner_up.y").value_or(0.0)};
  });
  list.add("runner_up.y", "y of the best other candidate", [](const Tap& t) { return part(t.runner_up, &Target::y); })
      .in(Unit::metre);
  list.add("runner_up.score", "score of the best other candidate", &Tap::runner_up_score);
  list.read_by([](Tap& t, const RowReader& in) { t.runner_up_score = in.row().number("runner_up.score"); });
  of_state("max_standard_deviation", "largest standard deviation of the height GP over the candidates, before the tap")
      .in(Unit::metre);
  of_state("mean_standard_deviation", "mean standard deviation of the height GP over the candidates, before the tap")
      .in(Unit::metre);
  of_state("min_weight", "smallest `w` over the candidates, before the tap, not clipped");
  of_state("max_weight", "largest `w` over the candidates, before the tap, not clipped");
  const auto is_chosen = [](const Tap& t) { return t.expected_seconds.has_value(); };
  list.add_where(is_chosen, "motion", "index of the tap's motion in `motion.of`, from 0; only with `type: per_tap`",
                 [](const Tap& t) { return t.request.motion; });
  list.read_by([](Tap& t, const RowReader& in) {
    t.request.motion = static_cast<int>(in.row().number("motion").value_or(0.0));
  });
  list.add_where(is_chosen, "expected_seconds", "expected robot time of the tap; only with `type: per_tap`",
                 [](const Tap& t) { return t.expected_seconds; })
      .in(Unit::second);
  const auto is_predicted = [](const Tap& t) { return t.request.predicted.has_value(); };
  list.add_where(is_predicted, "predicted.height",
                 "height that the models predicted at the target, in the frame of the scene; only with "
                 "`adaptive_hover` or `type: per_tap`",
                 [](const Tap& t) { return t.request.predicted->height; })
      .in(Unit::metre);
  list.read_by([](Tap& t, const RowReader& in) {
    if (const std::optional<double> height = in.row().number("predicted.height"))
      t.request.predicted =
          Prediction{*height, in.number("predicted.standard_deviation", 0.0), in.row().number("predicted.probability")};
  });
  list.add_where(is_predicted, "predicted.standard_deviation", "standard deviation of the predicted height",
                 [](const Tap& t) { return t.request.predicted->standard_deviation; })
      .in(Unit::metre);
  list.add_where(
      [](const Tap& t) { return t.request.predicted && t.request.predicted->probability; }, "predicted.probability",
      "predicted probability of an object at the target; only with `adaptive_hover.certainty` or `type: per_tap`",
      [](const Tap& t) { return t.request.predicted->probability; });
}

FieldList<TapRecord> make_tap_list() {
  using Tap = TapRecord;
  FieldList<Tap> list;
  list.add("tap", "number of the tap, from 1", [](const Tap& t) { return t.number(); });
  list.read_by(
      [](Tap& t, const RowReader& in) { t.request.number = static_cast<int>(in.row().number("tap").value_or(0.0)); });
  list.add("source",
           "origin of the choice: `initial`, `acquisition`, `fallback`, or `caller` (scores of a calling program)",
           [](const Tap& t) { return source_name(t.request.source); });
  list.read_by(
      [](Tap& t, const RowReader& in) { t.request.source = static_cast<Source>(in.index("source", kSources)); });
  list.add("why", "reason for the fallback, if there was one", [](const Tap& t) { return if_any(t.why); });
  list.read_by([](Tap& t, const RowReader& in) { t.why = in.row().text("why"); });
  list_line(list);
  list_result(list);
  list_choice(list);
  list_models(list);
  list.add_where([](const Tap& t) { return has(t.state, kExpectedError); }, kExpectedError,
                 "RMSE over the scene that the models expect. Present only with `stop.expected_rmse`; null before the "
                 "first contact with an object",
                 [](const Tap& t) { return number_of(t.state, kExpectedError); })
      .in(Unit::metre);
  list.add("true_on_object", "whether the target truly is on an object", &Tap::true_on_object).absent(kNoTruth);
  list.add_shared(error_fields(), [](Row& row, const Tap& t) { add_errors(row, t.errors); });
  return list;
}

/// Meanings of the phases of a tap, in the order of Phase.
constexpr std::array<const char*, kPhases> kPhaseMeanings{"in the backend", "fitting hyperparameters",
                                                          "updating the models", "scoring and choosing",
                                                          "writing the record of the previous tap"};

bool is_from_any_side(const Summary& summary) { return !summary.from_above; }

/// Returns whether later taps can change the label of a contact.
bool is_read_again(const Summary& summary) {
  return !belief_option(summary.config.options, "height.offset").empty() || is_from_any_side(summary);
}

/// Returns a function that reads the diagnostics counter `kind` of a run.
auto diagnostics(const std::string& kind) {
  return [kind](const Summary& s) {
    const auto found = s.state.diagnostics.find(kind);
    return found != s.state.diagnostics.end() ? found->second : 0;
  };
}

/// Returns the number of objects for which `holds` is true; nullopt if the truth is not known.
template <class Holds>
std::optional<int> count_objects(const Summary& summary, Holds holds) {
  if (!summary.objects) return std::nullopt;
  return static_cast<int>(std::count_if(summary.objects->begin(), summary.objects->end(), holds));
}

/// Applies `sum_up` to the values of a measure for all objects that have a value, and returns the result; nullopt if no
/// object has a value.
template <class SumUp>
std::optional<double> over_objects(const Summary& summary, std::optional<double> ObjectErrors::*value, SumUp sum_up) {
  std::vector<double> values;
  if (summary.objects) {
    for (const ObjectResult& one : *summary.objects)
      if (one.*value) values.push_back(*(one.*value));
  }
  return values.empty() ? std::nullopt : std::optional<double>(sum_up(values));
}

void list_objects(FieldList<Summary>& list) {
  const char* const no_object = "no truth is known, or no object has a cell";
  const auto count = [&](const char* name, const char* meaning, auto holds) -> RecordField& {
    return list.add(name, meaning, [=](const Summary& s) { return count_objects(s, holds); }).absent(kNoTruth);
  };
  count("objects", "number of objects in the scene", [](const ObjectResult&) { return true; });
  count("objects_found", "objects with a contact on a cell that truly is theirs, whatever its label",
        [](const ObjectResult& o) { return o.taps > 0; })
      .more();
  count("objects_merged",
        "objects that the footprint joins with another one across a gap. One component of cells that share sides, with "
        "a probability >= 1/2, has at least a fifth of the cells of each",
        [](const ObjectResult& o) { return o.merged; })
      .less();
  count("objects_split",
        "connected objects that the footprint divides into several components, each with at least a fifth of the "
        "object's cells",
        [](const ObjectResult& o) { return o.split; })
      .less();
  list.add("object_iou",
           "mean over the objects of each one's own intersection over union. The object's cells are compared with the "
           "cells with a probability >= 1/2 that are its own, or that are on no object and nearest to it",
           [](const Summary& s) { return over_objects(s, &ObjectErrors::iou, mean_of); })
      .more()
      .absent(no_object);
  list.add("object_iou_worst", "smallest intersection over union of one object (see `object_iou`)",
           [](const Summary& s) {
             return over_objects(s, &ObjectErrors::iou,
                                 [](const auto& all) { return *std::min_element(all.begin(), all.end()); });
           })
      .more()
      .absent(no_object);
  list.add("object_rmse_height_m", "mean over the objects of the RMSE of the mean height over the cells of each",
           [](const Summary& s) { return over_objects(s, &ObjectErrors::rmse_height, mean_of); })
      .in(Unit::metre)
      .less()
      .absent(no_object);
}

FieldList<ObjectRow> make_object_list() {
  FieldList<ObjectRow> list;
  list.add("object", "index in `scene.objects`, from 0", &ObjectRow::object);
  list.add("type", "type of the object's shape", &ObjectRow::type);
  list.add("cells", "candidates that are on the object and not on a higher one",
           [](const ObjectRow& o) { return o.cells; });
  list.add("taps", "contacts on the object's cells", [](const ObjectRow& o) { return o.taps; });
  list.add("first_tap", "number of the first tap with such a contact", [](const ObjectRow& o) { return o.first_tap; })
      .absent("no tap touched the object");
  list.add("found", "whether any tap touched the object", [](const ObjectRow& o) { return o.taps > 0; });
  list.add("merged", "whether the footprint joins it with another object (see `objects_merged`)",
           [](const ObjectRow& o) { return o.merged; });
  list.add("split", "whether the footprint divides it (see `objects_split`)",
           [](const ObjectRow& o) { return o.split; });
  list.add("iou", "intersection over union of this object (see `object_iou`)", [](const ObjectRow& o) { return o.iou; })
      .absent("the object has no cell");
  list.add("rmse_height_m", "RMSE of the mean height over the object's cells",
           [](const ObjectRow& o) { return o.rmse_height; })
      .in(Unit::metre)
      .absent("the object has no cell");
  return list;
}

FieldList<Summary> make_summary_list() {
  FieldList<Summary> list;
  const char* const no_cell = "no truth is known, or every cell on an object was tapped";
  list.add("name", "`name` of the config", [](const Summary& s) { return s.config.options.name; });
  list.add("id", "hash of everything that decides the results of the run",
           [](const Summary& s) { return s.config.id; });
  list.add("seed", "`seed` of the config, from which all random numbers come",
           [](const Summary& s) { return s.config.options.seed; });
  list.add("status", "final state of the run: `done` or `failed`",
           [](const Summary& s) { return s.failure.empty() ? "done" : "failed"; });
  list.add(
      "stop_reason",
      "reason for the end: `tap budget`, `no candidate is left`, the name of a stop rule such as `robot_time`, or the "
      "error (`backend/baxter: ...` if the backend could not continue)",
      [](const Summary& s) { return s.failure.empty() ? s.stop_reason : s.failure; });
  list.add("taps", "number of all taps: the sum of the next three counts, or four from any side", &Summary::taps)
      .less()
      .headline();
  list.add("object_taps",
           "contacts with an object, as classified at the end. With `belief.height.offset`, and from any side, every "
           "tap may "
           "change the class of earlier contacts",
           &Summary::object_taps)
      .more()
      .called("taps on an object")
      .headline();
  list.add("desk_taps", "contacts with the desk, as classified at the end", &Summary::desk_taps)
      .less()
      .called("taps on the desk");
  list.add_where(is_from_any_side, "no_contact_taps",
                 "from any side: taps that touched nothing, so that their whole path is known to be free",
                 &Summary::no_contact_taps);
  list.add("failed_taps", "taps that failed; `no_contact_taps` are not included", &Summary::failed_taps).less();
  list.add("first_hit_tap", "number of the first contact classified as on an object", &Summary::first_hit_tap)
      .less()
      .absent("no object was found")
      .called("first tap on an object");
  list.add("found", "whether any contact is classified as on an object at the end",
           [](const Summary& s) { return s.object_taps > 0; })
      .more()
      .called("share of runs that found an object");
  list.add_where(is_read_again, "relabelled",
                 "taps whose class at the end differs from their `on_object`, each with its final class: `5 object; 9 "
                 "desk`. Null if there are none; only with `belief.height.offset` and from any side",
                 [](const Summary& s) { return if_any(words(s.relabelled)); });
  list.add_shared(error_fields(), [](Row& row, const Summary& s) { add_errors(row, s.errors); });
  list.add(kExpectedError,
           "`rmse_m` as the final models expect it, without the truth: root of the expected mean square error over the "
           "candidates",
           [](const Summary& s) { return number_of(s.state, kExpectedError); })
      .in(Unit::metre)
      .less()
      .absent("no object was found, nothing read the models of the surface, or taps come from any side")
      .called("over the scene, expected");
  list.add("nlpd",
           "mean negative log predictive density of the true height (natural logarithm), noise included, over the "
           "untapped cells on an object",
           [](const Summary& s) { return number_of(s.state, "nlpd"); })
      .less()
      .absent(no_cell)
      .called("negative log predictive density")
      .headline();
  list.add("coverage_95",
           "share of the untapped cells on an object whose true height lies in the central 95 % interval, best at 0.95",
           [](const Summary& s) { return number_of(s.state, "coverage_95"); })
      .absent(no_cell)
      .called("95 % coverage")
      .headline();
  list_objects(list);
  const auto seconds = [&](const std::string& name, const std::string& meaning, auto get) -> RecordField& {
    return list.add(name, meaning, get).in(Unit::second).less();
  };
  seconds("robot_seconds", "robot time of all taps", &Summary::robot_seconds).called("robot time").headline();
  seconds("wall_seconds", "wall time of the process that ended the run", &Summary::wall_seconds).measured();
  seconds("compute_seconds", "CPU time of the process that ended the run", &Summary::compute_seconds)
      .measured()
      .called("CPU time")
      .headline();
  for (std::size_t i = 0; i < kPhases; ++i) {
    seconds(std::string("compute.") + kPhaseNames[i], std::string("wall time, all taps: ") + kPhaseMeanings[i],
            [i](const Summary& s) { return s.phases ? std::optional((*s.phases)[i]) : std::nullopt; })
        .measured();
  }
  list.add("jitter_max", "largest jitter of the final models, as a variance",
           [](const Summary& s) { return s.state.jitter_max; })
      .less();
  for (const auto& [name, meaning] : {
           std::pair{"fallback", "taps that the fallback chose"},
           std::pair{"fit_failed",
                     "fits that reached no finite values and kept the old ones. A joint fit of heights and labels "
                     "counts once"},
           std::pair{"heights_rejected",
                     "taps for which the backend reported a number that is not finite or, from any side, an end that "
                     "is not on the tool's path"},
           std::pair{"jitter",
                     "number of times that jitter was added or increased, over the factorisations of all taps"},
           std::pair{"pivoted",
                     "factorisations of all taps in which no jitter helped, so that pivoting chose independent rows"},
           std::pair{"redundant_taps",
                     "taps left out of a final model because the other taps already determine them; the largest number "
                     "of any model"},
           std::pair{"variance_clamped",
                     "candidates of the final models whose variance left [0, prior] by rounding and was set to the "
                     "nearer end"},
       }) {
    list.add(std::string("diagnostics.") + name, meaning, diagnostics(name)).less();
  }
  list.add_where(is_from_any_side, "diagnostics.violated_free_paths",
                 "from any side: free paths that the final surface still crosses", diagnostics("violated_free_paths"))
      .less();
  list_models(list);
  list.add("peak_rss_bytes", "peak memory of the process", &Summary::peak_rss_bytes).less().measured();
  return list;
}

FieldList<TapTimes> make_timing_list() {
  FieldList<TapTimes> list;
  list.add("tap", "number of the tap, from 1", &TapTimes::tap);
  for (std::size_t i = 0; i < kPhases; ++i) {
    list.add(kPhaseNames[i], std::string("wall time ") + kPhaseMeanings[i],
             [i](const TapTimes& t) { return t.seconds[i]; })
        .in(Unit::second);
  }
  list.add_where([](const TapTimes& t) { return t.expected_rmse.has_value(); }, kExpectedError,
                 "no time, but the RMSE over the scene that was expected before the tap; only if `palpate run` or "
                 "`resume` showed it",
                 [](const TapTimes& t) { return t.expected_rmse; })
      .in(Unit::metre);
  return list;
}

}  // namespace

const char* outcome_name(Outcome outcome) { return kOutcomes[static_cast<std::size_t>(outcome)]; }

const char* source_name(Source source) { return kSources[static_cast<std::size_t>(source)]; }

double RowReader::number(const char* name, double absent) const {
  if (const std::optional<double> value = row_.number(name); value && !row_.flag(name)) return *value;
  if (const Scalar* value = row_.find(name); value != nullptr && *value == Scalar()) return absent;
  refuse(std::string("has no number '") + name + "'");
}

std::size_t RowReader::index(const char* name, const std::vector<const char*>& names) const {
  const std::string text = row_.text(name);
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end()) refuse(std::string("has no valid '") + name + "'");
  return static_cast<std::size_t>(found - names.begin());
}

void RowReader::refuse(const std::string& reason) const { throw Error(where_, reason, "the file is damaged"); }

Row tap_row(const TapRecord& tap) { return tap_list().row(tap); }

Row intent_row(const TapRecord& tap) {
  TapRecord before = tap;
  before.result = {};
  before.reading.reset();
  Row row = tap_row(before);
  row.fields.front().first = "intent";
  return row;
}

std::optional<bool> label_now(const Row& row, const RunResult& counts) {
  const std::optional<bool> then = row.flag("on_object");
  if (!then) return std::nullopt;
  const auto number = static_cast<int>(row.number("tap").value_or(0.0));
  const bool changed = std::any_of(counts.relabelled.begin(), counts.relabelled.end(),
                                   [&](const RelabelledContact& one) { return one.tap == number; });
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

std::vector<TapRecord> read_taps(const std::vector<Row>& rows, const std::filesystem::path& file) {
  std::vector<TapRecord> out;
  for (const Row& row : rows) {
    const std::string where = fmt::format("{}: tap {}", file.string(), out.size() + 1);
    out.push_back(tap_list().read({row, where}));
  }
  return out;
}

const FieldList<TapRecord>& tap_list() {
  static const FieldList<TapRecord> list = make_tap_list();
  return list;
}

const FieldList<Summary>& summary_list() {
  static const FieldList<Summary> list = make_summary_list();
  return list;
}

const FieldList<TapTimes>& timing_list() {
  static const FieldList<TapTimes> list = make_timing_list();
  return list;
}

const FieldList<ObjectRow>& object_list() {
  static const FieldList<ObjectRow> list = make_object_list();
  return list;
}

std::vector<Row> object_rows(const Summary& summary) {
  std::vector<Row> rows;
  if (!summary.objects) return rows;
  for (const ObjectResult& one : *summary.objects) {
    const ObjectOptions& options = summary.config.options.scene.objects[rows.size()];
    rows.push_back(object_list().row({one, static_cast<int>(rows.size()), options.shape.type}));
  }
  return rows;
}

const std::vector<RecordField>& summary_fields() {
  static const std::vector<RecordField> fields = summary_list().fields();
  return fields;
}

const RecordField* find_summary_field(const std::string& name) {
  const auto& fields = summary_fields();
  const auto found =
      std::find_if(fields.begin(), fields.end(), [&](const RecordField& one) { return one.name == name; });
  return found != fields.end() ? &*found : nullptr;
}

Unit unit_of_column(const std::string& name) {
  if (const RecordField* field = find_summary_field(name)) return field->unit;
  return boost::ends_with(name, "_m") ? Unit::metre : boost::ends_with(name, "_seconds") ? Unit::second : Unit::none;
}

bool depends_on_machine(const std::string& name) {
  const RecordField* field = find_summary_field(name);
  return field != nullptr && field->of_machine;
}

bool needs_truth(const std::string& name) {
  static const std::set<std::string> names = [] {
    std::set<std::string> out;
    for (const auto& fields : {tap_list().fields(), summary_fields(), error_fields()}) {
      for (const RecordField& one : fields) {
        if (boost::starts_with(one.when_null, kNoTruth)) out.insert(one.name);
      }
    }
    return out;
  }();
  return names.count(name) != 0;
}

const std::vector<RecordField>& error_fields() {
  static const std::vector<RecordField> fields = [] {
    std::vector<RecordField> out;
    for (ErrorField one : error_list()) out.push_back(one.field.absent(kNoTruth));
    return out;
  }();
  return fields;
}

std::string main_error(const std::vector<Row>& summaries) {
  const std::string from_above = "rmse_m";
  const std::string from_any_side = "rms_surface_distance_m";
  const auto some_have = [&](const std::string& name) {
    return std::any_of(summaries.begin(), summaries.end(),
                       [&](const Row& one) { return one.number(name).has_value(); });
  };
  return !some_have(from_above) && some_have(from_any_side) ? from_any_side : from_above;
}

void add_errors(Row& row, const Errors& errors) {
  for (const ErrorField& one : error_list())
    if (!one.any_side || errors.*one.value) row.add(one.field.name, errors.*one.value);
}

std::vector<RelabelledContact> relabelled_in(const Row& summary) {
  std::vector<RelabelledContact> out;
  std::istringstream words(summary.text("relabelled"));
  std::string label;
  for (int tap = 0; words >> tap >> label;) out.push_back({tap, label.rfind(kObject, 0) == 0});
  return out;
}

Errors errors_in(const Row& row) {
  Errors out;
  for (const ErrorField& one : error_list()) out.*one.value = row.number(one.field.name);
  return out;
}

}  // namespace palpate
