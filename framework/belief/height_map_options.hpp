// SPDX-License-Identifier: MIT
// The options of the belief `height_map`.
#pragma once

#include "belief/camera_view.hpp"

#include <palpate/options.hpp>

#include <cstdint>
#include <optional>

namespace palpate {

/// Options of one GP: heights are in metres, labels have no unit.
struct GpOptions : Options {
  double signal = 1.0;
  double noise = 1e-4;
  std::optional<PluginChoice> kernel;
  std::optional<PluginChoice> fitting;

 protected:
  void list_plugins(Fields& fields);
};

/// Prior standard deviations of the offset that is estimated from the desk: see offset_model.hpp.
struct OffsetOptions : Options {
  double offset = 0.006;        ///< metres
  double drift = 0.001 / 60.0;  ///< metres per second
  double noise = 0.002;         ///< metres
  void list(Fields& fields) override;
};

struct HeightGpOptions : GpOptions {
  std::optional<OffsetOptions> offset;        ///< absent: heights are used as measured
  std::optional<double> outlier_probability;  ///< absent: no contact is an outlier
  void list(Fields& fields) override;
};

struct LabelGpOptions : GpOptions {
  enum class HyperparameterSource { own, shared };
  double prior_mean = 0.0;
  bool clip = false;
  HyperparameterSource hyperparameters = HyperparameterSource::own;
  void list(Fields& fields) override;
};

/// Options of the engine, which computes the posterior at the candidates.
struct EngineOptions : Options {
  enum class Type { automatic, dense, grid, lowrank };
  Type type = Type::automatic;
  double tolerance = 1e-15;
  double accuracy = 1e-9;
  std::int64_t threads = 1;
  void list(Fields& fields) override;
};

struct HeightMapOptions : Options {
  enum class Surface { single, two_part };
  HeightGpOptions height;
  LabelGpOptions label;
  PluginChoice footprint{"footprint", "gp_regression", nullptr};
  Surface surface = Surface::single;
  EngineOptions engine;
  std::optional<PriorOptions> prior;  ///< absent: no camera view before the first tap
  void list(Fields& fields) override;
};

}  // namespace palpate
