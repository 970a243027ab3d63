// SPDX-License-Identifier: MIT
// An experiment whose tool comes from any side: closed surfaces in space.
#pragma once

#include "experiment/experiment.hpp"
#include "experiment/from_above.hpp"
#include "space/cloud.hpp"
#include "space/contours.hpp"
#include "space/mesh.hpp"
#include "space/space_belief.hpp"
#include "space/volume.hpp"

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

  /// Has the lines among which tap `tap` was chosen be those that its record tells of: what a backend reaches is not
  /// asked. Those of other taps are all reached by a backend that stands in for one.
  void recall(int tap, const std::string& unreached) { belief_.recall(tap, unreached); }

  const SpaceBelief& belief() const { return belief_; }
  /// Whether an object was seen or hit: before that the surface is anywhere.
  bool knows_object() const { return object_seen_ || result_.first_hit_tap; }
  /// What the acquisition gives each of the approaches among which the next tap would be chosen; 0 where it
  /// is not asked.
  Eigen::VectorXd scores();
  /// The surface that is believed, for a mesh of such cubes; none before an object is known.
  Crossings crossings(double side);
  /// Its finest mesh, then without vertices, with normals and standard deviations, a PLY file.
  std::string surface_ply();
  /// What is truly there as of now, relative to the desk; empty where another world is tapped.
  struct TrueSurface {
    Cloud cloud;        ///< the surface, a point in a cube of 1 mm
    Cubes::Held cubes;  ///< what is solid
  };
  const TrueSurface& truth();
  /// Lines on what is truly there as of now, for a picture; none where another world is tapped.
  std::vector<Ring> true_contours();

 private:
  void update() override;
  std::optional<std::string> stop_rule(Source source) override;
  void read(TapRecord& tap) override;
  /// Until an object is seen or hit there is no surface to poke: what is believed then is anywhere.
  bool starting() const { return !object_seen_ && (result_.taps < options_.initial.count || !knows_object()); }
  void look();
  /// The scene as it stands, some of it pushed by now.
  const Scene& scene_now();
  /// Of the 95 % intervals of such a surface.
  std::optional<double> coverage(const Cloud& surface);

  SpaceBelief belief_;
  std::shared_ptr<Acquisition> acquisition_;
  bool object_seen_ = false;             ///< in a view before the first tap
  Bundle bundle_;                        ///< by which surfaces are compared
  Cubes cubes_;                          ///< by which volumes are
  std::unique_ptr<const Scene> pushed_;  ///< where something was pushed
  int now_taps_ = 0;                     ///< taps that it stands after
  std::optional<TrueSurface> truth_;     ///< of the same
  RunResult result_;
  int updated_ = -1;  ///< taps that the belief has taken in
};

/// The line of a tap from any side. Throws Error where a record has lost it.
const Approach& approach_of(const PastTap& tap);

/// The experiment that a config asks for.
std::unique_ptr<Experiment> make_experiment(const ExperimentOptions& options, const PluginFactory& factory,
                                            const std::atomic<bool>* interrupted,
                                            std::shared_ptr<Backend> backend = nullptr,
                                            const std::string& directory = {});

/// An experiment that taps from above. Throws Error, its place `where`, for another.
FromAbove& from_above_of(Experiment& experiment, const std::string& where);

}  // namespace palpate
