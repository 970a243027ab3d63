// SPDX-License-Identifier: MIT
#include "experiment/experiment_options.hpp"

#include "config/keys.hpp"
#include "gp/candidate_grid.hpp"

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
  only("repeat", options.repeat == usual.repeat);
  only("engine.accuracy", options.engine.accuracy == usual.engine.accuracy);
  only("log.maps", options.log.maps == usual.log.maps);
  only("prior", !options.prior);
  only("engine.threads", options.engine.threads == usual.engine.threads);
}

}  // namespace

void InitialOptions::list(Fields& fields) {
  const auto counted = [this](Fields& inner) {
    inner.integer(count, Field("count", "number of initial taps").at_least(1).from("Sun and Min 2021: 3"));
  };
  const auto until_hit = [this](Fields& inner) {
    inner.real(smallest, Field("smallest", "minimum width of the object to search for").in(Unit::metre).above(0));
  };
  fields.choice(
      design, Field("design", "design of the initial taps. No candidate is tapped twice"),
      {{"random", "uniformly random positions that depend only on the seed", counted},
       {"sobol", "Sobol sequence with a random shift from the seed", counted},
       {"grid", "square lattice", counted},
       {"search",
        "search for an object in as few taps as possible. The search ends at the first contact with an object",
        until_hit}});
}

void CandidateOptions::list(Fields& fields) {
  fields.real(spacing,
              Field("spacing", "side length of a grid cell; an alternative to `count`").in(Unit::metre).above(0));
  // The default belongs into the resolved config, unless spacing takes its place.
  if (!spacing && !count) count = kPaperCount;
  fields.integer(count, Field("count", "number of grid cells per side").at_least(1).at_most(kMaxCellsPerSide));
  fields.require(!(count && spacing), "spacing", "is given together with count, set one of them to none");
}

void ProcessOptions::list_plugins(Fields& fields) {
  fields.plugin(kernel, "kernel",
                Field("kernel", "kernel of this GP; not given: the top-level `kernel`").inherits("kernel"));
  fields.plugin(fitting, "fitting",
                Field("fitting", "fitting of this GP; not given: the top-level `fitting`").inherits("fitting"));
}

void OffsetOptions::list(Fields& fields) {
  fields.real(offset, Field("offset", "prior standard deviation of the constant height offset")
                          .in(Unit::metre)
                          .above(0)
                          .from("6 mm: absolute errors of Baxter's tip are 2 to 10 mm"));
  fields.real(drift, Field("drift", "prior standard deviation of the drift of the height offset over time")
                         .in(Unit::metre_per_second)
                         .above(0)
                         .from("1 mm/min: an arm that warms up, an estimate"));
  fields.real(noise, Field("noise", "standard deviation of the measured height of one contact with the desk")
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
  fields.real(noise, Field("noise", "standard deviation of the height noise of one tap")
                         .in(Unit::metre)
                         .at_least(0)
                         .at_most(kMostSignal));
  fields.real(outlier_probability, Field("outlier_probability",
                                         "prior probability that the height of a contact is an outlier; not given: no "
                                         "outliers. Requires `surface: two_part`")
                                       .above(0)
                                       .at_most(0.5));
  fields.section(offset, Field("offset",
                               "estimation of the height offset from taps on the desk. The offset is caused by the "
                               "motion and the arm; not given: heights are used as measured"));
  list_plugins(fields);
}

void LabelOptions::list(Fields& fields) {
  fields.real(signal,
              Field("signal", "prior standard deviation of the label").at_least(kLeastSignal).at_most(kMostSignal));
  fields.real(noise, Field("noise", "standard deviation of the noise of one label").at_least(0).at_most(kMostSignal));
  fields.real(prior_mean, Field("prior_mean", "prior mean of the label").from("Sun and Min 2021: 0"));
  fields.flag(
      clip, Field("clip",
                  "whether the weight is clipped to [0, 1] for acquisitions. The weight is the mean of the label GP"));
  fields.choice(hyperparameters, Field("hyperparameters", "source of the fitted hyperparameters of the label GP"),
                {{"own", "kernel and noise are fitted to the labels only", {}},
                 {"shared",
                  "kernel and noise-to-signal ratio are shared with the height GP and fitted to heights and labels "
                  "together. The signals stay separate",
                  {}}});
  list_plugins(fields);
  const bool shared = hyperparameters == Hyperparameters::shared;
  fields.require(!shared || !kernel, "kernel",
                 "has no effect with label.hyperparameters: shared, remove it or set label.hyperparameters: own");
  fields.require(!shared || !fitting, "fitting",
                 "has no effect with label.hyperparameters: shared, remove it or set label.hyperparameters: own");
}

void EngineOptions::list(Fields& fields) {
  fields.choice(type, Field("type", "algorithm that computes the posterior at the candidates"),
                {{"auto", "fastest engine with an error within `accuracy`", {}},
                 {"dense", "for any kernel. Time and memory grow with taps times candidates", {}},
                 {"grid",
                  "as exact as `dense`. Memory grows only with the number of candidates. Requires a separable kernel, "
                  "such as rbf",
                  {}},
                 {"lowrank",
                  "low-rank approximation. Time per tap grows only with the number of candidates. Requires a separable "
                  "kernel, such as rbf",
                  {}}});
  fields.real(tolerance, Field("tolerance",
                               "truncation threshold of `lowrank`. Along each axis, eigenvectors of the covariance "
                               "with a smaller share of the variance are dropped")
                             .above(0)
                             .at_most(1)
                             .from("keeps variances within 1e-12 and heights within 1e-9 of dense after 1000 taps"));
  fields.real(accuracy,
              Field("accuracy",
                    "maximum error of the engine that `type: auto` chooses, compared with `dense`. The error is "
                    "relative to the prior standard deviation or variance. The maximum is at most tie_tolerance / 10")
                  .at_least(0)
                  .at_most(1));
  fields.integer(threads,
                 Field("threads", "number of threads that update the maps. The number does not change the results")
                     .at_least(1)
                     .at_most(64)
                     .not_identifying());
}

void SideViewOptions::list(Fields& fields) {
  constexpr double kUpright = 3.14159265358979323846 / 2;
  fields.real(azimuth, Field("azimuth",
                             "azimuth of the camera, seen from the middle of the area and counter-clockwise from the x "
                             "axis; not given: drawn from the seed")
                           .in(Unit::radian));
  fields.real(elevation,
              Field("elevation", "elevation angle of the camera above the horizontal, seen from the middle of the area")
                  .in(Unit::radian)
                  .at_least(0)
                  .at_most(kUpright * (1 + 1e-12)));
  fields.integer(rays, Field("rays", "number of camera rays, rounded to a square number").at_least(16).at_most(40000));
}

void SpaceOptions::list(Fields& fields) {
  fields.integer(
      approaches,
      Field("approaches", "number of approaches drawn before each tap. The next tap is one of these approaches")
          .at_least(1)
          .at_most(100000));
  fields.integer(
      particles,
      Field("particles", "number of particles. A particle is one hypothesis of the scene, made of simple solids")
          .at_least(2)
          .at_most(1000));
  fields.integer(
      moves,
      Field("moves",
            "number of Monte Carlo moves per particle after each tap. The moves fit the particle to the contacts")
          .at_least(0)
          .at_most(100000));
  fields.real(
      model_discrepancy,
      Field("model_discrepancy", "standard deviation between the objects' surfaces and the simple solids of the model")
          .in(Unit::metre)
          .at_least(1e-6));
  fields.section(view, Field("view",
                             "view of a camera at 60 cm distance, taken before the first tap; not given: no view. "
                             "Requires `backend: simulator`"));
}

void StopOptions::list(Fields& fields) {
  fields.real(max_standard_deviation, Field("max_standard_deviation",
                                            "bound on the standard deviation of the height. The run stops when no "
                                            "candidate exceeds the bound. The bound adds the height GP to the models")
                                          .in(Unit::metre)
                                          .above(0));
  fields.real(
      expected_rmse,
      Field("expected_rmse",
            "bound on the expected RMSE of the scene, desk included. The run stops when the expected RMSE is most "
            "probably below the bound, an object was touched, and, if the footprint can tell, most probably no "
            "object is left to find. The bound adds the models of the reconstruction")
          .in(Unit::metre)
          .above(0));
  fields.real(robot_time, Field("robot_time", "robot time after which the run stops").in(Unit::second).above(0));
  fields.integer(failed_in_a_row, Field("failed_in_a_row",
                                        "number of consecutive failed taps at which the run fails; not given: 3 if the "
                                        "backend cannot repeat a tap, else no limit. A tap that is `unreachable` does "
                                        "not count, nor does a tap from any side that meets nothing")
                                      .at_least(1)
                                      .at_most(100000)
                                      .from("an estimate: a healthy robot may fail one tap, but not three in a row"));
}

void LogOptions::list(Fields& fields) {
  fields.choice(sync, Field("sync", "times at which the record is forced to disk"),
                {{"auto", "before and after each tap if the backend cannot repeat a tap, else never", {}},
                 {"tap", "after each tap. If the backend cannot repeat a tap, also before each tap", {}},
                 {"none", "never", {}}});
  fields.flag(maps, Field("maps", "whether to write the maps used to choose each tap to maps/tap_NNN.csv"));
  fields.flag(
      surface,
      Field("surface", "whether to write the reconstructed surface to surface.csv. In a sweep the default is false"));
}

void ExperimentOptions::list(Fields& fields) {
  fields.integer(complete, Field("complete",
                                 "record version that palpate writes into config.yaml. With this key, an option "
                                 "missing in the file means the behaviour before the option existed")
                               .of_run()
                               .at_least(1)
                               .at_most(kRecordVersion)
                               .not_identifying());
  fields.text(name,
              Field("name", "name of the experiment. The name, as a slug, is also the name of the folder for the runs")
                  .of_run()
                  .not_identifying());
  fields.integer(seed, Field("seed", "seed of all random draws").at_least(0).of_run());
  fields.integer(
      taps, Field("taps", "maximum number of taps, the initial taps included").of_run().at_least(1).at_most(100000));
  fields.section(initial,
                 Field("initial", "initial taps, drawn from the candidates without replacement").of_strategy());
  fields.section(
      candidates,
      Field("candidates", "grid of candidates. A candidate is a cell centre and a possible position of the next tap")
          .of_run());
  fields.plugin(kernel,
                Field("kernel", "covariance kernel, shared by the height GP and the label GP").of_strategy().group());
  fields.section(
      height,
      Field("height", "settings of the height GP, the Gaussian process of the heights above the desk").of_strategy());
  fields.section(label, Field("label",
                              "settings of the label GP, the Gaussian process of the contact labels. A label is 1 on "
                              "an object and 0 on the desk. The mean of the label GP is the weight w of the paper")
                            .of_strategy());
  fields.section(prior, Field("prior", "view of a depth camera before the first tap; not given: no view").of_run());
  fields.choice(surface,
                Field("surface",
                      "method of surface reconstruction. The method does not change the taps of the shipped strategies")
                    .of_strategy(),
                {{"single", "one GP for the heights of object and desk, as in the paper", {}},
                 {"two_part",
                  "one GP for the heights of taps on objects. This GP gives the surface where the footprint's "
                  "probability is at least 1/2. Elsewhere, the surface is the desk",
                  {}},
                 {"implicit", "closed surfaces in 3-D space. Requires `scene.touch: any`", {}}});
  if (surface == Surface::implicit && !space) space.emplace();
  fields.section(space, Field("space", "model settings of `surface: implicit`").of_strategy());
  fields.section(
      engine, Field("engine", "settings of the engine, which computes the posterior at the candidates").of_strategy());
  fields.plugin(
      acquisition,
      Field("acquisition", "acquisition function, which scores a tap at each candidate").of_strategy().group());
  fields.plugin(
      fitting,
      Field("fitting", "method that sets the hyperparameters of the height GP and the label GP").of_strategy().group());
  fields.plugin(footprint, Field("footprint", "model of the footprint, the probability of an object at every position")
                               .of_strategy()
                               .group());
  fields.choice(fallback,
                Field("fallback", "choice of the tap if all scores are equal or no score is positive").of_strategy(),
                {{"uncertainty", "candidate with the largest height uncertainty", {}},
                 {"none", "first candidate, as in the paper. The search may stall", {}}});
  fields.choice(repeat,
                Field("repeat",
                      "rule for repeated taps of one candidate. Failed candidates are never repeated, and suspected "
                      "outliers may always be repeated")
                    .of_strategy(),
                {{"forbid", "each candidate is tapped at most once", {}},
                 {"allow", "candidates may be tapped again, with independent noise", {}}});
  fields.real(
      tie_tolerance,
      Field("tie_tolerance",
            "relative tolerance of ties. A score is tied with the best score if the difference is at most tolerance "
            "times (|best score| + prior scale of the scores)")
          .of_strategy()
          .at_least(0)
          .at_most(1)
          .from(
              "rounding errors reach 1e-12; with tolerances below 1e-9 they decide taps at a length scale of 1.7 cm"));
  fields.section(stop, Field("stop", "conditions that stop a run before its tap budget is spent").of_strategy());
  fields.section(
      scene,
      Field("scene", "scene with area, desk and objects. A robot backend reads only area and desk").of_run().group());
  fields.plugin(backend, Field("backend", "backend that makes the taps, for example a simulator, a robot or a program")
                             .of_run()
                             .with_beside("motion")
                             .group());
  fields.section(log, Field("log", "settings of the record that a run writes").of_run().not_identifying());
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
                 fmt::format("{} taps, but there are only {} candidates, use fewer initial taps or more candidates",
                             initial.count, columns * rows));
}

std::vector<Field> keys_beside_options() {
  return {Field("defaults",
                "list of config groups to read, for example '- kernel: rbf' for kernel/rbf.yaml. Later entries "
                "override earlier entries, and this file overrides all entries")
              .of_strategy(),
          Field(kStrategy,
                "strategy, which sets the choice of taps and the models. The value is NAME for strategy/NAME.yaml, or "
                "the path of a config file")
              .of_strategy()
              .group(),
          Field("sweep",
                "keys and values that 'palpate sweep' varies. Jobs are all combinations of the blocks, in the order of "
                "the blocks")
              .of_run(),
          Field("expect",
                "expected values of summary fields, for example first_hit_tap: '<= 9'. For a sweep, statistics are "
                "possible, for example median(taps): '<= 17'")
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
