// SPDX-License-Identifier: MIT
// Every top-level key of a config, with its default and its meaning.
#pragma once

#include "config/compose.hpp"
#include "scene/scene_options.hpp"
#include "view/view.hpp"

#include <palpate/options.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

struct InitialOptions : Options {
  enum class Design { random, sobol, grid, search };
  Design design = Design::random;
  std::int64_t count = 3;  ///< of all designs but the search
  double smallest = 0.02;  ///< of the search
  bool searches() const { return design == Design::search; }
  void list(Fields& fields) override;
};

/// One of the two, once listed.
struct CandidateOptions : Options {
  std::optional<std::int64_t> count;
  std::optional<double> spacing;
  void list(Fields& fields) override;
};

/// What a process has of its own: the heights' in metres, the labels' without unit.
struct ProcessOptions : Options {
  double signal = 1.0;
  double noise = 1e-4;
  std::optional<PluginChoice> kernel;
  std::optional<PluginChoice> fitting;

 protected:
  void list_plugins(Fields& fields);
};

/// Prior standard deviations of the offset that is estimated from the desk: see systematic.hpp.
struct OffsetOptions : Options {
  double offset = 0.006;        ///< metres
  double drift = 0.001 / 60.0;  ///< metres a second
  double noise = 0.002;         ///< metres
  void list(Fields& fields) override;
};

struct HeightOptions : ProcessOptions {
  std::optional<OffsetOptions> offset;        ///< absent: heights are used as measured
  std::optional<double> outlier_probability;  ///< absent: no contact is an outlier
  void list(Fields& fields) override;
};

struct LabelOptions : ProcessOptions {
  enum class Hyperparameters { own, shared };
  double prior_mean = 0.0;
  bool clip = false;
  Hyperparameters hyperparameters = Hyperparameters::own;
  void list(Fields& fields) override;
};

/// How the posterior over the candidates is computed.
struct EngineOptions : Options {
  enum class Type { automatic, dense, grid, lowrank };
  Type type = Type::automatic;
  double tolerance = 1e-15;
  double accuracy = 1e-9;
  std::int64_t threads = 1;
  void list(Fields& fields) override;
};

/// What a camera saw before the first tap, where the tool comes from any side: see space/view.hpp.
struct SideViewOptions : Options {
  std::optional<double> azimuth;  ///< radians; absent: drawn from the seed
  double elevation = 35.0 / 180.0 * 3.14159265358979323846;
  std::int64_t rays = 400;
  void list(Fields& fields) override;
};

/// Of `surface: implicit`: see space/.
struct SpaceOptions : Options {
  std::int64_t approaches = 2000;
  std::int64_t particles = 24;
  std::int64_t moves = 1000;
  double model_discrepancy = 0.002;  ///< metres
  std::optional<SideViewOptions> view;
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

struct ExperimentOptions : Options {
  enum class Surface { single, two_part, implicit };
  enum class Fallback { uncertainty, none };
  enum class Repeat { forbid, allow };

  std::int64_t complete = kRecordVersion;
  std::string name = "experiment";
  std::int64_t seed = 1;
  std::int64_t taps = 17;
  InitialOptions initial;
  CandidateOptions candidates;
  PluginChoice kernel{"kernel", {}, nullptr};
  HeightOptions height;
  LabelOptions label;
  std::optional<PriorOptions> prior;  ///< absent: nothing was seen before the first tap
  Surface surface = Surface::single;
  std::optional<SpaceOptions> space;  ///< of `surface: implicit`, always
  EngineOptions engine;
  PluginChoice acquisition{"acquisition", {}, nullptr};
  PluginChoice fitting{"fitting", "fixed", nullptr};
  PluginChoice footprint{"footprint", "gp_regression", nullptr};
  Fallback fallback = Fallback::uncertainty;
  Repeat repeat = Repeat::forbid;
  double tie_tolerance = 1e-8;
  StopOptions stop;
  SceneOptions scene;
  PluginChoice backend{"backend", {}, nullptr};
  LogOptions log;

  void list(Fields& fields) override;
};

/// The keys that a config has beside these options, for those who read them: what each is for.
std::vector<Field> keys_beside_options();

/// What the lists of all these say to those who compose configs.
class ConfigKeys;
const ConfigKeys& config_keys();

}  // namespace palpate
