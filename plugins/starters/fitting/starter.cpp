// Fit of the hyperparameters: mean and standard deviation of the targets become those of the prior. The kernel and the
// ratio of noise to signal remain unchanged.
#include <palpate/fitting.hpp>
#include <palpate/math.hpp>
#include <palpate/plugin.hpp>

#include <cmath>

using namespace palpate;

struct MyFittingOptions : Options {
  std::int64_t every = 5;

  void list(Fields& fields) override {
    fields.integer(every, Field("every", "number of taps from one fit to the next").within(1, 1000));
  }
};

class MyFitting final : public Fitting {
 public:
  using Options = MyFittingOptions;
  MyFitting(const Options& options, const Context&) : options_(options) {}

  bool due(int taps) const override { return taps > 0 && taps % options_.every == 0; }

  FitSummary fit(FitProblem& problem, Random&) const override {
    // A failed fit must leave all outputs unchanged.
    std::vector<std::pair<double, double>> found;
    double objective = 0.0;
    for (const FitOutput& output : problem.outputs) {
      const double mean = output.targets.mean();
      const double signal = std::sqrt((output.targets.array() - mean).square().mean());
      if (!std::isnormal(signal) || !std::isfinite(mean)) return {false, true, 0.0, 1, "the targets do not vary"};
      objective -= math::log(signal);
      found.emplace_back(mean, signal);
    }
    for (std::size_t i = 0; i < found.size(); ++i) {
      problem.outputs[i].mean = found[i].first;
      problem.outputs[i].signal = found[i].second;
    }
    return {true, false, objective, 1, "moments of the targets"};
  }

 private:
  Options options_;
};

PALPATE_PLUGIN(Fitting, MyFitting, "starter", "custom fitting: moments of the targets")
