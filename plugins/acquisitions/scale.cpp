// SPDX-License-Identifier: MIT
// The score of another acquisition, multiplied by a factor, for example the weight of this acquisition in a sum.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <memory>

namespace palpate::acquisitions {

struct ScaleOptions : Options {
  double factor = 1.0;
  PluginChoice acquisition{"acquisition", {}, nullptr};
  void list(Fields& fields) override {
    fields.real(factor, Field("factor", "factor by which the score is multiplied").above(0).needed());
    fields.plugin(acquisition, Field("acquisition", "acquisition that gives the score to multiply").needed());
  }
};

class Scale final : public Acquisition {
 public:
  using Options = ScaleOptions;
  Scale(const Options& options, const Context& context)
      : factor_(options.factor), part_(context.create<Acquisition>(options.acquisition)) {}

  QuantitySet reads() const override { return part_->reads(); }
  void score(const BeliefView& belief, VectorOut out) const override {
    part_->score(belief, out);
    out *= factor_;
  }
  double prior_scale() const override { return factor_ * part_->prior_scale(); }

 private:
  double factor_;
  std::shared_ptr<Acquisition> part_;
};

PALPATE_PLUGIN(Acquisition, Scale, "scale", "score of another acquisition times a factor")

}  // namespace palpate::acquisitions
