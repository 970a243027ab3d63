// SPDX-License-Identifier: MIT
// What the touches so far say of surfaces in space: compositions of simple solids, the skin that corrects the best of
// them, and what they say of the approaches among which the next tap is chosen.
#pragma once

#include "experiment/experiment_options.hpp"
#include "space/cloud.hpp"
#include "space/skin.hpp"
#include "space/solids.hpp"
#include "space/surface_touch.hpp"

#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>
#include <palpate/surface_belief.hpp>

#include <optional>
#include <vector>

namespace palpate {

/// The ball in which objects are looked for: over the middle of the area, resting on the desk.
struct Region {
  Region(const Area& area, double desk);
  Eigen::Vector3d centre;
  double radius = 0.0;  ///< metres
  /// Where an approach begins: so far from the centre.
  double outside() const { return 1.5 * radius; }
};

class SpaceBelief final : public SurfaceBelief {
 public:
  /// `context` and `backend` must outlive it; the backend is asked which approaches it reaches. Throws Error where it
  /// reaches none.
  SpaceBelief(const ExperimentOptions& options, const Context& context, const Backend& backend);

  /// Takes in a tap. Of one that failed nothing is learnt.
  void observe(const Approach& approach, const Contact& contact);

  /// Has the models take in what was observed, draws the approaches of the next tap, and says of them what of meetings
  /// and deviation is in `reads`.
  void update(Quantities reads);

  // SurfaceBelief, as of the last update().
  const std::vector<Approach>& approaches() const override { return approaches_; }
  int taps() const override { return taps_; }
  const Eigen::MatrixXd& meetings() const override { return meetings_; }
  const Eigen::MatrixXd& differences() const override { return differences_; }
  const Eigen::VectorXd& deviation() const override { return deviation_; }
  const Eigen::VectorXd& squareness() const override { return squareness_; }

  const Region& region() const { return region_; }
  const Solids& solids() const { return solids_; }
  const Skin& skin() const { return skin_; }
  const std::vector<SurfaceTouch>& touches() const { return touches_; }
  /// How far along a line the desk is, infinity where it is not.
  double desk_along(const Line& line) const;

  /// A point of the surface that is believed, its normal, and how uncertain it is along that.
  struct SurfacePoint {
    Eigen::Vector3d at, normal;
    double deviation = 0.0;
  };
  /// The surface where lines from all sides first meet it, at most one point in a cube of `side`.
  std::vector<SurfacePoint> surface(const Bundle& bundle, double side) const;

 private:
  void draw_approaches();
  void compare_compositions();
  void look_where_met();
  Line random_line(Random& random) const;
  std::optional<Line> along_normal(Random& random) const;

  const Context& context_;
  const Backend& backend_;
  Region region_;
  double desk_;
  std::size_t count_;
  Solids solids_;
  Skin skin_;
  std::vector<SurfaceTouch> touches_;
  int taps_ = 0;
  std::size_t taken_in_ = 0;  ///< of the touches, by the solids
  std::vector<Approach> approaches_;
  Eigen::MatrixXd meetings_, differences_;
  Eigen::VectorXd deviation_, squareness_;
};

}  // namespace palpate
