// SPDX-License-Identifier: MIT
#include "baxter/readings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace palpate::baxter {
namespace {

constexpr double kEvenFrom = 0.7;  ///< s after which an arm that trails by 0.35 s comes down evenly
constexpr double kEvenTo = 1.0;    ///< s, for so long its force is looked at
constexpr std::size_t kFewest = 10;
constexpr double kSteady = 1.5;  ///< N from the first half of it to the second: noise of 1.5 N makes 0.55

}  // namespace

Eigen::Vector3d average(const std::vector<Eigen::Vector3d>& readings) {
  const Eigen::Vector3d sum = std::accumulate(readings.begin(), readings.end(), Eigen::Vector3d(0, 0, 0));
  return sum / static_cast<double>(readings.size());
}

Eigen::Vector3d median(std::vector<Eigen::Vector3d> readings) {
  Eigen::Vector3d out;
  const auto middle = readings.begin() + static_cast<std::ptrdiff_t>(readings.size() / 2);
  for (int i = 0; i < 3; ++i) {
    std::nth_element(readings.begin(), middle, readings.end(),
                     [i](const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a[i] < b[i]; });
    out[i] = (*middle)[i];
  }
  return out;
}

bool EvenDescent::add(double time, const Eigen::Vector3d& reading) {
  if (time >= kEvenTo) return conclude();
  if (time < kEvenFrom) readings_.clear();
  if (time >= kEvenFrom) readings_.push_back(reading);
  return false;
}

bool EvenDescent::conclude() {
  const std::vector<Eigen::Vector3d> readings = std::exchange(readings_, {});
  if (readings.size() < kFewest) return false;
  const auto middle = readings.begin() + static_cast<std::ptrdiff_t>(readings.size() / 2);
  const Eigen::Vector3d early = average({readings.begin(), middle});
  const Eigen::Vector3d late = average({middle, readings.end()});
  if (std::abs(late.z() - early.z()) >= kSteady) return false;
  mean_ = average(readings);
  return true;
}

}  // namespace palpate::baxter
