// SPDX-License-Identifier: MIT
#include "experiment/experiment_options.hpp"

#include "config/keys.hpp"
#include "gp/candidates.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {
namespace {

// Squares and ratios of squares of what is within these bounds are far from the ends of double precision.
constexpr double kLeastSignal = 1e-12;
constexpr double kMostSignal = 1e12;

constexpr std::int64_t kPaperCount = 47;

/// Resolved configs have every key: what nobody asked for is at its default.
void refuse_what_is_from_above(const ExperimentOptions& options, Fields& fields) {
  const ExperimentOptions usual;
  const auto only = [&](const char* key, bool untouched) {
    fields.require(untouched, key, "applies to taps from above only, remove it or choose scene.touch: top");
  };
  only("candidates.spacing", !options.candidates.spacing);
  only("candidates.count", options.candidates.count == kPaperCount);
  only("height.kernel", !options.height.kernel);
  only("height.fitting", !options.height.fitting);
  only("height.outlier_probability", !options.height.outlier_probability);
  only("height.offset", !options.height.offset);
  only("label.signal", options.label.signal == usual.label.signal);
  only("label.noise", options.label.noise == usual.label.noise);
  only("label.prior_mean", options.label.prior_mean == usual.label.prior_mean);
  only("label.clip", options.label.clip == usual.label.clip);
  only("label.hyperparameters", options.label.hyperparameters == usual.label.hyperparameters);
  only("label.kernel", !options.label.kernel);
  only("label.fitting", !options.label.fitting);
  only("engine.type", options.engine.type == usual.engine.type);
  only("engine.tolerance", options.engine.tolerance == usual.engine.tolerance);
  only("fitting.type", options.fitting.type == usual.fitting.type);
  only("footprint.type", options.footprint.type == usual.footprint.type);
  only("fallback", options.fallback == usual.fallback);
  only("repeat", options.repeat == usual.repeat);
  only("engine.accuracy", options.engine.accuracy == usual.engine.accuracy);
  only("stop.max_standard_deviation", !options.stop.max_standard_deviation);
  only("stop.expected_rmse", !options.stop.expected_rmse);
  only("log.maps", options.log.maps == usual.log.maps);
  only("prior", !options.prior);
  only("engine.threads", options.engine.threads == usual.engine.threads);
}

}  // namespace

void InitialOptions::list(Fields& fields) {
  const auto counted = [this](Fields& inner) {
    inner.integer(count, Field("count", "how many").at_least(1).from("Sun and Min 2021: 3"));
  };
  const auto until_hit = [this](Fields& inner) {
    inner.real(smallest, Field("smallest", "least width of the object that is looked for").in(Unit::metre).above(0));
  };
  fields.choice(design, Field("design", "how the first taps are spread; always over different candidates"),
                {{"random", "uniformly, from the seed alone", counted},
                 {"sobol", "by a Sobol sequence, shifted by the seed", counted},
                 {"grid", "on a square lattice", counted},
                 {"search", "to find an object in the fewest taps: as many as the first hit takes", until_hit}});
}

void CandidateOptions::list(Fields& fields) {
  fields.real(spacing, Field("spacing", "side of a cell, instead of count").in(Unit::metre).above(0));
  // The default belongs into the resolved config, unless spacing takes its place.
  if (!spacing && !count) count = kPaperCount;
  fields.integer(count, Field("count", "cells per side").at_least(1).at_most(kMaxCellsPerSide));
  fields.require(!(count && spacing), "spacing", "give either count or spacing; set the other one to none");
}

void ProcessOptions::list_plugins(Fields& fields) {
  fields.plugin(kernel, "kernel", Field("kernel", "its own kernel, instead of the shared one").inherits("kernel"));
  fields.plugin(fitting, "fitting", Field("fitting", "its own fitting, instead of the shared one").inherits("fitting"));
}

void OffsetOptions::list(Fields& fields) {
  fields.real(offset, Field("offset", "prior standard deviation of what is added to every height")
                          .in(Unit::metre)
                          .above(0)
                          .from("6 mm: absolute errors of Baxter's tip are 2 to 10 mm"));
  fields.real(drift, Field("drift", "the same of what comes to it over time")
                         .in(Unit::metre_per_second)
                         .above(0)
                         .from("1 mm/min: an arm that warms up, an estimate"));
  fields.real(noise, Field("noise", "standard deviation of the height of one contact with the desk")
                         .in(Unit::metre)
                         .above(0)
                         .from("2 mm: pose and moment of detection of an arm like Baxter"));
}

void HeightOptions::list(Fields& fields) {
  fields.real(signal, Field("signal", "prior standard deviation of the height")
                          .in(Unit::metre)
                          .at_least(kLeastSignal)
                          .at_most(kMostSignal)
                          .from("Sun and Min 2021: unit signal variance"));
  fields.real(
      noise,
      Field("noise", "standard deviation of the noise of one tap").in(Unit::metre).at_least(0).at_most(kMostSignal));
  fields.real(outlier_probability, Field("outlier_probability",
                                         "prior probability that the height of a contact is an outlier, unrelated to "
                                         "the surface; not given, no contact is; for surface: two_part")
                                       .above(0)
                                       .at_most(0.5));
  fields.section(offset, Field("offset",
                               "estimate the offset that motion and arm add to all heights from taps on the desk, "
                               "whose height is known, and subtract it; not given, heights are used as measured"));
  list_plugins(fields);
}

void LabelOptions::list(Fields& fields) {
  fields.real(signal,
              Field("signal", "prior standard deviation of the label").at_least(kLeastSignal).at_most(kMostSignal));
  fields.real(noise, Field("noise", "standard deviation of the noise of one label").at_least(0).at_most(kMostSignal));
  fields.real(prior_mean, Field("prior_mean", "of the label where nothing is known").from("Sun and Min 2021: 0"));
  fields.flag(clip, Field("clip", "let the acquisitions see the weight clipped to [0, 1]"));
  fields.choice(
      hyperparameters, Field("hyperparameters", "what a fit chooses for the labels"),
      {{"own", "the labels' own kernel and noise", {}},
       {"shared",
        "those of the heights, noise in signals included, fitted to heights and labels together; signals stay "
        "apart",
        {}}});
  list_plugins(fields);
  const bool shared = hyperparameters == Hyperparameters::shared;
  fields.require(!shared || !kernel, "kernel",
                 "the labels use the kernel of the heights when hyperparameters are shared; remove it, or choose own");
  fields.require(
      !shared || !fitting, "fitting",
      "the labels are fitted together with the heights when hyperparameters are shared; remove it, or choose own");
}

void EngineOptions::list(Fields& fields) {
  fields.choice(type, Field("type", "which engine keeps the posterior over the candidates"),
                {{"auto", "the fastest that is exact enough: see accuracy", {}},
                 {"dense", "any kernel; time and memory grow with taps times candidates", {}},
                 {"grid", "as exact, memory grows with candidates alone; needs a separable kernel, such as rbf", {}},
                 {"lowrank", "time grows with candidates alone, not with taps; needs a separable kernel", {}}});
  fields.real(tolerance, Field("tolerance",
                               "lowrank leaves out directions of a one-axis covariance below this share of its "
                               "variance")
                             .above(0)
                             .at_most(1)
                             .from("keeps variances within 1e-12 and heights within 1e-9 of dense after 1000 taps"));
  fields.real(accuracy, Field("accuracy",
                              "`type: auto` takes no engine whose error beyond dense's may exceed this, or a tenth of "
                              "tie_tolerance; in prior standard deviations, or prior variances")
                            .at_least(0)
                            .at_most(1));
  fields.integer(threads, Field("threads", "number of threads that update the maps; the results are the same")
                              .at_least(1)
                              .at_most(64)
                              .not_identifying());
}

void SideViewOptions::list(Fields& fields) {
  constexpr double kUpright = 3.14159265358979323846 / 2;
  fields.real(azimuth, Field("azimuth",
                             "where the camera is, seen from the middle of the area, counter-clockwise from x; not "
                             "given, drawn from the seed")
                           .in(Unit::radian));
  fields.real(elevation, Field("elevation", "how far it is above the horizon, seen from there")
                             .in(Unit::radian)
                             .at_least(0)
                             .at_most(kUpright * (1 + 1e-12)));
  fields.integer(
      rays, Field("rays", "of its picture, a square: the square number that is nearest").at_least(16).at_most(40000));
}

void SpaceOptions::list(Fields& fields) {
  fields.integer(
      approaches,
      Field("approaches", "among which the next is chosen, drawn anew before every tap").at_least(1).at_most(100000));
  fields.integer(
      particles,
      Field("particles", "of simple solids that are kept, each about equally probable").at_least(2).at_most(1000));
  fields.integer(
      moves, Field("moves", "of each, after a tap, by which it is fitted to the touches").at_least(0).at_most(100000));
  fields.real(
      model_discrepancy,
      Field("model_discrepancy", "by how much objects are off the simple solids").in(Unit::metre).at_least(1e-6));
  fields.section(view, Field("view",
                             "what a camera 60 cm away sees of the scene, from one side, before the first tap; for "
                             "backend: simulator; not given, nothing"));
}

void StopOptions::list(Fields& fields) {
  fields.real(max_standard_deviation,
              Field("max_standard_deviation",
                    "stop when no candidate's height is less certain than this, all taps seen; builds the height GP")
                  .in(Unit::metre)
                  .above(0));
  fields.real(
      expected_rmse,
      Field("expected_rmse",
            "stop when the error of the reconstructed scene, desk included, is most probably below this and, where "
            "the footprint knows of such things, most probably no object is left to find; never before one is "
            "touched; builds what the reconstruction needs")
          .in(Unit::metre)
          .above(0));
  fields.real(robot_time, Field("robot_time", "stop when the robot has been busy that long").in(Unit::second).above(0));
  fields.integer(
      failed_in_a_row,
      Field(
          "failed_in_a_row",
          "the run fails, for somebody to look at the arm, when so many taps in a row came to nothing; "
          "`unreachable` is none of them, nor, from any side, one that met nothing; not given, 3 where taps cannot be "
          "repeated, else never")
          .at_least(1)
          .at_most(100000)
          .from("an estimate: a robot that is well misses a tap, not three"));
}

void LogOptions::list(Fields& fields) {
  fields.choice(sync, Field("sync", "when the record is forced to disk"),
                {{"auto", "around each tap where a tap cannot be repeated, else never", {}},
                 {"tap", "after each tap, and before it where it cannot be repeated", {}},
                 {"none", "never", {}}});
  fields.flag(maps, Field("maps", "write the maps that each choice was made from: maps/tap_NNN.csv"));
  fields.flag(surface, Field("surface", "write surface.csv; false by default in a sweep"));
}

void ExperimentOptions::list(Fields& fields) {
  fields.integer(complete, Field("complete",
                                 "version of a record whose config.yaml has every option; one that it lacks is not at "
                                 "its default but at what it was before there was such an option")
                               .of_run()
                               .at_least(1)
                               .at_most(kRecordVersion)
                               .not_identifying());
  fields.text(name,
              Field("name", "of the experiment; the folder of its runs is a slug of it").of_run().not_identifying());
  fields.integer(seed, seed_field());
  fields.integer(taps, Field("taps", "budget of taps, the initial ones included").of_run().at_least(1).at_most(100000));
  fields.section(initial,
                 Field("initial", "the first taps, drawn from the candidates without replacement").of_strategy());
  fields.section(candidates,
                 Field("candidates", "the places among which the next tap is chosen: cell centres of a grid").of_run());
  fields.plugin(kernel, Field("kernel", "shape of the covariance, shared by both GPs").of_strategy().group());
  fields.section(height, Field("height", "the GP of the heights above the desk").of_strategy());
  fields.section(
      label,
      Field("label", "the GP of the labels: 1 on an object, 0 on the desk; its mean is the weight w of the paper")
          .of_strategy());
  fields.section(prior, Field("prior", "what a camera saw before the first tap; not given, nothing").of_run());
  fields.choice(
      surface,
      Field("surface", "how the surface is reconstructed; no shipped strategy's taps depend on it").of_strategy(),
      {{"single", "one GP for the heights of object and desk, as in the paper", {}},
       {"two_part", "heights from the taps on an object alone, where the footprint is at least 1/2; else desk", {}},
       {"implicit", "closed surfaces in space; for `scene.touch: any`, and only for that", {}}});
  if (surface == Surface::implicit && !space) space.emplace();
  fields.section(space, Field("space", "what is believed of `surface: implicit`").of_strategy());
  fields.section(engine, Field("engine", "how the posterior over the candidates is computed").of_strategy());
  fields.plugin(acquisition, Field("acquisition", "how much one wants to tap each candidate").of_strategy().group());
  fields.plugin(fitting, Field("fitting", "how hyperparameters are chosen, shared by both GPs").of_strategy().group());
  fields.plugin(footprint,
                Field("footprint", "where the objects are, as a probability at every place").of_strategy().group());
  fields.choice(fallback, Field("fallback", "what to do when every score is equal or none is positive").of_strategy(),
                {{"uncertainty", "tap where the height is least known", {}},
                 {"none", "tap the first candidate, as the paper's rule does: it stalls", {}}});
  fields.choice(repeat,
                Field("repeat", "may a candidate be tapped twice; failed ones never are, suspected outliers always")
                    .of_strategy(),
                {{"forbid", "no", {}}, {"allow", "yes, with independent noise", {}}});
  fields.real(tie_tolerance,
              Field("tie_tolerance", "scores within this times (|best| + the score's prior scale) of the best are tied")
                  .of_strategy()
                  .at_least(0)
                  .at_most(1)
                  .from("rounding reaches 1e-12; below 1e-9 it decides taps at 1.7 cm"));
  fields.section(stop, Field("stop", "reasons to stop before the budget is spent").of_strategy());
  fields.section(scene,
                 Field("scene", "what the world holds; a robot backend reads only area and desk").of_run().group());
  fields.plugin(backend, Field("backend", "what is tapped").of_run().with_beside("motion").group());
  fields.section(log, Field("log", "what is written").of_run().not_identifying());
  fields.require(
      initial.searches() || initial.count <= taps, "taps",
      fmt::format("the budget is smaller than the {} initial taps, raise it or lower initial.count", initial.count));
  const auto cells = [this](double side) {
    return candidates.spacing ? cells_along(side, *candidates.spacing) : static_cast<double>(*candidates.count);
  };
  const double columns = cells(scene.area.width);
  const double rows = cells(scene.area.depth);
  const bool any_side = scene.touch == SceneOptions::Touch::any;
  fields.require(any_side == (surface == Surface::implicit), "surface",
                 any_side ? "scene.touch: any needs surface: implicit, which strategy=any_side sets"
                          : "implicit needs a scene with touch: any");
  fields.require(!any_side || initial.design == InitialOptions::Design::random, "initial.design",
                 "must be random for taps from any side");
  if (any_side) refuse_what_is_from_above(*this, fields);
  fields.require(!space || surface == Surface::implicit, "space",
                 "applies to surface: implicit only, remove it for taps from above");
  fields.require(std::max(columns, rows) <= kMaxCellsPerSide, "candidates.spacing",
                 fmt::format("cuts the area into {} x {} cells, at most {} per side are possible", columns, rows,
                             kMaxCellsPerSide));
  fields.require(!initial.searches() || initial.smallest < std::min(scene.area.width, scene.area.depth),
                 "initial.smallest", "is not smaller than the sides of the area, give the least width of the object");
  fields.require(any_side || initial.searches() || static_cast<double>(initial.count) <= columns * rows,
                 "initial.count",
                 fmt::format("{} taps, but there are only {} candidates, take fewer first taps or more candidates",
                             initial.count, columns * rows));
}

Field seed_field() { return Field("seed", "fixes everything that is drawn").at_least(0).of_run(); }

std::vector<Field> keys_beside_options() {
  return {
      Field("defaults", "groups: '- kernel: rbf' reads kernel/rbf.yaml; later entries win, then this file")
          .of_strategy(),
      Field(kStrategy, "what decides where to tap and what is believed, by name: strategy/NAME.yaml, or a whole config")
          .of_strategy()
          .group(),
      Field("sweep", "what 'palpate sweep' varies; its blocks multiply with each other in their order").of_run(),
      Field("expect", "what the summary must say, for example first_hit_tap: '<= 9'; of a sweep, median(taps): '<= 17'")
          .of_run()
          .group()};
}

const ConfigKeys& config_keys() {
  static const ConfigKeys keys([](Fields& fields) {
    ExperimentOptions().list(fields);
    std::string no_option;
    for (const Field& field : keys_beside_options()) fields.text(no_option, field);
  });
  return keys;
}

}  // namespace palpate
