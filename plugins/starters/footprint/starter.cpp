// Probability of an object: weighted mean of the labels of all contacts and of a prior. The weight of a contact
// decreases with its distance. The prior has the weight of one contact at the position itself.
#include <palpate/footprint.hpp>
#include <palpate/math.hpp>
#include <palpate/plugin.hpp>

using namespace palpate;

struct MyFootprintOptions : Options {
  double reach = 0.015;
  double prior = 0.2;

  void list(Fields& fields) override {
    fields.real(reach, Field("reach", "distance over which the label of a contact influences the probability")
                           .in(Unit::metre)
                           .above(0));
    fields.real(prior, Field("prior", "probability of an object far from all contacts").within(0, 1));
  }
};

class MyFootprint final : public Footprint {
 public:
  using Options = MyFootprintOptions;
  MyFootprint(const Options& options, const Context&) : options_(options) {}

  void add(const Touch& touch) override { touches_.push_back(touch); }

  void probability(const PointsView& places, VectorOut out) override {
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      double on = options_.prior;
      double all = 1.0;
      for (const Touch& touch : touches_) {
        const double r = math::hypot(places(i, 0) - touch.place.x, places(i, 1) - touch.place.y) / options_.reach;
        const double weight = math::exp(-0.5 * r * r);
        all += weight;
        if (touch.on) on += weight;
      }
      out(i) = on / all;
    }
  }

 private:
  Options options_;
  std::vector<Touch> touches_;
};

PALPATE_PLUGIN(Footprint, MyFootprint, "starter", "custom footprint: weighted labels of the contacts nearby")
