// SPDX-License-Identifier: MIT
// Many taps of the driver with its shipped settings on a simulated arm, under disturbances of a real arm and its
// computer, compared with the truth.
#pragma once

#include "baxter/body_robot.hpp"
#include "baxter/tapper.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace palpate::baxter::test {

/// Conditions of the taps.
struct Condition {
  fake_baxter::MechanicsOptions arm;
  double stiffness = 1500.0;               ///< N/m, object
  bool spikes = false;                     ///< whether one reading of the force in a hundred is off by 9 N
  bool stalls = false;                     ///< whether three periods in a hundred are up to 50 ms longer
  std::vector<fake_baxter::Fault> faults;  ///< present from the start: delay, jitter, wrench_filter, force_drift
  std::string motion;                      ///< YAML of motion; empty: the shipped motion
};

/// Results of the taps.
struct Tally {
  int taps = 0;
  int contacts = 0;
  int touched = 0;                     ///< taps in which the tip truly touched
  int phantoms = 0;                    ///< contacts without a touch, or at least kFar from the true height
  int rejected = 0;                    ///< touches without a contact
  int ended = 0;                       ///< taps that ended a run
  int pressing = 0;                    ///< taps after which the arm kept pressing
  double peak = 0.0;                   ///< N, largest true force
  double error = 0.0;                  ///< m, largest error of a height
  double seconds = 0.0;                ///< s, sum over all taps
  double found = 0.0;                  ///< s, longest time from the first touch to the end of the contact
  int too_strong = 0;                  ///< taps with more than kMostForce
  std::map<std::string, int> reasons;  ///< reasons of taps without a contact

  static constexpr double kFar = 0.01;        ///< m
  static constexpr double kMostForce = 16.0;  ///< N at which the firmware stops the arm

  void add(const Tally& other);
  double rejection() const { return touched > 0 ? static_cast<double>(rejected) / touched : 0.0; }
};

/// Returns configs/backend/baxter.yaml with tool and scene pose of the simulated robot.
const BaxterOptions& shipped_options();

/// Taps object I and the desk around it at random positions on even surface, drawn from `seed`. A tap that ends the run
/// is followed by another run.
Tally campaign(const Condition& condition, int taps, std::uint64_t seed);

/// Returns counts and forces as one line.
std::string in_words(const Tally& tally);

}  // namespace palpate::baxter::test
