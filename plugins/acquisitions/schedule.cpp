// SPDX-License-Identifier: MIT
// One strategy until an object is found, another from then on.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <memory>

namespace palpate::acquisitions {

struct ScheduleOptions : Options {
  PluginChoice find{"acquisition", {}, nullptr};
  PluginChoice then{"acquisition", {}, nullptr};
  void list(Fields& fields) override {
    fields.plugin(find, Field("find", "used until a tap has hit an object").needed());
    fields.plugin(then, Field("then", "used from then on").needed());
  }
};

class Schedule final : public Acquisition {
 public:
  using Options = ScheduleOptions;
  Schedule(const Options& options, const Context& context)
      : find_(context.create<Acquisition>(options.find)), then_(context.create<Acquisition>(options.then)) {}

  void score(const Belief& belief, VectorOut out) const override {
    (belief.hits() > 0 ? then_ : find_)->score(belief, out);
  }
  double prior_scale() const override { return std::max(find_->prior_scale(), then_->prior_scale()); }

 private:
  std::shared_ptr<Acquisition> find_;
  std::shared_ptr<Acquisition> then_;
};

PALPATE_PLUGIN(Acquisition, Schedule, "schedule", "one acquisition until an object is found, another from then on")

}  // namespace palpate::acquisitions
