// SPDX-License-Identifier: MIT
// The paper's exploration function: e(x) = u(x) w(x) (Sun and Min 2021, section III), with w as it comes from the
// label GP. Its prior mean and its clipping are options of that process: `label: {prior_mean, clip}`.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>
#include <palpate/simd.hpp>

namespace palpate::acquisitions {

class Weighted final : public Acquisition {
 public:
  using Options = NoOptions;
  Weighted(const Options&, const Context& context) : lanes_(context.lanes) {}

  Quantities reads() const override { return Quantity::uncertainty | Quantity::weight; }
  void score(const Belief& belief, VectorOut out) const override {
    simd::for_each(lanes_, out.size(),
                   [to = out.data(), u = belief.uncertainty().data(), w = belief.weight().data()](std::ptrdiff_t i) {
                     to[i] = u[i] * w[i];
                   });
  }
  /// u is 1 before any tap and w is a probability in the model's mind.
  double prior_scale() const override { return 1.0; }

 private:
  simd::Lanes lanes_;
};

PALPATE_PLUGIN(Acquisition, Weighted, "weighted",
               "variance of the height times the mean of the label GP, as in the paper")

}  // namespace palpate::acquisitions
