// SPDX-License-Identifier: MIT
#include "belief/height_map_options.hpp"

namespace palpate {
namespace {

// Within these bounds, squares and their ratios are far from the limits of double.
constexpr double kLeastSignal = 1e-12;
constexpr double kMostSignal = 1e12;

}  // namespace

void GpOptions::list_plugins(Fields& fields) {
  fields.plugin(kernel, "kernel",
                Field("kernel", "kernel of this GP; not given: the top-level `kernel`").inherits("kernel"));
  fields.plugin(fitting, "fitting",
                Field("fitting", "fitting of this GP; not given: the top-level `fitting`").inherits("fitting"));
}

void OffsetOptions::list(Fields& fields) {
  fields.real(offset, Field("offset", "prior standard deviation of the constant height offset")
                          .in(Unit::metre)
                          .above(0)
                          .from("6 mm: absolute errors of Baxter's tip are 2 to 10 mm"));
  fields.real(drift, Field("drift", "prior standard deviation of the drift of the height offset over time")
                         .in(Unit::metre_per_second)
                         .above(0)
                         .from("1 mm/min: an arm that warms up, an estimate"));
  fields.real(noise, Field("noise", "standard deviation of the measured height of one contact with the desk")
                         .in(Unit::metre)
                         .above(0)
                         .from("2 mm: pose and moment of detection of an arm like Baxter"));
}

void HeightGpOptions::list(Fields& fields) {
  fields.real(signal, Field("signal", "prior standard deviation of the height")
                          .in(Unit::metre)
                          .within(kLeastSignal, kMostSignal)
                          .from("Sun and Min 2021: unit signal variance"));
  fields.real(
      noise,
      Field("noise", "standard deviation of the height noise of one tap").in(Unit::metre).within(0, kMostSignal));
  fields.real(outlier_probability, Field("outlier_probability",
                                         "prior probability that the height of a contact is an outlier; not given: no "
                                         "outliers. Requires `surface: two_part`")
                                       .above(0)
                                       .at_most(0.5));
  fields.section(offset, Field("offset",
                               "estimation of the height offset from taps on the desk. The offset is caused by the "
                               "motion and the arm; not given: heights are used as measured"));
  list_plugins(fields);
}

void LabelGpOptions::list(Fields& fields) {
  fields.real(signal, Field("signal", "prior standard deviation of the label").within(kLeastSignal, kMostSignal));
  fields.real(noise, Field("noise", "standard deviation of the noise of one label").within(0, kMostSignal));
  fields.real(prior_mean, Field("prior_mean", "prior mean of the label").from("Sun and Min 2021: 0"));
  fields.flag(
      clip, Field("clip",
                  "whether the weight is clipped to [0, 1] for acquisitions. The weight is the mean of the label GP"));
  fields.choice(hyperparameters, Field("hyperparameters", "source of the fitted hyperparameters of the label GP"),
                {{"own", "kernel and noise are fitted to the labels only", {}},
                 {"shared",
                  "kernel and noise-to-signal ratio are shared with the height GP and fitted to heights and labels "
                  "together. The signals stay separate",
                  {}}});
  list_plugins(fields);
  const bool shared = hyperparameters == HyperparameterSource::shared;
  fields.require(
      !shared || !kernel, "kernel",
      "has no effect with belief.label.hyperparameters: shared, remove it or set belief.label.hyperparameters: own");
  fields.require(
      !shared || !fitting, "fitting",
      "has no effect with belief.label.hyperparameters: shared, remove it or set belief.label.hyperparameters: own");
}

void EngineOptions::list(Fields& fields) {
  fields.choice(type, Field("type", "algorithm that computes the posterior at the candidates"),
                {{"auto", "fastest engine with an error within `accuracy`", {}},
                 {"dense", "for any kernel. Time and memory grow with taps times candidates", {}},
                 {"grid",
                  "as exact as `dense`. Memory grows only with the number of candidates. Requires a separable kernel, "
                  "such as rbf",
                  {}},
                 {"lowrank",
                  "low-rank approximation. Time per tap grows only with the number of candidates. Requires a separable "
                  "kernel, such as rbf",
                  {}}});
  fields.real(tolerance, Field("tolerance",
                               "truncation threshold of `lowrank`. Along each axis, eigenvectors of the covariance "
                               "with a smaller share of the variance are dropped")
                             .above(0)
                             .at_most(1)
                             .from("keeps variances within 1e-12 and heights within 1e-9 of dense after 1000 taps"));
  fields.real(accuracy,
              Field("accuracy",
                    "maximum error of the engine that `type: auto` chooses, compared with `dense`. The error is "
                    "relative to the prior standard deviation or variance. The maximum is at most tie_tolerance / 10")
                  .within(0, 1));
  fields.integer(threads,
                 Field("threads", "number of threads that update the maps. The number does not change the results")
                     .within(1, 64)
                     .not_identifying());
}

void HeightMapOptions::list(Fields& fields) {
  fields.section(height,
                 Field("height", "settings of the height GP, the Gaussian process of the heights above the desk"));
  fields.section(label, Field("label",
                              "settings of the label GP, the Gaussian process of the contact labels. A label is 1 on "
                              "an object and 0 on the desk. The mean of the label GP is the weight w of the paper"));
  fields.plugin(footprint,
                Field("footprint", "model of the footprint, the probability of an object at every position").group());
  fields.choice(
      surface,
      Field("surface",
            "method of surface reconstruction. The method does not change the taps of the shipped strategies"),
      {{"single", "one GP for the heights of object and desk, as in the paper", {}},
       {"two_part",
        "one GP for the heights of taps on objects. This GP gives the surface where the footprint's "
        "probability is at least 1/2. Elsewhere, the surface is the desk",
        {}}});
  fields.section(engine, Field("engine", "settings of the engine, which computes the posterior at the candidates"));
  fields.section(prior, Field("prior", "view of a depth camera before the first tap; not given: no view"));
}

}  // namespace palpate
