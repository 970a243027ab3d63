// SPDX-License-Identifier: MIT
// Many taps of the driver with its shipped settings, on an arm of the tests, under what may go wrong with a real one
// and its computer; and what became of them, against the truth.
#pragma once

#include "baxter/body_robot.hpp"
#include "baxter/tapper.hpp"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace palpate::baxter::test {

/// What the taps are done under.
struct Condition {
  fake_baxter::MechanicsOptions arm;
  double stiffness = 1500.0;               ///< of the object, N/m
  bool spikes = false;                     ///< one reading of the force in a hundred is 9 N off
  bool stalls = false;                     ///< three periods in a hundred take up to 50 ms longer
  std::vector<fake_baxter::Fault> faults;  ///< from the start: delay, jitter, wrench_filter, force_drift
  std::string motion;                      ///< YAML of motion; empty: the shipped one
};

/// What became of them.
struct Tally {
  int taps = 0;
  int contacts = 0;
  int touched = 0;                     ///< taps in which the tip really touched something
  int phantoms = 0;                    ///< contacts without a touch, or kFar or more from what there is
  int rejected = 0;                    ///< touched, and no contact
  int ended = 0;                       ///< a run
  int pressing = 0;                    ///< taps that left the arm pressing on something
  double peak = 0.0;                   ///< of the true force, N
  double error = 0.0;                  ///< the largest of the heights, m
  double seconds = 0.0;                ///< of all taps together
  double found = 0.0;                  ///< s, the longest from a first touch to the end of the contact
  int too_strong = 0;                  ///< taps with more than kMostForce
  std::map<std::string, int> reasons;  ///< of taps without a contact

  static constexpr double kFar = 0.01;        ///< m
  static constexpr double kMostForce = 16.0;  ///< N, at which the firmware stops the arm

  void add(const Tally& other);
  double rejection() const { return touched > 0 ? static_cast<double>(rejected) / touched : 0.0; }
};

/// configs/backend/baxter.yaml with the tool and the place of the tests' robot.
const BaxterOptions& shipped_options();

/// Taps object I and the desk around it, at places drawn from `seed` at which the surface is even. A tap that ends the
/// run is followed by another run.
Tally campaign(const Condition& condition, int taps, std::uint64_t seed);

/// One line: how many, and how hard.
std::string in_words(const Tally& tally);

}  // namespace palpate::baxter::test
