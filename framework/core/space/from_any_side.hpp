// SPDX-License-Identifier: MIT
// An experiment whose tool comes from any side: closed surfaces in space.
#pragma once

#include "experiment/experiment.hpp"
#include "experiment/from_above.hpp"
#include "space/cloud.hpp"
#include "space/space_belief.hpp"

#include <palpate/acquisition.hpp>

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

class FromAnySide final : public Experiment {
 public:
  /// Throws Error as Experiment does, and where backend or acquisition only know taps from above.
  FromAnySide(const ExperimentOptions& options, const PluginFactory& factory, const std::atomic<bool>* interrupted,
              std::shared_ptr<Backend> backend = nullptr, const std::string& directory = {});

  std::optional<TapRecord> choose_next(const Wish* wish = nullptr) override;
  void observe(const PastTap& tap) override;
  void resume(const std::vector<PastTap>& past) override;
  void stop(const std::string& reason) override { result_.stop_reason = reason; }
  const RunResult& counts() const override { return result_; }
  RunResult result() override;
  Errors errors() override;
  void ask(Quantities) override {}
  Preview preview(const TapRecord& tap) const override;
  std::vector<ModelReader> readers() const override;

  const SpaceBelief& belief() const { return belief_; }
  /// The surface as points with normals and standard deviations, a PLY file in ASCII.
  std::string surface_ply();

 private:
  void update() override;
  std::optional<std::string> stop_rule(Source source) override;
  void read(TapRecord& tap) override;
  /// Until an object is hit there is no surface to poke: what is believed then is anywhere.
  bool starting() const { return result_.taps < options_.initial.count || !result_.first_hit_tap; }
  /// The scene's own surface; empty where another world is tapped.
  const Cloud& truth();

  SpaceBelief belief_;
  std::shared_ptr<Acquisition> acquisition_;
  Bundle bundle_;  ///< by which surfaces are compared
  std::optional<Cloud> truth_;
  RunResult result_;
  int updated_ = -1;  ///< taps that the belief has taken in
};

/// The experiment that a config asks for.
std::unique_ptr<Experiment> make_experiment(const ExperimentOptions& options, const PluginFactory& factory,
                                            const std::atomic<bool>* interrupted,
                                            std::shared_ptr<Backend> backend = nullptr,
                                            const std::string& directory = {});

/// An experiment that taps from above. Throws Error, its place `where`, for another.
FromAbove& from_above_of(Experiment& experiment, const std::string& where);

}  // namespace palpate
