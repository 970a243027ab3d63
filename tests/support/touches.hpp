// SPDX-License-Identifier: MIT
// Touches that try a footprint, and places to ask it about: what the contract and the extremes share.
#pragma once

#include "support/arrays.hpp"

#include <palpate/footprint.hpp>
#include <palpate/random.hpp>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace palpate::test {

inline Touch touch_at(double x, double y, bool on) { return {{x, y}, on ? 0.05 : 0.0, on}; }

/// Places drawn over 23 cm by 23 cm, those within 5 cm of the middle on an object.
inline std::vector<Touch> disc_touches(int count, std::uint64_t seed = 1) {
  Random random(seed, "disc touches");
  std::vector<Touch> out;
  for (int i = 0; i < count; ++i) {
    const double x = 0.23 * random.uniform();
    const double y = 0.23 * random.uniform();
    out.push_back(touch_at(x, y, std::hypot(x - 0.115, y - 0.115) < 0.05));
  }
  return out;
}

/// `count` touches spread over the area, all of one label.
inline std::vector<Touch> alike_touches(int count, bool on) {
  std::vector<Touch> out = disc_touches(count, 2);
  for (Touch& touch : out) touch = touch_at(touch.place.x, touch.place.y, on);
  return out;
}

/// `count` touches at one place, by turns on and off an object, each `apart` metres from the one before.
inline std::vector<Touch> contradictory_touches(int count, double apart = 0.0) {
  std::vector<Touch> out;
  for (int i = 0; i < count; ++i) out.push_back(touch_at(0.1 + i * apart, 0.12, i % 2 == 0));
  return out;
}

/// Labels without any order: no outline of any form explains them.
inline std::vector<Touch> disorderly_touches(int count) {
  Random random(3, "disorderly touches");
  std::vector<Touch> out = disc_touches(count, 4);
  for (Touch& touch : out) touch = touch_at(touch.place.x, touch.place.y, random.uniform() < 0.5);
  return out;
}

/// Touches by name: everything short of a thousand that the laws of footprint.hpp speak of.
inline std::vector<std::pair<std::string, std::vector<Touch>>> trying_touches() {
  return {{"none", {}},
          {"all on an object", alike_touches(25, true)},
          {"all on the desk", alike_touches(25, false)},
          {"contradictory at one place", contradictory_touches(24)},
          {"contradictory and nearly at one place", contradictory_touches(24, 1e-12)},
          {"without order", disorderly_touches(40)},
          {"an object in the middle", disc_touches(40)}};
}

/// The centres of `columns` x `rows` cells of 23 cm by 23 cm, row by row.
inline Points lattice(int columns, int rows) {
  Points out(columns * rows, 2);
  for (int i = 0; i < columns * rows; ++i)
    out.row(i) << 0.23 * (i % columns + 0.5) / columns, 0.23 * (static_cast<int>(i / columns) + 0.5) / rows;
  return out;
}

inline Points scattered(int count) {
  Random random(5, "scattered places");
  Points out(count, 2);
  for (int i = 0; i < count; ++i) out.row(i) << 0.23 * random.uniform(), 0.23 * random.uniform();
  return out;
}

/// Each place once more, `apart` metres beside itself.
inline Points doubled(const Points& places, double apart) {
  Points out(2 * places.rows(), 2);
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    out.row(2 * i) = places.row(i);
    out.row(2 * i + 1) << places(i, 0) + apart, places(i, 1);
  }
  return out;
}

/// Sets of places by name: those that a run has, and others that a caller may have.
inline std::vector<std::pair<std::string, Points>> trying_places() {
  return {{"a lattice", lattice(23, 23)},
          {"one row", lattice(23, 1)},
          {"one column", lattice(1, 23)},
          {"one place", lattice(1, 1)},
          {"scattered places", scattered(50)},
          {"places twice", doubled(scattered(20), 0.0)},
          {"near places", doubled(scattered(20), 1e-13)}};
}

inline Eigen::VectorXd probability_of(Footprint& footprint, const Points& places) {
  Eigen::VectorXd out = Eigen::VectorXd::Constant(places.rows(), std::nan(""));
  footprint.probability(places, out);
  return out;
}

inline void take(Footprint& footprint, const std::vector<Touch>& touches) {
  for (const Touch& touch : touches) footprint.add(touch);
}

/// Finite and in [0, 1].
inline bool all_probabilities(const Eigen::VectorXd& values) {
  return values.allFinite() && (values.array() >= 0.0).all() && (values.array() <= 1.0).all();
}

}  // namespace palpate::test
