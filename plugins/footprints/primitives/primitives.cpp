// SPDX-License-Identifier: MIT
// A Bayesian belief over outlines of any number of simple pieces: the probability of a place is the share of outlines
// that hold it. Where the touches contradict all of these, the classifier takes over.
#include "../gp_classifier/laplace.hpp"
#include "particles.hpp"

#include <fmt/format.h>

#include <optional>
#include <string>

namespace palpate::footprints {

struct PrimitivesOptions : LaplaceOptions {
  double min_width = 0.02;
  double max_length = 0.22;
  double expected_count = 2.0;
  double hole_probability = 0.25;
  double label_error_probability = 0.01;
  std::optional<double> false_contact_probability;
  double position_noise = 0.0;
  double push_probability = 0.0;
  bool heights = true;
  double max_contradictions = 4.0;
  std::int64_t particles = 384;
  void list(Fields& fields) override {
    fields.real(min_width,
                Field("min_width", "minimum width of a primitive (box or ellipse)").in(Unit::metre).above(0));
    fields.real(max_length,
                Field("max_length", "maximum length of a primitive (box or ellipse)").in(Unit::metre).above(0));
    fields.real(expected_count,
                Field("expected_count", "prior mean number of boxes and ellipses per 23 cm x 23 cm of the area")
                    .above(0)
                    .at_most(20));
    fields.real(
        hole_probability,
        Field("hole_probability", "prior probability that a primitive has a hole. The hole is also a box or an ellipse")
            .at_least(0)
            .at_most(0.9));
    fields.real(label_error_probability,
                Field("label_error_probability", "probability that the label of a contact is wrong")
                    .at_least(1e-6)
                    .at_most(0.4));
    fields.real(false_contact_probability, Field("false_contact_probability",
                                                 "probability that a contact with the desk is labelled as an object; "
                                                 "not given: equal to label_error_probability")
                                               .at_least(1e-6)
                                               .at_most(0.4));
    fields.real(position_noise,
                Field("position_noise", "standard deviation of the position of a contact, along x and y")
                    .in(Unit::metre)
                    .at_least(0));
    fields.real(push_probability,
                Field("push_probability", "probability that the objects are pushed between two contacts")
                    .at_least(0)
                    .at_most(0.5));
    fields.flag(heights,
                Field("heights", "whether a height difference between contacts is evidence for two primitives"));
    fields.real(
        max_contradictions,
        Field(
            "max_contradictions",
            "maximum number of unexpected wrong labels, averaged over the particles. Above this maximum, gp_classifier "
            "replaces the primitives. label_error_probability times the number of contacts is the expected number")
            .above(0));
    fields.integer(particles, Field("particles",
                                    "number of particles. A particle is one hypothesis of the outlines. The number is "
                                    "doubled for ten contacts after each discovery of an object")
                                  .at_least(100)
                                  .at_most(100000));
    LaplaceOptions::list(fields);
    fields.require(min_width < max_length, "max_length", "is not larger than min_width");
  }
};

class Primitives final : public Footprint {
 public:
  using Options = PrimitivesOptions;
  Primitives(const Options& options, const Context& context)
      : options_(options),
        classifier_(options, context),
        particles_(prior(options, context.scene.area()),
                   {static_cast<int>(options.particles), options.label_error_probability,
                    options.false_contact_probability.value_or(options.label_error_probability), options.position_noise,
                    options.push_probability, options.heights},
                   context.random("footprint/shape")) {}

  void add(const Touch& touch) override {
    ++touches_;
    classifier_.add(touch);
    if (handed_over_at_ > 0) return;
    particles_.add(touch);
    const double unexpected = particles_.mean_mistakes() - options_.label_error_probability * touches_;
    if (unexpected > options_.max_contradictions) handed_over_at_ = touches_;
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
    if (handed_over_at_ == 0 && options_.push_probability > 0.0) particles_.current_positions(places);
  }

  std::optional<double> undiscovered_probability() const override {
    if (handed_over_at_ > 0) return std::nullopt;
    return particles_.undiscovered_probability(kWorthFinding);
  }

  std::vector<FootprintNumber> numbers() const override {
    std::vector<FootprintNumber> out{{"label_errors", particles_.mean_mistakes()},
                                     {"primitives", particles_.mean_pieces()},
                                     {"undiscovered_probability", particles_.undiscovered_probability(kWorthFinding)},
                                     {"acceptance_rate", particles_.acceptance()},
                                     {"gp_share", handed_over_at_ > 0 ? 1.0 : 0.0}};
    if (options_.push_probability > 0.0) out.push_back({"push_probability", particles_.pushed().share});
    return out;
  }

  std::string remark() const override {
    if (handed_over_at_ == 0) {
      const Particles::Pushed pushed = particles_.pushed();
      if (pushed.share <= 0.5) return {};
      return fmt::format(
          "the object was pushed after contact {:.0f}, by {:.1f} cm (probability {:.2f}): earlier contacts are moved "
          "along with it",
          pushed.before, 100.0 * pushed.shift, pushed.share);
    }
    return "gp_classifier has taken over at contact " + std::to_string(handed_over_at_) +
           ": no small number of primitives fits the contacts";
  }

 private:
  static constexpr int kSample = 256;
  static constexpr double kWorthFinding = 0.03;  // metres

  static OutlinePrior prior(const Options& options, const Area& area) {
    OutlinePrior::Settings settings;
    settings.area = area;
    settings.smallest = options.min_width;
    settings.largest = options.max_length;
    settings.expected = options.expected_count * area.width * area.depth / (0.23 * 0.23);
    settings.hollow = options.hole_probability;
    return OutlinePrior(settings);
  }

  Options options_;
  Classifier classifier_;
  Particles particles_;
  int touches_ = 0;
  int handed_over_at_ = 0;  ///< touches; 0: not yet
};

PALPATE_PLUGIN(Footprint, Primitives, "primitives",
               "Bayesian inference of any number of boxes and ellipses. If the contacts contradict every such model, "
               "gp_classifier replaces the inference")

}  // namespace palpate::footprints
