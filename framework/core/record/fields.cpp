// SPDX-License-Identifier: MIT
#include "record/fields.hpp"

#include "record/files.hpp"
#include "record/sample.hpp"
#include "record/tap_row.hpp"

#include <fmt/format.h>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <string_view>

namespace palpate {
namespace {

const char* const kNoTruth = "no truth is known";

struct ErrorField {
  RecordField field;
  std::optional<double> Errors::*value;
  bool any_side = false;  ///< only where the tool comes from any side
};

const std::vector<ErrorField>& error_list() {
  static const std::vector<ErrorField> list{
      {RecordField("rmse_m",
                   "reconstruction against truth over all candidate cells, desk included (root mean square); with "
                   "`surface: two_part` the height of the object where the footprint's probability is >= 1/2, and the "
                   "desk elsewhere; null from any side")
           .in(Unit::metre)
           .less()
           .called("over the scene")
           .headline(),
       &Errors::rmse},
      {RecordField("rmse_object_m",
                   "the same over the cells that truly lie on an object; from any side over the points of the true "
                   "surface")
           .in(Unit::metre)
           .less()
           .called("on the object")
           .headline(),
       &Errors::rmse_object},
      {RecordField("rmse_height_m", "the height mean itself over those cells, whatever the footprint")
           .in(Unit::metre)
           .less()
           .called("of the height mean on the object"),
       &Errors::rmse_height},
      {RecordField("footprint_iou",
                   "cells with a probability >= 1/2, by the config's footprint, against cells truly on an object: "
                   "intersection over union")
           .more()
           .called("footprint IoU")
           .headline(),
       &Errors::footprint_iou},
      {RecordField("surface_distance_m",
                   "from any side: mean distance from the points of the reconstructed surface to the nearest of the "
                   "true one and back, over the points of both, each 10 cm at most, and before an object is known 10 "
                   "cm. The true one is where lines from all sides first meet the scene; the reconstructed one where "
                   "they meet the most probable composition, each point then moved along its normal by what the skin "
                   "says. Of either there is a point in a cube of 1 mm; those that ask for the nearest are one in a "
                   "cube of 3 mm")
           .in(Unit::metre)
           .less()
           .called("to the nearest point"),
       &Errors::surface_distance, true},
      {RecordField("rms_surface_distance_m", "from any side: root mean square of the distances of `surface_distance_m`")
           .in(Unit::metre)
           .less()
           .called("to the nearest point (RMS)")
           .headline(),
       &Errors::rms_surface_distance, true},
      {RecordField("f_score",
                   "from any side: harmonic mean of the share of reconstructed points within 5 mm of the true surface "
                   "and of true points within 5 mm of the reconstructed one")
           .more()
           .called("F-score at 5 mm"),
       &Errors::f_score, true},
      {RecordField(
           "surface_coverage_95",
           "from any side: share of the reconstructed surface whose distance to the true one is within 1.96 of its "
           "standard deviations: 0.95 where these are as large as they should be; left out before an object is known")
           .called("coverage of 95 % intervals"),
       &Errors::coverage, true},
      {RecordField("volume_iou",
                   "from any side: what is solid as it is reconstructed against what truly is, hollows left out: "
                   "intersection over union of cubes of 4 mm by their centres")
           .more()
           .called("volume IoU"),
       &Errors::volume_iou, true},
  };
  return list;
}

std::optional<std::string> if_any(const std::string& text) { return text.empty() ? std::nullopt : std::optional(text); }

/// The fields of a process, their names beginning with `name`: null where there is none, kernel and fit left out.
void add_process(Row& row, const std::string& name, const std::optional<ProcessState>& state) {
  if (state) {
    for (const KernelParameter& one : state->kernel) row.add(name + ".kernel." + one.name, one.value);
  }
  const auto add = [&](const char* field, auto get) {
    row.add(name + "." + field, state ? std::optional(get(*state)) : std::nullopt);
  };
  add("signal", [](const ProcessState& s) { return s.settings.signal; });
  add("noise", [](const ProcessState& s) { return s.settings.noise; });
  add("mean", [](const ProcessState& s) { return s.settings.mean; });
  add("log_marginal_likelihood", [](const ProcessState& s) { return s.log_marginal_likelihood; });
  add("jitter", [](const ProcessState& s) { return s.jitter; });
  add("condition", [](const ProcessState& s) { return s.condition; });
  add("engine", [](const ProcessState& s) { return s.engine; });
  add("error_bound", [](const ProcessState& s) { return s.error_bound; });
  if (state && state->fit) {
    row.add(name + ".fit.changed", state->fit->changed);
    row.add(name + ".fit.objective", state->fit->objective);
    row.add(name + ".fit.evaluations", state->fit->evaluations);
    row.add(name + ".fit.reason", state->fit->reason);
  }
}

/// "footprint.<number>" and "footprint.remark"; none where there is none.
void add_footprint(Row& row, const std::optional<FootprintState>& state) {
  if (!state) return;
  for (const FootprintNumber& one : state->numbers) row.add("footprint." + one.name, one.value);
  row.add("footprint.remark", if_any(state->remark));
}

/// Probabilities with two decimals; none for an empty list.
std::optional<JsonList> list_of(const std::vector<TapBelief::SuspectedOutlier>& suspected) {
  std::vector<Row> rows;
  for (const TapBelief::SuspectedOutlier& one : suspected)
    rows.push_back({{{"tap", std::int64_t{one.tap}}, {"probability", std::round(100.0 * one.probability) / 100.0}}});
  return rows.empty() ? std::nullopt : std::optional(list_of(rows));
}

constexpr const char* kObject = "object";

/// "5 object; 9 desk"
std::string words(const std::vector<Relabelled>& relabelled) {
  std::string out;
  for (const Relabelled& one : relabelled)
    out += fmt::format("{}{} {}", out.empty() ? "" : "; ", one.tap, one.on_object ? kObject : "desk");
  return out;
}

/// Where the loop lays the state of its models down, in a tap and in a result alike.
template <class Record>
void list_models(FieldList<Record>& list, bool reasons) {
  const auto process = [&](const char* name, const char* meaning, std::optional<ProcessState> ModelState::*state) {
    list.add_family(std::string(name) + ".*", meaning, [=](Row& row, const Record& record) {
      const std::optional<ProcessState>& of = record.*state;
      if (!of && state == &ModelState::surface_gp) return;
      add_process(row, name, of);
      if (reasons) row.add(std::string(name) + ".engine_reason", of ? std::optional(of->engine_reason) : std::nullopt);
    });
  };
  process(
      "height_gp",
      "of the GP over heights: hyperparameters by the names of the options (`kernel.kernels.0.length_scale`), "
      "`log_marginal_likelihood`, `jitter` (a variance), `condition` (an incremental estimate: a lower bound, most "
      "often within a factor of 3), `engine` of the posterior and its `error_bound`: of what it adds to the rounding "
      "of `dense`, to means in signals or to variances in signals squared, whichever is more. `fit.*` of the fit "
      "after the latest tap, if one was due: `changed` (false: the old hyperparameters stay), `objective` (the fit's "
      "own measure, larger is better), `evaluations`, `reason` (why it ended)",
      &ModelState::height_gp);
  process("label_gp", "the same of the GP over labels", &ModelState::label_gp);
  process(
      "surface_gp",
      "the same for the heights of the taps on an object; only with `surface: two_part`, and only where a strategy, "
      "a rule that ends the run or the backend reads the height itself",
      &ModelState::surface_gp);
  list.add_family("footprint.*",
                  "what the footprint tells of itself: its numbers, and `remark`, where there is something to know of "
                  "how it came to them; only where `footprint` is not `gp_regression`",
                  [](Row& row, const Record& record) { add_footprint(row, record.footprint); });
  list.add_family("suspected_outliers",
                  "contacts whose height or label is an outlier with a probability of 0.1 or more: a list of `tap` and "
                  "`probability`; null if there is none; only with `height.outlier_probability`",
                  [](Row& row, const Record& record) {
                    if (record.suspected_outliers) row.add("suspected_outliers", list_of(*record.suspected_outliers));
                  });
}

template <class T, class Member>
auto part(const std::optional<T>& whole, Member T::*member) {
  return whole ? std::optional<Member>((*whole).*member) : std::nullopt;
}

/// A number of a contact, which only a touch has.
std::optional<double> if_touched(const TapRecord& tap, double value) {
  return tap.contact.outcome == Outcome::contact ? std::optional(value) : std::nullopt;
}

FieldList<TapRecord> make_tap_list() {
  using Tap = TapRecord;
  FieldList<Tap> list;
  list.add("tap", "number, from 1", &Tap::number);
  list.add("source", "`initial`, `acquisition`, `fallback`, or `caller` where scores came from outside",
           [](const Tap& t) { return source_name(t.source); });
  list.add("why", "of a fallback, why", [](const Tap& t) { return if_any(t.why); });
  list.add("x", "where", [](const Tap& t) { return t.target.x; }).in(Unit::metre);
  list.add("y", "where", [](const Tap& t) { return t.target.y; }).in(Unit::metre);
  const auto of_approach = [&](const char* name, const char* meaning, auto get, Unit unit) {
    list.add_where([](const Tap& t) { return t.approach.has_value(); }, name, meaning,
                   [get](const Tap& t) { return std::optional<double>(get(*t.approach)); })
        .in(unit);
  };
  of_approach(
      "z", "where the tool starts, from any side; x and y, too", [](const Approach& a) { return a.line.origin.z(); },
      Unit::metre);
  of_approach(
      "direction.x", "in which it goes, of unit length", [](const Approach& a) { return a.line.direction.x(); },
      Unit::none);
  of_approach(
      "direction.y", "the same", [](const Approach& a) { return a.line.direction.y(); }, Unit::none);
  of_approach(
      "direction.z", "the same", [](const Approach& a) { return a.line.direction.z(); }, Unit::none);
  list.add_where([](const Tap& t) { return !t.unreached.empty(); }, "unreached",
                 "from any side, which of the lines that were drawn the backend refused, if any: in hex, a digit for "
                 "four lines in their order, the first of them its bit of 8",
                 [](const Tap& t) { return t.unreached; });
  of_approach(
      "length", "how far it goes at most", [](const Approach& a) { return a.length; }, Unit::metre);
  list.add_where([](const Tap& t) { return t.contact.along.has_value(); }, "along", "how far it went",
                 [](const Tap& t) { return t.contact.along; })
      .in(Unit::metre);
  list.add("outcome", "`contact`, `no_contact`, `unreachable`, `timeout`, `aborted`, `unknown`",
           [](const Tap& t) { return outcome_name(t.contact.outcome); });
  list.add("reason", "of a failed tap, why", [](const Tap& t) { return if_any(t.contact.reason); });
  list.add(
      "on_object",
      "whether a contact was one with an object, as it was read when it was made; `relabelled` of the summary names "
      "the taps that are read otherwise at the end",
      &Tap::on_object);
  list.add("height", "of a contact", [](const Tap& t) { return if_touched(t, t.contact.height); }).in(Unit::metre);
  list.add_where([](const Tap& t) { return t.corrected.has_value(); }, "corrected_height",
                 "the same less what motion and arm were thought, when it was made, to add to all heights; only with "
                 "`height.offset`",
                 [](const Tap& t) { return t.corrected; })
      .in(Unit::metre);
  list.add("force", "of a contact, the largest that was felt (in a scene without effects, the threshold)",
           [](const Tap& t) { return if_touched(t, t.contact.force); })
      .in(Unit::newton);
  list.add_where([](const Tap& t) { return t.contact.peak.has_value(); }, "peak_force",
                 "the largest force against the tool in all of the tap, of failed taps, too: the true one where a "
                 "simulator knows it, else what was felt; only where a force is simulated or felt",
                 [](const Tap& t) { return t.contact.peak; })
      .in(Unit::newton);
  list.add("robot_seconds", "robot time of this tap: travel, rest, descent, contact, retreat",
           [](const Tap& t) { return t.contact.seconds; })
      .in(Unit::second);

  list.add("score", "of the acquisition at the chosen place", &Tap::score);
  list.add("u", "uncertainty at the chosen place, before the tap", &Tap::uncertainty);
  list.add("w", "the weight there, never clipped", &Tap::weight);
  list.add("e", "their product", &Tap::exploration);
  list.add_where([](const Tap& t) { return t.footprint.has_value(); }, "p",
                 "the footprint's probability of an object there; only where `footprint` is not `gp_regression`, whose "
                 "probability is the weight, clipped",
                 &Tap::probability);
  list.add("ties", "how many candidates were tied with the best", &Tap::ties);
  list.add("runner_up.x", "the best of the others", [](const Tap& t) { return part(t.runner_up, &Target::x); })
      .in(Unit::metre);
  list.add("runner_up.y", "the same", [](const Tap& t) { return part(t.runner_up, &Target::y); }).in(Unit::metre);
  list.add("runner_up.score", "its score", &Tap::runner_up_score);
  list.add("max_standard_deviation", "of the height over the candidates, before the tap; of the height GP",
           &Tap::max_standard_deviation)
      .in(Unit::metre);
  list.add("mean_standard_deviation", "the same", &Tap::mean_standard_deviation).in(Unit::metre);
  list.add("min_weight", "over the candidates, before the tap, never clipped", &Tap::min_weight);
  list.add("max_weight", "the same", &Tap::max_weight);
  const auto is_chosen = [](const Tap& t) { return t.expected_seconds.has_value(); };
  list.add_where(is_chosen, "motion",
                 "by which the tap was made: its index, from 0, in `motion.of`; only with "
                 "`type: per_tap`",
                 &Tap::motion);
  list.add_where(is_chosen, "expected_seconds", "the robot time that it was expected to take",
                 [](const Tap& t) { return t.expected_seconds; })
      .in(Unit::second);
  const auto is_predicted = [](const Tap& t) { return t.predicted.has_value(); };
  list.add_where(is_predicted, "predicted.height",
                 "what the models expected of the height there, in the frame of the scene; only where the backend asks "
                 "for it (`adaptive_hover`)",
                 [](const Tap& t) { return t.predicted->height; })
      .in(Unit::metre);
  list.add_where(is_predicted, "predicted.standard_deviation", "its standard deviation",
                 [](const Tap& t) { return t.predicted->standard_deviation; })
      .in(Unit::metre);
  list.add_where([](const Tap& t) { return t.predicted && t.predicted->probability; }, "predicted.probability",
                 "the probability of an object there; only where the backend asks for it (`adaptive_hover.certainty`)",
                 [](const Tap& t) { return t.predicted->probability; });
  list_models(list, false);
  list.add_where([](const Tap& t) { return t.forecast.has_value(); }, kExpectedError,
                 "the RMSE over the scene that is expected of what is believed; only with `stop.expected_rmse`, "
                 "null before the first hit",
                 [](const Tap& t) { return t.forecast->rmse; })
      .in(Unit::metre);
  list.add("true_on_object", "whether an object truly is there", &Tap::true_on_object).absent(kNoTruth);
  list.add_shared(error_fields(), [](Row& row, const Tap& t) { add_errors(row, t.errors); });
  return list;
}

/// The phases of a tap, in their order.
constexpr std::array<const char*, kPhases> kPhaseMeanings{"in the backend", "fitting hyperparameters",
                                                          "updating the models", "scoring and choosing",
                                                          "writing the record of the tap before"};

bool is_from_any_side(const Summary& summary) { return summary.config.options.scene.touch == SceneOptions::Touch::any; }

/// Whether contacts are read again after later taps.
bool is_read_again(const Summary& summary) {
  return summary.config.options.height.offset.has_value() || is_from_any_side(summary);
}

/// How often a run took such a step.
auto diagnostics(const std::string& kind) {
  return [kind](const Summary& s) {
    const auto found = s.diagnostics.find(kind);
    return found != s.diagnostics.end() ? found->second : 0;
  };
}

/// The number of a run's objects of which `holds` holds; none where no truth is known.
template <class Holds>
std::optional<int> count_objects(const Summary& summary, Holds holds) {
  if (!summary.objects) return std::nullopt;
  return static_cast<int>(std::count_if(summary.objects->begin(), summary.objects->end(), holds));
}

/// What `sum_up` makes of a number of each object that has it; none where none has.
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
  count("objects", "how many the scene has", [](const ObjectResult&) { return true; });
  count("objects_found", "those with a contact at a cell that truly is theirs, whatever the label said",
        [](const ObjectResult& o) { return o.taps > 0; })
      .more();
  count("objects_merged",
        "those that the footprint (cells with a probability >= 1/2 that share sides) has in one piece with another "
        "object, across a gap, at least a fifth of the cells of each",
        [](const ObjectResult& o) { return o.merged; })
      .less();
  count("objects_split",
        "those of one piece that the footprint has in several, each with at least a fifth of the cells",
        [](const ObjectResult& o) { return o.split; })
      .less();
  list.add("object_iou",
           "mean over the objects of the intersection over union of one alone: its cells against those with a "
           "probability >= 1/2 that are its own, or on no object and nearest to it",
           [](const Summary& s) { return over_objects(s, &ObjectErrors::iou, mean_of); })
      .more()
      .absent(no_object);
  list.add("object_iou_worst", "the least of these",
           [](const Summary& s) {
             return over_objects(s, &ObjectErrors::iou,
                                 [](const auto& all) { return *std::min_element(all.begin(), all.end()); });
           })
      .more()
      .absent(no_object);
  list.add("object_rmse_height_m", "mean over the objects of the error of the height mean over the cells of one",
           [](const Summary& s) { return over_objects(s, &ObjectErrors::rmse_height, mean_of); })
      .in(Unit::metre)
      .less()
      .absent(no_object);
}

FieldList<ObjectRow> make_object_list() {
  FieldList<ObjectRow> list;
  list.add("object", "its place in `scene.objects`, from 0", &ObjectRow::object);
  list.add("type", "its shape", &ObjectRow::type);
  list.add("cells", "candidates that are on it and not on a higher one", [](const ObjectRow& o) { return o.cells; });
  list.add("taps", "contacts there", [](const ObjectRow& o) { return o.taps; });
  list.add("first_tap", "number of the first of them", [](const ObjectRow& o) { return o.first_tap; })
      .absent("there was none");
  list.add("found", "whether there was one", [](const ObjectRow& o) { return o.taps > 0; });
  list.add("merged", "with another object: see `objects_merged`", [](const ObjectRow& o) { return o.merged; });
  list.add("split", "see `objects_split`", [](const ObjectRow& o) { return o.split; });
  list.add("iou", "see `object_iou`", [](const ObjectRow& o) { return o.iou; }).absent("it has no cell");
  list.add("rmse_height_m", "of the height mean over its cells", [](const ObjectRow& o) { return o.rmse_height; })
      .in(Unit::metre)
      .absent("it has no cell");
  return list;
}

FieldList<Summary> make_summary_list() {
  FieldList<Summary> list;
  const char* const no_cell = "no truth is known, or no cell of the object was left untapped";
  list.add("name", "of the config", [](const Summary& s) { return s.config.options.name; });
  list.add("id", "a hash of all that decides what a run computes", [](const Summary& s) { return s.config.id; });
  list.add("seed", "of all that is drawn at random", [](const Summary& s) { return s.config.options.seed; });
  list.add("status", "`done` or `failed`", [](const Summary& s) { return s.failure.empty() ? "done" : "failed"; });
  list.add(
      "stop_reason",
      "`tap budget`, `robot_time`, `max_standard_deviation`, `expected_rmse`, `no candidate is left`, or the error "
      "(`backend/baxter: ...` where the backend could go on no more)",
      [](const Summary& s) { return s.failure.empty() ? s.stop_reason : s.failure; });
  list.add("taps", "all of them; the next three, from any side four, add up to it", &Summary::taps).less().headline();
  list.add("object_taps",
           "contacts with an object, as they are read at the end: with `height.offset`, and from any side, all "
           "are read again after every tap",
           &Summary::object_taps)
      .more()
      .called("taps on an object")
      .headline();
  list.add("desk_taps", "contacts with the desk", &Summary::desk_taps).less().called("taps on the desk");
  list.add_where(is_from_any_side, "no_contact_taps", "from any side: taps that met nothing, all of whose way is free",
                 &Summary::no_contact_taps);
  list.add("failed_taps", "taps without a contact; missed ones are none of them", &Summary::failed_taps).less();
  list.add("first_hit_tap", "number of the first contact with an object", &Summary::first_hit_tap)
      .less()
      .absent("no object was found")
      .called("first tap on an object");
  list.add("found", "whether there was one", [](const Summary& s) { return s.object_taps > 0; })
      .more()
      .called("share of runs that found an object");
  list.add_where(
      is_read_again, "relabelled",
      "the contacts that these counts take otherwise than `on_object` of their taps does, each by the number "
      "of its tap and the label at the end: `5 object; 9 desk`; null if there is none; only with "
      "`height.offset` and from any side",
      [](const Summary& s) { return if_any(words(s.relabelled)); });
  list.add_shared(error_fields(), [](Row& row, const Summary& s) { add_errors(row, s.errors); });
  list.add(kExpectedError,
           "`rmse_m` as the final models expect it, for which no truth is needed: the root of the expected mean square "
           "over the candidates",
           &Summary::expected_rmse)
      .in(Unit::metre)
      .less()
      .absent("no object was found, nothing read the models of the surface, or the run is one from any side")
      .called("over the scene, expected");
  list.add("nlpd",
           "mean negative log predictive density of the true height (natural logarithm) over the cells on an object "
           "that "
           "were not tapped, noise included",
           [](const Summary& s) { return s.calibration.nlpd; })
      .less()
      .absent(no_cell)
      .called("negative log predictive density")
      .headline();
  list.add("coverage_95", "share of those cells whose true height lies in the central 95 % interval: best at 0.95",
           [](const Summary& s) { return s.calibration.coverage_95; })
      .absent(no_cell)
      .called("95 % coverage")
      .headline();
  list_objects(list);
  const auto seconds = [&](const std::string& name, const std::string& meaning, auto get) -> RecordField& {
    return list.add(name, meaning, get).in(Unit::second).less();
  };
  seconds("robot_seconds", "robot time", &Summary::robot_seconds).called("robot time").headline();
  seconds("wall_seconds", "of the process that ended the run", &Summary::wall_seconds).measured();
  seconds("compute_seconds", "CPU time of that process", &Summary::compute_seconds)
      .measured()
      .called("CPU time")
      .headline();
  for (std::size_t i = 0; i < kPhases; ++i) {
    seconds(std::string("compute.") + kPhaseNames[i], std::string("wall time, all taps: ") + kPhaseMeanings[i],
            [i](const Summary& s) { return s.phases ? std::optional((*s.phases)[i]) : std::nullopt; })
        .measured();
  }
  list.add("jitter_max", "largest jitter of the final models, a variance", &Summary::jitter_max).less();
  for (const auto& [name, meaning] : {
           std::pair{"fallback", "taps that the fallback chose"},
           std::pair{"fit_failed",
                     "fits that came to no finite values and kept the old ones; heights and labels fitted "
                     "together count once"},
           std::pair{"heights_rejected",
                     "taps of which the backend reported no finite number, or, from any side, an end that is not on "
                     "the way of the tool"},
           std::pair{"jitter", "how often a factorisation needed jitter; the factorisations of every tap count"},
           std::pair{"pivoted",
                     "factorisations of all taps in which no jitter helped and rows were chosen by pivoting"},
           std::pair{
               "redundant_taps",
               "taps that stay out of a final model because the others tell all about them; the most of any model"},
           std::pair{"variance_clamped",
                     "candidates of the final models whose variance rounding took out of [0, prior]; "
                     "they read as its ends"},
       }) {
    list.add(std::string("diagnostics.") + name, meaning, diagnostics(name)).less();
  }
  list.add_where(is_from_any_side, "diagnostics.violated_free_paths",
                 "from any side: free ways in which the final surface is left", diagnostics("violated_free_paths"))
      .less();
  list_models(list, true);
  list.add("peak_rss_bytes", "peak memory of the process", &Summary::peak_rss_bytes).less().measured();
  return list;
}

FieldList<TapTimes> make_timing_list() {
  FieldList<TapTimes> list;
  list.add("tap", "number, from 1", &TapTimes::tap);
  for (std::size_t i = 0; i < kPhases; ++i) {
    list.add(kPhaseNames[i], std::string("wall time ") + kPhaseMeanings[i],
             [i](const TapTimes& t) { return t.seconds[i]; })
        .in(Unit::second);
  }
  list.add_where([](const TapTimes& t) { return t.expected_rmse.has_value(); }, kExpectedError,
                 "no time: the RMSE over the scene that was expected before the tap; only where `palpate run` or "
                 "`resume` showed it",
                 [](const TapTimes& t) { return t.expected_rmse; })
      .in(Unit::metre);
  return list;
}

}  // namespace

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

const std::string& main_error(const std::vector<Row>& results) {
  static const std::string kFromAbove = "rmse_m";
  static const std::string kFromAnySide = "rms_surface_distance_m";
  const auto some_have = [&](const std::string& name) {
    return std::any_of(results.begin(), results.end(), [&](const Row& one) { return one.number(name).has_value(); });
  };
  return !some_have(kFromAbove) && some_have(kFromAnySide) ? kFromAnySide : kFromAbove;
}

void add_errors(Row& row, const Errors& errors) {
  for (const ErrorField& one : error_list())
    if (!one.any_side || errors.*one.value) row.add(one.field.name, errors.*one.value);
}

std::vector<Relabelled> relabelled_in(const Row& summary) {
  std::vector<Relabelled> out;
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
