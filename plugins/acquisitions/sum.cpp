// SPDX-License-Identifier: MIT
// Sum of the scores of several acquisitions.
#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <memory>
#include <vector>

namespace palpate::acquisitions {

struct SumOptions : Options {
  std::vector<PluginChoice> acquisitions;
  void list(Fields& fields) override {
    fields.plugins(acquisitions, "acquisition",
                   Field("acquisitions", "list of the acquisitions to add, each {type: ..., ...}").needed());
    fields.require(!acquisitions.empty(), "acquisitions", "needs at least one acquisition");
  }
};

class Sum final : public Acquisition {
 public:
  using Options = SumOptions;
  Sum(const Options& options, const Context& context) {
    for (const PluginChoice& one : options.acquisitions) parts_.push_back(context.create<Acquisition>(one));
  }

  QuantitySet reads() const override {
    QuantitySet all;
    for (const auto& one : parts_) all = all | one->reads();
    return all;
  }
  void score(const BeliefView& belief, VectorOut out) const override {
    Eigen::VectorXd part(out.size());
    out.setZero();
    for (const auto& one : parts_) {
      one->score(belief, part);
      out += part;
    }
  }
  double prior_scale() const override {
    double sum = 0.0;
    for (const auto& one : parts_) sum += one->prior_scale();
    return sum;
  }

 private:
  std::vector<std::shared_ptr<Acquisition>> parts_;
};

PALPATE_PLUGIN(Acquisition, Sum, "sum", "sum of the scores of several acquisitions")

}  // namespace palpate::acquisitions
