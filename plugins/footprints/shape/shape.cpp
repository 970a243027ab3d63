// SPDX-License-Identifier: MIT
// A Bayesian belief over outlines of any number of simple pieces: the probability of a place is the share of outlines
// that hold it. Where the touches contradict all of these, the classifier takes over.
#include "../classifier/laplace.hpp"
#include "particles.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>

namespace palpate::footprints {

struct ShapeOptions : LaplaceOptions {
  double smallest = 0.02;
  double largest = 0.22;
  double expected = 2.0;
  double hollow = 0.25;
  double mistaken = 0.01;
  std::optional<double> lies;
  double blur = 0.0;
  double pushes = 0.0;
  bool heights = true;
  double contradictions = 4.0;
  std::int64_t particles = 384;
  void list(Fields& fields) override {
    fields.real(smallest, Field("smallest", "least width of a piece").in(Unit::metre).above(0));
    fields.real(largest, Field("largest", "greatest length of a piece").in(Unit::metre).above(0));
    fields.real(expected, Field("expected",
                                "boxes and ellipses that are expected on 23 cm x 23 cm; on another area as "
                                "many for its size")
                              .above(0)
                              .at_most(20));
    fields.real(hollow,
                Field("hollow", "probability that a box or an ellipse is taken from a piece").at_least(0).at_most(0.9));
    fields.gone("one_piece", "write expected and hollow: how many pieces are expected, and how often one has a hole");
    fields.real(mistaken,
                Field("mistaken", "probability that the label of a touch is wrong").at_least(1e-6).at_most(0.4));
    fields.real(lies, Field("lies", "the same of a touch of the desk, if that is more often taken for an object")
                          .at_least(1e-6)
                          .at_most(0.4));
    fields.real(blur,
                Field("blur", "standard deviation of the place of a touch, along x and y").in(Unit::metre).at_least(0));
    fields.real(
        pushes,
        Field("pushes", "probability, between two touches, that the objects are pushed").at_least(0).at_most(0.5));
    fields.flag(heights, Field("heights", "whether touches of unlike height speak for two pieces"));
    fields.real(contradictions, Field("contradictions",
                                      "hand over to the classifier when an outline has so many more touches wrong, on "
                                      "average, than mistaken lets expect")
                                    .above(0));
    fields.integer(particles,
                   Field("particles", "outlines that stand for the belief; twice as many while something is new")
                       .at_least(100)
                       .at_most(100000));
    LaplaceOptions::list(fields);
    fields.require(smallest < largest, "largest", "is not larger than smallest");
  }
};

class Shape final : public Footprint {
 public:
  using Options = ShapeOptions;
  Shape(const Options& options, const Context& context)
      : options_(options),
        classifier_(options, context),
        particles_(prior(options, context.scene.area()),
                   {static_cast<int>(options.particles), options.mistaken, options.lies.value_or(options.mistaken),
                    options.blur, options.pushes, options.heights},
                   context.random("footprint/shape")) {}

  void add(const Touch& touch) override {
    ++touches_;
    classifier_.add(touch);
    if (handed_over_at_ > 0) return;
    particles_.add(touch);
    const double unexpected = particles_.mean_mistakes() - options_.mistaken * touches_;
    if (unexpected > options_.contradictions) handed_over_at_ = touches_;
  }

  void probability(const PointsView& places, VectorOut out) override {
    if (handed_over_at_ > 0) return classifier_.probability(places, out);
    particles_.probability(places, out);
  }

  void sample(const PointsView& places, OutlineSample& out) const override {
    if (handed_over_at_ > 0) return Footprint::sample(places, out);
    particles_.sample(places, kSample, out);
  }

  void doubt(VectorOut out) const override {
    if (handed_over_at_ > 0) return Footprint::doubt(out);
    particles_.doubt(out);
  }

  void current_positions(Points& places) const override {
    if (handed_over_at_ == 0 && options_.pushes > 0.0) particles_.current_positions(places);
  }

  std::optional<double> undiscovered_probability() const override {
    if (handed_over_at_ > 0) return std::nullopt;
    return particles_.undiscovered_probability(kWorthFinding);
  }

  std::vector<FootprintNumber> numbers() const override {
    std::vector<FootprintNumber> out{{"mistakes", particles_.mean_mistakes()},
                                     {"pieces", particles_.mean_pieces()},
                                     {"left", particles_.undiscovered_probability(kWorthFinding)},
                                     {"acceptance", particles_.acceptance()},
                                     {"handed_over", handed_over_at_ > 0 ? 1.0 : 0.0}};
    if (options_.pushes > 0.0) out.push_back({"pushed", particles_.pushed().share});
    return out;
  }

  std::string remark() const override {
    if (handed_over_at_ == 0) {
      const Particles::Pushed pushed = particles_.pushed();
      if (pushed.share <= 0.5) return {};
      return fmt::format(
          "the object was pushed after touch {:.0f}, by {:.1f} cm (probability {:.2f}): what was "
          "touched before counts as if made where it is now",
          pushed.before, 100.0 * pushed.shift, pushed.share);
    }
    return "the classifier has taken over at touch " + std::to_string(handed_over_at_) +
           ": no outline of few pieces agrees with the touches";
  }

 private:
  static constexpr int kSample = 256;
  static constexpr double kWorthFinding = 0.03;  // metres

  static OutlinePrior prior(const Options& options, const Area& area) {
    OutlinePrior::Settings settings;
    settings.area = area;
    settings.smallest = options.smallest;
    settings.largest = options.largest;
    settings.expected = options.expected * area.width * area.depth / (0.23 * 0.23);
    settings.hollow = options.hollow;
    return OutlinePrior(settings);
  }

  Options options_;
  Classifier classifier_;
  Particles particles_;
  int touches_ = 0;
  int handed_over_at_ = 0;  ///< touches; 0: not yet
};

PALPATE_PLUGIN(Footprint, Shape, "shape",
               "a belief over outlines of any number of boxes and ellipses, given up where the touches contradict it")

}  // namespace palpate::footprints
