// SPDX-License-Identifier: MIT
#include "baxter/reaction_time.hpp"

#include "tapping/guarded_tap.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace palpate::baxter {
namespace {

constexpr std::size_t kMotions = 5;  ///< the trailing time is the maximum of this number of latest motions
/// number of last contacts in the mean; five with a soft object leave an uncertainty of 0.1 s
constexpr std::size_t kContacts = 10;
constexpr double kFades = 30.0;          ///< s: time constant of the decay of the largest delay; see late()
constexpr std::size_t kFewest = 30;      ///< minimum number of periods of a free descent
constexpr double kClear = 0.001;         ///< m above the onset from which the tip counts as free
constexpr double kLeastNoticing = 0.04;  ///< s: three readings at 100 Hz, and one control period
constexpr double kRiseFor = 0.1;         ///< s before a detection in which the slope of the force is measured
/// s, upper limit of a measured noticing time, not counting kRenewals renewal periods of the force; a rise of the force
/// that lasts longer is not steady
constexpr double kMostNoticing = 0.5;
/// Two standard deviations of the assumed noticing time until the first contact, s, and the weight of this assumption,
/// 1/s^2.
constexpr double kFirst = ReactionTime::kFirstNoticing - kLeastNoticing;
constexpr double kFirstWeight = 4.0 / (kFirst * kFirst);
/// Least lag of the joints of a Baxter in s (measured: 0.3 to 0.4 s).
constexpr double kLeastLag = 0.3;
/// Distance that a critically damped joint moves on after a stop, in units of lag * speed: 1 / (2 * 2.718).
constexpr double kGoOn = 0.184;

template <typename Value>
void keep(std::deque<Value>& values, Value value, std::size_t most) {
  values.push_back(value);
  if (values.size() > most) values.pop_front();
}

/// Line through heights over time, fitted by least squares.
struct HeightLine {
  double height, time;  ///< m and s of the centre
  double velocity;      ///< m/s
  double at(double other) const { return height + velocity * (other - time); }
};

using Periods = std::vector<ReactionTime::Period>;

/// Returns the last kLookedAt seconds of the periods with a free tip, or nothing if there are fewer than kFewest.
Periods last_free(const Periods& periods, double free_down_to) {
  Periods out;
  for (const ReactionTime::Period& one : periods) {
    if (one.height > free_down_to + kClear) out.push_back(one);
  }
  if (out.size() < kFewest) return {};
  const double from = out.back().time - ReactionTime::kLookedAt;
  out.erase(out.begin(), std::find_if(out.begin(), out.end(), [from](const auto& one) { return one.time >= from; }));
  return out;
}

HeightLine fit(const Periods& periods) {
  HeightLine out{0.0, 0.0, 0.0};
  const auto count = static_cast<double>(periods.size());
  for (const ReactionTime::Period& one : periods) {
    out.time += one.time / count;
    out.height += one.height / count;
  }
  double square = 0.0;
  double product = 0.0;
  for (const ReactionTime::Period& one : periods) {
    square += (one.time - out.time) * (one.time - out.time);
    product += (one.time - out.time) * (one.height - out.height);
  }
  out.velocity = product / square;
  return out;
}

/// Returns the slope of the force at the detection, N/s, from the speed with which the tip falls behind `descent`. If
/// the positions do not show the deflection of the springs, the slope is the threshold divided by the time since the
/// onset at height `began`.
double rise(const Periods& periods, double began, const HeightLine& descent, double threshold, double stiffness) {
  const ReactionTime::Period& notice = periods.back();
  const double rigid = stiffness * std::abs(descent.velocity);
  Periods behind;
  for (const ReactionTime::Period& one : periods) {
    if (one.time > notice.time - kRiseFor) behind.push_back({one.time, one.height - descent.at(one.time)});
  }
  const bool shows = stiffness * (notice.height - descent.at(notice.time)) > 0.5 * threshold;
  if (shows && behind.size() > 1) return std::clamp(stiffness * fit(behind).velocity, 0.0, rigid);
  const auto first =
      std::find_if(periods.begin(), periods.end() - 1, [began](const auto& one) { return one.height <= began; });
  return std::min(rigid, threshold / std::max(kLeastNoticing, notice.time - first->time));
}

}  // namespace

void ReactionTime::late(double seconds, double now) {
  late_ = std::max(seconds, late_ * std::exp(-std::max(0.0, now - late_at_) / kFades));
  late_at_ = now;
}

void ReactionTime::learn_trailing(const std::vector<MotionSample>& motion) {
  if (motion.size() < 2) return;
  const Eigen::Vector3d way = motion.back().commanded - motion.front().commanded;
  if (way.norm() < kShortestWay) return;
  const Eigen::Vector3d along = way.normalized();
  const auto behind = [&](const MotionSample& one) { return along.dot(one.commanded - one.reached); };
  const double at_begin = behind(motion.front());
  const double at_end = behind(motion.back());
  double area = 0.0;
  for (std::size_t i = 1; i < motion.size(); ++i) {
    const double share = along.dot(motion[i].commanded - motion.front().commanded) / way.norm();
    const double offset = at_begin + share * (at_end - at_begin);
    area += (behind(motion[i]) - offset) * (motion[i].time - motion[i - 1].time);
  }
  keep(trailing_, std::max(0.0, area / way.norm()), kMotions);
}

void ReactionTime::learn_noticing(const Periods& periods, std::optional<double> began, double threshold,
                                  double stiffness) {
  if (periods.empty()) return;
  const Period& notice = periods.back();
  const double softest = notice.height + threshold / tapping::GuardedTap::kSoftest;
  const Periods free = last_free(periods, std::max(began.value_or(softest), softest));
  if (free.empty()) return;
  const HeightLine descent = fit(free);
  double reached = notice.time;  // time when the true force reached the threshold
  for (auto it = periods.rbegin(); it != periods.rend(); ++it) {
    if (stiffness * (it->height - descent.at(it->time)) < threshold) break;
    reached = it->time;
  }
  const double seconds = std::clamp(notice.time - reached, kLeastNoticing, kMostNoticing + kRenewals * renewal_);
  keep(noticing_, {seconds, rise(periods, began.value_or(softest), descent, threshold, stiffness)}, kContacts);
}

/// Returns the standard deviation of a contact's delay, s. If the force is renewed rarely, the threshold may have been
/// crossed up to one renewal earlier.
double ReactionTime::deviation(const ContactDetection& one) const {
  return std::hypot(kNoise / std::max(one.rise, 1e-3), renewal_ / std::sqrt(12.0));
}

/// Returns the sum of the inverse variances of the contacts, 1/s^2.
double ReactionTime::weight() const {
  return std::accumulate(noticing_.begin(), noticing_.end(), 0.0, [this](double sum, const ContactDetection& one) {
    return sum + 1.0 / (deviation(one) * deviation(one));
  });
}

bool ReactionTime::measured() const { return weight() >= kFirstWeight; }

double ReactionTime::noticing() const {
  const double renewals = kRenewals * renewal_;
  const double least = std::max(kLeastNoticing, renewals);
  if (noticing_.empty()) return least + kFirst;
  double sum = kFirstWeight * least;
  double surely = 0.0;
  for (const ContactDetection& one : noticing_) {
    sum += one.seconds / (deviation(one) * deviation(one));
    surely = std::max(surely, one.seconds - 2.0 * deviation(one));
  }
  const double weights = kFirstWeight + weight();
  return std::max({sum / weights + 2.0 / std::sqrt(weights), surely, renewals}) + tapping::GuardedTap::kPeriod;
}

double ReactionTime::trailing() const {
  return trailing_.empty() ? kFirstTrailing : *std::max_element(trailing_.begin(), trailing_.end());
}

/// An arm that trails less than the joints of a Baxter is not a Baxter; all of its trailing time may then be delay.
double ReactionTime::stopping() const {
  const double trails = trailing();
  const double goes_on = kGoOn * kLeastLag;
  return trails < kLeastLag ? std::max(trails, goes_on) : trails - kLeastLag + goes_on;
}

double ReactionTime::greatest_speed(double threshold, double stiffness) const {
  return (kGreatestForce - threshold) / (stiffness * seconds());
}

double ReactionTime::expected_force(double threshold, double speed, double stiffness) const {
  return threshold + stiffness * speed * seconds();
}

}  // namespace palpate::baxter
