// SPDX-License-Identifier: MIT
// Bayesian inference of hypotheses, each a set of primitives. The probability of a position is the fraction of
// hypotheses that cover it. If the taps contradict all hypotheses, gp_classifier replaces the inference.
//
// Reading order: hypothesis.hpp (state and prior), tap_model.hpp (likelihood of labels and heights), undiscovered.hpp
// (primitives without an object tap), proposals.hpp (moves and their ratios), sampler.hpp (particles, weights, Markov
// chain). coverage.hpp has the shared computations: rows of taps, spans of candidates, vectorised loops.
#include "../gp_classifier/laplace.hpp"
#include "sampler.hpp"

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
    fields.real(
        max_length,
        Field("max_length", "maximum length of a primitive (box or ellipse)").in(Unit::metre).above(0).at_most(1));
    fields.real(expected_count,
                Field("expected_count", "prior mean number of boxes and ellipses per 23 cm x 23 cm of the area")
                    .above(0)
                    .at_most(20));
    fields.real(
        hole_probability,
        Field("hole_probability", "prior probability that a primitive has a hole. The hole is also a box or an ellipse")
            .within(0, 0.9));
    fields.real(label_error_probability,
                Field("label_error_probability",
                      "probability that a contact with an object is labelled as desk, and the default of "
                      "false_contact_probability")
                    .within(1e-6, 0.4));
    fields.real(false_contact_probability, Field("false_contact_probability",
                                                 "probability that a contact with the desk is labelled as an object; "
                                                 "not given: equal to label_error_probability")
                                               .within(1e-6, 0.4));
    fields.real(position_noise,
                Field("position_noise", "standard deviation of the position of a contact, along x and y")
                    .in(Unit::metre)
                    .at_least(0));
    fields.real(
        push_probability,
        Field("push_probability", "probability that the objects are pushed between two contacts").within(0, 0.5));
    fields.flag(heights,
                Field("heights", "whether a height difference between contacts is evidence for two primitives"));
    fields.real(
        max_contradictions,
        Field(
            "max_contradictions",
            "maximum number of unexpected wrong labels, averaged over the particles. Above this maximum, gp_classifier "
            "replaces the primitives. Expected: label_error_probability per contact labelled as object, and "
            "false_contact_probability per contact labelled as desk")
            .above(0));
    fields.integer(particles, Field("particles",
                                    "number of particles. A particle is one hypothesis of the outlines. The number is "
                                    "doubled for ten contacts after each discovery of an object")
                                  .within(100, 100000));
    LaplaceOptions::list(fields);
    fields.require(min_width < max_length, "max_length", "is not larger than min_width");
  }
};

class PrimitivesFootprint final : public Footprint {
 public:
  using Options = PrimitivesOptions;
  PrimitivesFootprint(const Options& options, const Context& context)
      : options_(options),
        classifier_(options, context),
        sampler_(
            prior(options, context.scene.area()),
            {static_cast<int>(options.particles), options.label_error_probability, false_contact_probability(options),
             options.position_noise, options.push_probability, options.heights},
            context.random("footprint/primitives")) {}

  void add(const Touch& touch) override {
    ++taps_;
    classifier_.add(touch);
    if (replaced_at_ > 0) return;
    sampler_.add(touch);
    expected_label_errors_ += touch.on ? options_.label_error_probability : false_contact_probability(options_);
    const double unexpected = sampler_.mean_label_errors() - expected_label_errors_;
    if (unexpected > options_.max_contradictions) replaced_at_ = taps_;
  }

  void probability(const PointsView& places, VectorOut out) override {
    if (replaced_at_ > 0) return classifier_.probability(places, out);
    sampler_.probability(places, out);
  }

  void sample(const PointsView& places, HypothesisSample& out) const override {
    if (replaced_at_ > 0) return Footprint::sample(places, out);
    sampler_.sample(places, kSample, out);
  }

  void doubt(VectorOut out) const override {
    if (replaced_at_ > 0) return Footprint::doubt(out);
    sampler_.label_errors(out);
  }

  void current_positions(Points& places) const override {
    if (replaced_at_ == 0 && options_.push_probability > 0.0) sampler_.current_positions(places);
  }

  std::optional<double> undiscovered_probability() const override {
    if (replaced_at_ > 0) return std::nullopt;
    return sampler_.undiscovered_probability(kMinLength);
  }

  /// Once gp_classifier has replaced the primitives, the numbers keep their values from that contact.
  std::vector<FootprintNumber> numbers() const override {
    std::vector<FootprintNumber> out{{"label_errors", sampler_.mean_label_errors()},
                                     {"primitives", sampler_.mean_primitives()},
                                     {"undiscovered_probability", sampler_.undiscovered_probability(kMinLength)},
                                     {"acceptance_rate", sampler_.acceptance_rate()},
                                     {"gp_share", replaced_at_ > 0 ? 1.0 : 0.0}};
    if (options_.push_probability > 0.0) out.push_back({"push_probability", sampler_.mean_push().share});
    return out;
  }

  std::string remark() const override {
    if (replaced_at_ == 0) {
      const Sampler::MeanPush push = sampler_.mean_push();
      if (push.share <= 0.5) return {};
      return fmt::format(
          "the object was pushed after contact {:.0f}, by {:.1f} cm (probability {:.2f}): earlier contacts are moved "
          "along with it",
          push.before, 100.0 * push.shift, push.share);
    }
    return "gp_classifier has taken over at contact " + std::to_string(replaced_at_) +
           ": no small number of primitives fits the contacts";
  }

 private:
  static constexpr int kSample = 256;
  static constexpr double kMinLength = 0.03;  // metres

  static double false_contact_probability(const Options& options) {
    return options.false_contact_probability.value_or(options.label_error_probability);
  }

  static Prior prior(const Options& options, const Area& area) {
    Prior::Settings settings;
    settings.area = area;
    settings.min_width = options.min_width;
    settings.max_length = options.max_length;
    settings.expected = options.expected_count * area.width * area.depth / (0.23 * 0.23);
    settings.hole_probability = options.hole_probability;
    return Prior(settings);
  }

  Options options_;
  Classifier classifier_;
  mutable Sampler sampler_;  ///< mutable, because queries cache values for the same positions
  int taps_ = 0;
  double expected_label_errors_ = 0.0;
  int replaced_at_ = 0;  ///< number of the tap at which gp_classifier took over; 0: not yet
};

PALPATE_PLUGIN(Footprint, PrimitivesFootprint, "primitives",
               "Bayesian inference of any number of boxes and ellipses. If the contacts contradict every such model, "
               "gp_classifier replaces the inference")

}  // namespace palpate::footprints
