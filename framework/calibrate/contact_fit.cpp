// SPDX-License-Identifier: MIT
#include "calibrate/contact_fit.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kNormal975 = 1.95996398454005423552;
/// 95 % quantile of chi square with one degree of freedom. A 95 % interval contains the values whose log likelihood is
/// at most kChiSquare95 / 2 below its maximum.
constexpr double kChiSquare95 = 3.84145882069412447634;

// metres; without this bound, the likelihood could grow without limit as the noise approaches 0
constexpr double kLeastNoise = 5e-5;
constexpr double kFinestPlace = 2.5e-4;
constexpr double kFarthestPlace = 0.01;

/// Returns the heights of the scene at positions around each contact: one row per contact, one column per position. The
/// positions are equally probable under lateral errors with the standard deviation `lateral`.
Eigen::MatrixXd heights_around(const std::vector<KnownContact>& contacts, double lateral) {
  constexpr int kRings = 8;
  constexpr int kSpokes = 16;
  const int places = lateral > 0.0 ? kRings * kSpokes : 1;
  Eigen::MatrixXd out(static_cast<Eigen::Index>(contacts.size()), places);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    for (int k = 0; k < places; ++k) {
      // The length of the lateral error has a Rayleigh distribution, whose quantiles have a closed form.
      const int ring = k / kSpokes;
      const double radius = lateral * std::sqrt(-2.0 * std::log(1.0 - (ring + 0.5) / kRings));
      const double angle = 2.0 * kPi * ((k % kSpokes) + 0.5 * (ring % 2)) / kSpokes;
      const Target at{contacts[i].place.x + radius * std::cos(angle), contacts[i].place.y + radius * std::sin(angle)};
      out(static_cast<Eigen::Index>(i), k) = contacts[i].scene->height(at.x, at.y);
    }
  }
  return out;
}

struct FitState {
  double offset = 0.0, drift = 0.0, noise = 0.003, false_share = 0.02;
  double log_likelihood = 0.0;
  double true_contacts = 0.0;
  /// sum of the squared deviations of the times of true contacts from their mean, square seconds
  double time_squares = 0.0;
};

class ExpectationMaximisation {
 public:
  ExpectationMaximisation(const std::vector<KnownContact>& contacts, Eigen::MatrixXd heights, double mean_elapsed,
                          double range)
      : heights_(std::move(heights)), log_false_(-std::log(range)) {
    const auto n = static_cast<Eigen::Index>(contacts.size());
    measured_.resize(n);
    times_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      measured_(i) = contacts[static_cast<std::size_t>(i)].height;
      times_(i) = contacts[static_cast<std::size_t>(i)].elapsed - mean_elapsed;
    }
  }

  FitState run(bool drifts) const {
    constexpr int kRounds = 200;
    constexpr double kSettled = 1e-9;
    FitState now;
    now.offset = start();
    double before = -1e300;
    for (int round = 0; round < kRounds; ++round) {
      step(now, drifts);
      if (now.log_likelihood - before < kSettled * std::abs(now.log_likelihood) && round > 5) break;
      before = now.log_likelihood;
    }
    return now;
  }

 private:
  /// Returns the initial offset of the fit: the median error of the heights.
  double start() const {
    Eigen::VectorXd off = measured_ - heights_.rowwise().mean();
    const auto middle = off.data() + off.size() / 2;
    std::nth_element(off.data(), middle, off.data() + off.size());
    return *middle;
  }

  void step(FitState& now, bool drifts) const {
    const double share = (1.0 - now.false_share) / static_cast<double>(heights_.cols());
    const double density = share / (now.noise * std::sqrt(2.0 * kPi));
    const double lying = now.false_share * std::exp(log_false_);
    double log_likelihood = 0.0;
    double n = 0.0, t = 0.0, tt = 0.0, e = 0.0, te = 0.0, ee = 0.0;
    for (Eigen::Index i = 0; i < measured_.size(); ++i) {
      const Eigen::ArrayXd off = measured_(i) - heights_.row(i).array().transpose();
      const Eigen::ArrayXd z = (off - now.offset - now.drift * times_(i)) / now.noise;
      const Eigen::ArrayXd weight = density * (-0.5 * z.square()).exp();
      const double all = weight.sum() + lying;
      log_likelihood += std::log(all);
      const double own = weight.sum() / all;
      const double mean = (weight * off).sum() / all;
      n += own;
      t += own * times_(i);
      tt += own * times_(i) * times_(i);
      e += mean;
      te += mean * times_(i);
      ee += (weight * off.square()).sum() / all;
    }
    now.log_likelihood = log_likelihood;
    now.true_contacts = n;
    now.time_squares = tt - t * t / n;
    now.drift = drifts && now.time_squares > 0.0 ? (te - t * e / n) / now.time_squares : 0.0;
    now.offset = (e - now.drift * t) / n;
    const double squares = ee - 2.0 * now.offset * e - 2.0 * now.drift * te + n * now.offset * now.offset +
                           2.0 * now.offset * now.drift * t + now.drift * now.drift * tt;
    now.noise = std::max(kLeastNoise, std::sqrt(std::max(0.0, squares) / n));
    // A thousandth of a contact is added to the false contacts, because expectation maximisation cannot change a share
    // of 0.
    now.false_share =
        (static_cast<double>(measured_.size()) - n + 1e-3) / (static_cast<double>(measured_.size()) + 1.0);
  }

  Eigen::MatrixXd heights_;
  Eigen::VectorXd measured_, times_;
  double log_false_;
};

}  // namespace

double beyond_surface(const KnownContact& contact, double offset) {
  constexpr int kRings = 4;
  constexpr int kSpokes = 16;
  double lowest = contact.scene->height(contact.place.x, contact.place.y);
  double highest = lowest;
  for (int k = 0; k < kRings * kSpokes; ++k) {
    const int ring = k / kSpokes + 1;
    const double radius = kFarthestPlace * ring / kRings;
    const double angle = 2.0 * kPi * (k % kSpokes) / kSpokes;
    const double height =
        contact.scene->height(contact.place.x + radius * std::cos(angle), contact.place.y + radius * std::sin(angle));
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  const double height = contact.height - offset;
  return height - std::clamp(height, lowest, highest);
}

IntervalEstimate share_of(double count, double all) {
  const double z2 = kNormal975 * kNormal975;
  const double share = count / all;
  const double middle = (share + z2 / (2.0 * all)) / (1.0 + z2 / all);
  const double half = kNormal975 / (1.0 + z2 / all) * std::sqrt(share * (1.0 - share) / all + z2 / (4.0 * all * all));
  return {share, std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

ContactFit fit_contacts(const std::vector<KnownContact>& contacts, double range) {
  ContactFit out;
  for (const KnownContact& one : contacts) out.mean_elapsed += one.elapsed / static_cast<double>(contacts.size());
  struct LateralFit {
    double lateral;
    FitState numbers;
  };
  std::vector<LateralFit> profile;
  for (double lateral = 0.0; lateral <= kFarthestPlace; lateral += kFinestPlace) {
    const ExpectationMaximisation fit(contacts, heights_around(contacts, lateral), out.mean_elapsed, range);
    FitState steady = fit.run(false);
    const FitState drifting = fit.run(true);
    const bool drifts = 2.0 * (drifting.log_likelihood - steady.log_likelihood) > kChiSquare95;
    profile.push_back({lateral, drifts ? drifting : steady});
  }
  const auto better = [](const LateralFit& a, const LateralFit& b) {
    return a.numbers.log_likelihood < b.numbers.log_likelihood;
  };
  const LateralFit& best = *std::max_element(profile.begin(), profile.end(), better);
  const FitState& numbers = best.numbers;
  const double half = kNormal975 * numbers.noise / std::sqrt(numbers.true_contacts);
  out.offset = {numbers.offset, numbers.offset - half, numbers.offset + half};
  if (numbers.drift != 0.0) {
    const double spread = kNormal975 * numbers.noise / std::sqrt(numbers.time_squares);
    out.drift = IntervalEstimate{numbers.drift, numbers.drift - spread, numbers.drift + spread};
  }
  const double factor = std::exp(kNormal975 / std::sqrt(2.0 * numbers.true_contacts));
  out.noise = {numbers.noise, numbers.noise / factor, numbers.noise * factor};
  const auto all = static_cast<double>(contacts.size());
  out.false_share = share_of(all - numbers.true_contacts, all);
  IntervalEstimate lateral{best.lateral, kFarthestPlace, 0.0};
  for (const LateralFit& one : profile) {
    if (2.0 * (numbers.log_likelihood - one.numbers.log_likelihood) > kChiSquare95) continue;
    lateral.low = std::min(lateral.low, one.lateral);
    lateral.high = std::max(lateral.high, one.lateral);
  }
  if (lateral.high < profile.back().lateral) out.lateral = lateral;
  return out;
}

}  // namespace palpate
