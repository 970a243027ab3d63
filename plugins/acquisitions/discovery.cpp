// SPDX-License-Identifier: MIT
// From any side, tap where most is expected to be found, in metres of the mean distance: a piece that nobody has
// touched yet, or, along normals, by how much the surface is elsewhere around there.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

namespace palpate::acquisitions {

struct DiscoveryOptions : Options {
  double share = 0.01;
  void list(Fields& fields) override {
    fields.real(share,
                Field("share", "of the surface that a poke along the normal tells about").at_least(0).at_most(1));
  }
};

class Discovery final : public Acquisition {
 public:
  using Options = DiscoveryOptions;
  Discovery(const Options& options, const Context&) : options_(options) {}

  bool from_above() const override { return false; }
  bool any_side() const override { return true; }
  Quantities reads() const override { return {}; }
  Quantities reads_of_approaches() const override { return Quantity::unseen | Quantity::deviation; }
  void score(const Belief&, VectorOut out) const override { out.setZero(); }
  double prior_scale() const override { return 0.001; }

  void score_approaches(const SurfaceBelief& belief, VectorOut out) const override {
    constexpr double kAlong = 0.999;
    out = belief.unseen();
    out.array() += (belief.squareness().array() > kAlong).select(options_.share * belief.deviation().array(), 0.0);
  }

 private:
  Options options_;
};

PALPATE_PLUGIN(Acquisition, Discovery, "discovery", "from any side, tap where most is expected to be found")

}  // namespace palpate::acquisitions
