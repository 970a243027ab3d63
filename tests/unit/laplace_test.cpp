// SPDX-License-Identifier: MIT
// The classifier's approximation against what it approximates, in numbers with more digits and by plain quadrature.
#include "gp_classifier/laplace.hpp"

#include "support/testing.hpp"
#include "support/touches.hpp"

#include <Eigen/LU>

namespace palpate::footprints {
namespace {

using Wide = long double;
using WideVector = Eigen::Matrix<Wide, Eigen::Dynamic, 1>;
using WideMatrix = Eigen::Matrix<Wide, Eigen::Dynamic, Eigen::Dynamic>;

constexpr Wide kRootTwo = 1.414213562373095048801688724209698079L;
constexpr Wide kRootTwoPi = 2.506628274631000502415765284811045253L;

Wide density(Wide z) { return std::exp(-0.5L * z * z) / kRootTwoPi; }
Wide cdf(Wide z) { return 0.5L * std::erfc(-z / kRootTwo); }

/// Laplace's approximation as it is defined, without any care for rounding but digits: undamped steps with K^-1.
class Oracle {
 public:
  Oracle(const Kernel& kernel, const LaplaceSettings& settings, const Points& points, const std::vector<bool>& on)
      : kernel_(kernel), settings_(settings), points_(points), sign_(points.rows()), mode_(points.rows()) {
    for (Eigen::Index i = 0; i < sign_.size(); ++i) sign_(i) = on[static_cast<std::size_t>(i)] ? 1.0L : -1.0L;
    prior_ = covariance(points, points);
    mode_.setConstant(settings.mean);
    for (int step = 0; step < 200; ++step) {
      const WideMatrix system = WideMatrix::Identity(size(), size()) + prior_ * weight().asDiagonal();
      mode_ -= 0.5L * system.fullPivLu().solve(residual());
    }
  }

  /// f - mean - K grad log p(y | f): 0 at the mode and nowhere else.
  WideVector residual() const { return mode_ - WideVector::Constant(size(), settings_.mean) - prior_ * gradient(); }

  double probability(const Points& place) const {
    const WideMatrix cross = covariance(points_, place);
    const WideMatrix system = weight().cwiseInverse().asDiagonal().toDenseMatrix() + prior_;
    const Wide mean = settings_.mean + (cross.transpose() * gradient())(0);
    const Wide spread = covariance(place, place)(0) - (cross.transpose() * system.fullPivLu().solve(cross))(0);
    return static_cast<double>(cdf(mean / std::sqrt(1.0L + spread)));
  }

  double log_evidence() const {
    Wide sum = -0.5L * (mode_.array() - Wide(settings_.mean)).matrix().dot(gradient());
    for (Eigen::Index i = 0; i < size(); ++i) sum += std::log(cdf(sign_(i) * mode_(i)));
    const WideMatrix system = WideMatrix::Identity(size(), size()) + prior_ * weight().asDiagonal();
    return static_cast<double>(sum - 0.5L * std::log(system.fullPivLu().determinant()));
  }

 private:
  Eigen::Index size() const { return sign_.size(); }

  WideMatrix covariance(const Points& a, const Points& b) const {
    Eigen::MatrixXd out(a.rows(), b.rows());
    kernel_.covariance(a, b, out);
    return (settings_.signal * settings_.signal * out).cast<Wide>();
  }
  WideVector gradient() const {
    return sign_.binaryExpr(mode_, [](Wide s, Wide f) { return s * density(f) / cdf(s * f); });
  }
  WideVector weight() const {
    return sign_.binaryExpr(mode_, [](Wide s, Wide f) {
      const Wide slope = density(f) / cdf(s * f);
      return slope * (s * f + slope);
    });
  }

  const Kernel& kernel_;
  LaplaceSettings settings_;
  Points points_;
  WideVector sign_, mode_;
  WideMatrix prior_;
};

std::shared_ptr<Kernel> rbf() {
  static const std::shared_ptr<Kernel> kernel = test::make<Kernel>(test::shared_host(), "rbf", "{length_scale: 3 cm}");
  return kernel;
}

double probability_at(const Laplace& posterior, const Points& place) {
  Eigen::VectorXd out(1);
  posterior.probability(place, out);
  return out(0);
}

Points point(double x, double y) { return Points{{x, y}}; }

TEST(Probit, HasTenDigitsFromMinusFortyToForty) {
  // At -10 the ninth term of the series, left out, is 3.4e-11 of the first; 1 + z ratio is a hundredth of that.
  for (double z = -40.0; z <= 40.0; z += 0.01) {
    const Probit at = probit(z);
    const Wide slope = density(z) / cdf(z);
    const Wide weight = slope * (static_cast<Wide>(z) + slope);
    const auto log = static_cast<double>(std::log(cdf(z)));
    // Next to 1 the logarithm has no more digits than 1 has.
    EXPECT_NEAR(at.log, log, 1e-12 * std::abs(log) + 1e-15) << z;
    EXPECT_NEAR(at.slope, static_cast<double>(slope), 1e-10 * static_cast<double>(slope) + 1e-300) << z;
    EXPECT_NEAR(at.weight, static_cast<double>(weight), 1e-8 * static_cast<double>(weight) + 1e-300) << z;
  }
}

TEST(Probit, IsMonotoneFarBeyondWhatADoubleHoldsOfPhi) {
  Probit before = probit(-1e6);
  for (double z = -1e6 + 0.5; z < 50.0; z += z < -50.0 ? 7.3 * std::abs(z) / 100.0 : 0.0625) {
    const Probit at = probit(z);
    ASSERT_TRUE(std::isfinite(at.log) && std::isfinite(at.slope) && std::isfinite(at.weight)) << z;
    EXPECT_GE(at.log, before.log) << z;
    EXPECT_LE(at.slope, before.slope) << z;
    EXPECT_LE(at.weight, before.weight + 1e-12) << z;
    EXPECT_GE(at.weight, 0.0) << z;
    EXPECT_LE(at.weight, 1.0) << z;
    before = at;
  }
}

TEST(Laplace, IsTheApproximationThatItsDefinitionSaysAtAModeThatIsStationary) {
  Random random(1, "laplace test");
  for (int trial = 0; trial < 40; ++trial) {
    const int count = 1 + static_cast<int>(random.index(12));
    const LaplaceSettings settings{0.5 + 3.0 * random.uniform(), 4.0 * random.uniform() - 2.0};
    Points points(count, 2);
    std::vector<bool> on;
    for (int i = 0; i < count; ++i) {
      points.row(i) << 0.23 * random.uniform(), 0.23 * random.uniform();
      on.push_back(random.uniform() < 0.4);
    }
    const Laplace posterior(*rbf(), settings, points, on);
    const Oracle oracle(*rbf(), settings, points, on);
    ASSERT_LT(oracle.residual().cwiseAbs().maxCoeff(), 1e-15L);
    // The search ends before a step that gains less than 1e-10 of the objective: so the mode is off by the root of it.
    EXPECT_NEAR(posterior.log_evidence(), oracle.log_evidence(), 5e-5);
    for (int probe = 0; probe < 5; ++probe) {
      const Points place = probe == 0 ? Points(points.row(0)) : point(0.23 * random.uniform(), 0.23 * random.uniform());
      EXPECT_NEAR(probability_at(posterior, place), oracle.probability(place), 2e-5) << "trial " << trial;
    }
  }
}

/// The posterior of two latents, summed up over a fine lattice of 8 standard deviations each way.
struct Exact {
  double evidence = 0.0;
  double probability = 0.0;  ///< of the first place
};

/// Without a second label it is that of one latent.
Exact exact_posterior(const LaplaceSettings& settings, double correlation, bool first_on,
                      std::optional<bool> second_on) {
  Exact out;
  const double across = std::sqrt(1.0 - correlation * correlation);
  const double step = 16.0 / 300;  // of two independent standard normals that the latents are made of
  for (int i = -150; i <= 150; ++i) {
    const double f = settings.mean + settings.signal * i * step;
    for (int j = -150; j <= 150; ++j) {
      const double g = settings.mean + settings.signal * (correlation * i + across * j) * step;
      const auto prior = static_cast<double>(density(i * step) * density(j * step)) * step * step;
      const double second = second_on ? normal_cdf(*second_on ? g : -g) : 1.0;
      const double joint = prior * normal_cdf(first_on ? f : -f) * second;
      out.evidence += joint;
      out.probability += joint * normal_cdf(f);
    }
  }
  out.probability /= out.evidence;
  return out;
}

// The exact posterior has its longer tail away from the border of the labels, and a Gaussian at the mode leaves it out:
// probabilities come out nearer to 1/2, by 0.062 at the most in these cases.
constexpr double kApproximation = 0.065;

TEST(Laplace, IsNearTheExactPosteriorOfOneLabel) {
  for (const double signal : {0.5, 1.0, 2.0}) {
    for (const double mean : {-1.0, 0.0, 1.0}) {
      for (const bool on : {false, true}) {
        const LaplaceSettings settings{signal, mean};
        const Laplace posterior(*rbf(), settings, point(0.1, 0.1), {on});
        const Exact exact = exact_posterior(settings, 0.0, on, {});
        EXPECT_NEAR(exact.evidence, normal_cdf((on ? mean : -mean) / std::sqrt(1.0 + signal * signal)), 1e-9)
            << "the quadrature, against the integral in closed form";
        EXPECT_NEAR(probability_at(posterior, point(0.1, 0.1)), exact.probability, kApproximation);
        EXPECT_NEAR(posterior.log_evidence(), std::log(exact.evidence), 2.0 * kApproximation);
      }
    }
  }
}

TEST(Laplace, IsNearTheExactPosteriorOfTwoLabels) {
  const Points points{{0.1, 0.1}, {0.12, 0.1}};
  Eigen::MatrixXd correlation(1, 1);
  rbf()->covariance(points.topRows<1>(), points.bottomRows<1>(), correlation);
  for (const double signal : {0.5, 1.0, 2.0}) {
    for (const int labels : {0, 1, 2, 3}) {
      const LaplaceSettings settings{signal, -0.5};
      const std::vector<bool> on{labels % 2 == 1, labels / 2 == 1};
      const Laplace posterior(*rbf(), settings, points, on);
      const Exact exact = exact_posterior(settings, correlation(0, 0), on[0], on[1]);
      EXPECT_NEAR(probability_at(posterior, points.row(0)), exact.probability, kApproximation)
          << signal << " " << labels;
      EXPECT_NEAR(posterior.log_evidence(), std::log(exact.evidence), 3.0 * kApproximation) << signal << " " << labels;
    }
  }
}

TEST(Laplace, WithoutLabelsIsThePrior) {
  const Laplace prior(*rbf(), {2.0, -1.0}, Points(0, 2), {});
  EXPECT_NEAR(probability_at(prior, point(0.1, 0.1)), normal_cdf(-1.0 / std::sqrt(5.0)), 1e-15);
  EXPECT_EQ(prior.log_evidence(), 0.0);
}

TEST(Laplace, OfSymmetricLabelsWithoutAPriorMeanIsOneHalfInTheMiddle) {
  const Points apart{{0.10, 0.1}, {0.12, 0.1}};
  EXPECT_NEAR(probability_at(Laplace(*rbf(), {2.0, 0.0}, apart, {true, false}), point(0.11, 0.13)), 0.5, 1e-12);
  const Points together{{0.1, 0.1}, {0.1, 0.1}};
  EXPECT_NEAR(probability_at(Laplace(*rbf(), {2.0, 0.0}, together, {true, false}), point(0.1, 0.1)), 0.5, 1e-12);
}

TEST(Laplace, OfLabelsTurnedAroundIsTheOtherProbability) {
  const std::vector<Touch> touches = test::disc_touches(20);
  Points points(20, 2);
  std::vector<bool> on;
  std::vector<bool> turned;
  for (const Touch& touch : touches) {
    points.row(static_cast<Eigen::Index>(on.size())) << touch.place.x, touch.place.y;
    on.push_back(touch.on);
    turned.push_back(!touch.on);
  }
  const Laplace one(*rbf(), {2.0, -0.7}, points, on);
  const Laplace other(*rbf(), {2.0, 0.7}, points, turned);
  EXPECT_NEAR(one.log_evidence(), other.log_evidence(), 1e-9);
  for (Eigen::Index i = 0; i < 20; ++i)
    EXPECT_NEAR(probability_at(one, points.row(i)), 1.0 - probability_at(other, points.row(i)), 1e-9);
}

TEST(Laplace, OfLatentsFarOutIsStableAndRisesWithThePriorMean) {
  const Points points{{0.10, 0.1}, {0.12, 0.1}, {0.12, 0.1}};
  double before = 0.0;
  for (double mean = -40.0; mean <= 40.0; mean += 0.5) {
    const Laplace posterior(*rbf(), {0.5, mean}, points, {true, false, true});
    const double p = probability_at(posterior, point(0.11, 0.11));
    ASSERT_TRUE(std::isfinite(posterior.log_evidence())) << mean;
    ASSERT_GE(p, before) << mean;
    ASSERT_LE(p, 1.0) << mean;
    before = p;
  }
  EXPECT_GT(before, 0.999);
  // Latents of that size that the labels have to pull back.
  const Laplace pulled(*rbf(), {40.0, -40.0}, points, {true, true, true});
  EXPECT_GT(probability_at(pulled, points.row(0)), 0.5);
  EXPECT_LT(probability_at(pulled, point(0.0, 0.0)), 0.5);
}

TEST(Laplace, BelievesALabelMoreTheOftenerItIsSaid) {
  double before = 0.0;
  for (int count = 1; count <= 30; ++count) {
    const Points points = point(0.1, 0.1).replicate(count, 1);
    const double p =
        probability_at(Laplace(*rbf(), {2.0, -1.0}, points, std::vector<bool>(points.rows(), true)), point(0.1, 0.1));
    EXPECT_GT(p, before) << count;
    before = p;
  }
  EXPECT_GT(before, 0.97);
}

}  // namespace
}  // namespace palpate::footprints
