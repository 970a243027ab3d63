// SPDX-License-Identifier: MIT
// Every top-level key of a config, with its default and its meaning.
#pragma once

#include "config/compose.hpp"
#include "scene/scene_options.hpp"

#include <palpate/options.hpp>
#include <palpate/plugin.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

struct InitialOptions : Options {
  enum class Design { random, sobol, grid, search };
  Design design = Design::random;
  std::int64_t count = 3;  ///< number of taps; not used by the search
  double smallest = 0.02;  ///< smallest object that the search finds, metres
  bool searches() const { return design == Design::search; }
  void list(Fields& fields) override;
};

/// If both options are absent, the belief uses its own default. At most one of the two options may be set.
struct CandidateOptions : Options {
  std::optional<std::int64_t> count;
  std::optional<double> spacing;
  void list(Fields& fields) override;
};

struct StopOptions : Options {
  std::optional<double> max_standard_deviation;
  std::optional<double> expected_rmse;
  std::optional<double> robot_time;
  std::optional<std::int64_t> failed_in_a_row;
  void list(Fields& fields) override;
};

struct LogOptions : Options {
  enum class Sync { automatic, tap, none };
  Sync sync = Sync::automatic;
  bool maps = false;
  bool surface = true;
  void list(Fields& fields) override;
};

/// Rules for the choice of a tap by its score.
struct ChoiceOptions : Options {
  enum class Fallback { uncertainty, none };
  enum class Repeat { forbid, allow };
  Fallback fallback = Fallback::uncertainty;
  Repeat repeat = Repeat::forbid;
  double tie_tolerance = 1e-8;
  void list(Fields& fields) override;
};

struct ExperimentOptions : Options {
  std::int64_t complete = kRecordVersion;
  std::string name = "experiment";
  std::int64_t seed = 1;
  std::int64_t taps = 17;
  InitialOptions initial;
  CandidateOptions candidates;
  PluginChoice kernel{"kernel", {}, nullptr};
  PluginChoice fitting{"fitting", "fixed", nullptr};
  PluginChoice acquisition{"acquisition", {}, nullptr};
  ChoiceOptions choice;
  PluginChoice belief{"belief", "height_map", nullptr};
  PluginChoice backend{"backend", {}, nullptr};
  SceneOptions scene;
  StopOptions stop;
  LogOptions log;

  void list(Fields& fields) override;
};

/// Returns the options of the run that a belief needs in addition to its own options.
RunSettings run_settings(const ExperimentOptions& options);

/// Returns an option of the belief by its dotted path, as in the resolved config: the text of a value, "{}" for a
/// group, "" if absent.
std::string belief_option(const ExperimentOptions& options, const char* path);

/// Returns the type of the backend's motion; "" for a backend without one.
std::string motion_name(const ExperimentOptions& options);

/// Returns the top-level keys of a config that are not among ExperimentOptions, with their descriptions.
std::vector<Field> keys_beside_options();

/// Returns the properties of all config keys. The composition of configs needs these properties.
class ConfigKeys;
const ConfigKeys& config_keys();

}  // namespace palpate
