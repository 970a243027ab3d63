// SPDX-License-Identifier: MIT
#include "experiment/experiment_options.hpp"

#include "belief/height_map_options.hpp"
#include "config/keys.hpp"
#include "config/tree.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace palpate {

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
  fields.integer(count, Field("count",
                              "number of candidates; of a grid, number of cells per side. Not given: the belief's own, "
                              "47 cells per side for height_map and 2000 lines for solids")
                            .within(1, 100000));
  fields.require(!(count && spacing), "spacing", "is given together with count, set one of them to none");
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
                                      .within(1, 100000)
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

void ChoiceOptions::list(Fields& fields) {
  fields.choice(fallback, Field("fallback", "choice of the tap if all scores are equal or no score is positive"),
                {{"uncertainty", "candidate with the largest height uncertainty", {}},
                 {"none", "first candidate, as in the paper. The search may stall", {}}});
  fields.choice(repeat,
                Field("repeat",
                      "rule for repeated taps of one candidate. Failed candidates are never repeated, and suspected "
                      "outliers may always be repeated"),
                {{"forbid", "each candidate is tapped at most once", {}},
                 {"allow", "candidates may be tapped again, with independent noise", {}}});
  fields.real(
      tie_tolerance,
      Field("tie_tolerance",
            "relative tolerance of ties. A score is tied with the best score if the difference is at most tolerance "
            "times (|best score| + prior scale of the scores)")
          .within(0, 1)
          .from(
              "rounding errors reach 1e-12; with tolerances below 1e-9 they decide taps at a length scale of 1.7 cm"));
}

void ExperimentOptions::list(Fields& fields) {
  fields.integer(complete, Field("complete",
                                 "record version that palpate writes into config.yaml. With this key, an option "
                                 "missing in the file means the behaviour before the option existed")
                               .of_run()
                               .within(1, kRecordVersion)
                               .not_identifying());
  fields.text(name,
              Field("name", "name of the experiment. The name, as a slug, is also the name of the folder for the runs")
                  .of_run()
                  .not_identifying());
  fields.integer(seed, Field("seed", "seed of all random draws").at_least(0).of_run());
  fields.integer(taps, Field("taps", "maximum number of taps, the initial taps included").of_run().within(1, 100000));
  fields.section(initial,
                 Field("initial", "initial taps, drawn from the candidates without replacement").of_strategy());
  fields.section(candidates, Field("candidates",
                                   "candidates, the possible next taps. Taps from above have a grid of positions, and "
                                   "taps from any side have lines that are drawn before each tap")
                                 .of_run());
  fields.plugin(kernel,
                Field("kernel", "covariance kernel of the Gaussian processes of the belief").of_strategy().group());
  fields.plugin(fitting,
                Field("fitting", "method that sets the hyperparameters of the Gaussian processes of the belief")
                    .of_strategy()
                    .group());
  fields.plugin(
      acquisition,
      Field("acquisition", "acquisition function, which scores a tap at each candidate").of_strategy().group());
  fields.section(choice, Field("choice", "rules that choose a tap by the scores of the acquisition").of_strategy());
  fields.plugin(
      belief,
      Field("belief", "model of the scene, which learns from the taps and offers the candidates").of_strategy());
  fields.plugin(backend, Field("backend", "backend that makes the taps, for example a simulator, a robot or a program")
                             .of_run()
                             .with_beside("motion")
                             .group());
  fields.section(
      scene,
      Field("scene", "scene with area, desk and objects. A robot backend reads only area and desk").of_run().group());
  fields.section(stop, Field("stop", "conditions that stop a run before its tap budget is spent").of_strategy());
  fields.section(log, Field("log", "settings of the record that a run writes").of_run().not_identifying());
  fields.require(
      initial.searches() || initial.count <= taps, "taps",
      fmt::format("the budget is smaller than the {} initial taps, raise it or lower initial.count", initial.count));
  fields.require(!initial.searches() || initial.smallest < std::min(scene.area.width, scene.area.depth),
                 "initial.smallest", "is not smaller than the sides of the area, give the least width of the object");
}

RunSettings run_settings(const ExperimentOptions& options) {
  return {options.kernel,
          options.fitting,
          options.candidates.count,
          options.candidates.spacing,
          options.taps,
          options.choice.tie_tolerance};
}

namespace {

/// Returns an option of a plugin by its dotted path: the text of a value, "{}" for a group, "" if absent.
std::string option_text(const PluginChoice& plugin, const char* path) {
  const Tree* const found = plugin.options != nullptr ? plugin.options->find_path(path) : nullptr;
  return found == nullptr ? "" : found->is_scalar() ? found->text : "{}";
}

}  // namespace

std::string belief_option(const ExperimentOptions& options, const char* path) {
  return option_text(options.belief, path);
}

std::string motion_name(const ExperimentOptions& options) { return option_text(options.backend, "motion.type"); }

std::vector<Field> keys_beside_options() {
  return {
      Field("defaults",
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
      Field("tune",
            "keys and ranges among which 'palpate tune' searches for the best setting, the metric, and the number of "
            "runs")
          .of_run(),
      Field("compare", "comparison that 'palpate sweep' records before the first run, or none").of_run(),
      Field("expect",
            "expected values of summary fields, for example first_hit_tap: '<= 9'. For a sweep, statistics are "
            "possible, for example median(taps): '<= 17'")
          .of_run()
          .group()};
}

const ConfigKeys& config_keys() {
  static const ConfigKeys keys([](Fields& fields) {
    ExperimentOptions().list(fields);
    // Composing loads no plugin, so only the groups and inherited keys of the built-in belief are known here.
    HeightMapOptions height_map;
    fields.section(height_map, Field("belief", "").of_strategy());
    std::string no_option;
    for (const Field& field : keys_beside_options()) fields.text(no_option, field);
  });
  return keys;
}

}  // namespace palpate
