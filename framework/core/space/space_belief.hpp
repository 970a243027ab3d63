// SPDX-License-Identifier: MIT
// What the touches so far say of surfaces in space: compositions of simple solids, the skin that corrects the best of
// them, and what they say of the approaches among which the next tap is chosen.
#pragma once

#include "experiment/experiment_options.hpp"
#include "space/cloud.hpp"
#include "space/overtravel.hpp"
#include "space/skin.hpp"
#include "space/solids.hpp"
#include "space/surface_touch.hpp"

#include <palpate/backend.hpp>
#include <palpate/plugin.hpp>
#include <palpate/surface_belief.hpp>

#include <map>
#include <optional>
#include <string>
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

  /// Takes in what was seen before the first tap.
  void look(const std::vector<SurfaceTouch>& seen);

  /// Takes in a tap. Of one that failed nothing is learnt. All contacts so far are read again by what it tells of how
  /// deep they come.
  void observe(const Approach& approach, const Contact& contact);
  /// Whether a contact is with an object, not the desk, as it is read before it is taken in.
  bool on_object(const Approach& approach, const Contact& contact) const;

  /// Has the models take in what was observed, draws the approaches of the next tap, and says of them what of
  /// deviation, std_reduction and expected_discovery is in `reads`.
  void update(Quantities reads);

  /// Which of the lines that the last update() drew the backend refused, "" for none: in hex, a digit for four lines in
  /// their order, the first of them its bit of 8; digits behind the last refused line are left out.
  const std::string& unreached() const { return unreached_; }
  /// Has the lines for tap `tap` be refused as it was recorded then: the backend is not asked.
  void recall(int tap, const std::string& unreached) { recalled_[tap] = unreached; }

  // SurfaceBelief, as of the last update().
  const std::vector<Approach>& approaches() const override { return approaches_; }
  /// The one of them along the same line, the first where there is none.
  int find(const Approach& approach) const;
  int taps() const override { return taps_; }
  const Eigen::VectorXd& way() const override { return met_; }
  const Eigen::VectorXd& expected_discovery() const override { return unseen_; }
  const Eigen::VectorXd& std_reduction() const override { return reduction_; }
  const Eigen::VectorXd& deviation() const override { return deviation_; }
  const Eigen::VectorXd& incidence_cosine() const override { return incidence_cosine_; }

  const Region& region() const { return region_; }
  const Solids& solids() const { return solids_; }
  const Skin& skin() const { return skin_; }
  /// How many variances of the last update() rounding had taken below 0.
  int variances_clamped() const { return clamped_; }
  /// What rounding made necessary in the skin, as of the last update(), and in all reductions so far; square metres.
  FactorReport factors() const;
  /// As they are read now, those that were seen first.
  const std::vector<SurfaceTouch>& touches() const { return touches_; }
  /// Contacts with an object, and the number of the first tap that made one.
  struct Hits {
    int count = 0;
    std::optional<int> first;
  };
  Hits hits() const;
  /// Returns the contacts so far whose label is not what on_object() said before they were observed, by ascending tap.
  std::vector<Relabelled> relabelled() const;
  const Overtravel& overtravel() const { return overtravel_; }
  /// How far a tool comes along an approach if a composition is the truth.
  double meeting(const Approach& approach, const Composition& composition) const;

  /// The surface where lines from all sides first meet it, at most one point in a cube of `side`; its mesh: mesh.hpp.
  Cloud surface(const Bundle& bundle, double side) const;
  /// By how much the surface may be off near such points of it, metres, standard deviations: what the skin leaves open,
  /// and how far from the most probable composition the others have it there, none more than 2 cm.
  Eigen::VectorXd uncertainty(const Cloud& surface) const;

 private:
  struct Told {
    SurfaceTouch touch;
    double force;
    int tap;         ///< its number, from 1
    bool on_object;  ///< as it is read when it is made
  };
  Told told(const Approach& approach, const Contact& contact) const;
  void draw_approaches();
  void look_where_met();
  void look_at_deviations();
  void look_for_reductions();
  void look_for_unseen();
  /// An approach's line, above a desk at 0.
  Line line_of(const Approach& approach) const;
  Line random_line(Random& random) const;
  std::optional<Line> along_normal(Random& random) const;

  const Context& context_;
  const Backend& backend_;
  Region region_;
  double desk_;
  std::size_t count_;
  Solids solids_;
  Skin skin_;
  const double misfit_, noise_;  ///< of contacts that err by no more than the least, metres
  Overtravel overtravel_;
  std::vector<Told> told_;  ///< of touches_ those that were made, as the arm told them
  std::vector<SurfaceTouch> touches_;
  bool read_again_ = false;  ///< some that the solids have taken in are read otherwise now
  int taps_ = 0;
  std::size_t seen_ = 0;      ///< of the touches, before the first tap
  std::size_t taken_in_ = 0;  ///< of the touches, by the solids
  std::vector<Approach> approaches_;
  std::string unreached_;
  std::map<int, std::string> recalled_;  ///< by the number of the tap
  Eigen::VectorXd met_;  ///< how far along each approach the most probable composition is met, or else the end is
  Skin::Places places_;  ///< where it is met
  std::vector<Eigen::Index> meets_;  ///< the approaches that meet it there
  Eigen::VectorXd incidence_cosine_, deviation_, reduction_, unseen_;
  int clamped_ = 0;
  FactorReport reduced_;
};

}  // namespace palpate
