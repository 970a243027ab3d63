// SPDX-License-Identifier: MIT
#include "experiment/initial_design.hpp"

#include <palpate/random.hpp>

#include <boost/random/sobol.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace palpate {
namespace {

std::vector<int> draw_random(int count, int candidates, Random& random) {
  // The first steps of a Fisher-Yates shuffle.
  std::vector<int> order(static_cast<std::size_t>(candidates));
  std::iota(order.begin(), order.end(), 0);
  for (int i = 0; i < count; ++i) {
    const auto from = static_cast<std::size_t>(i) + random.index(static_cast<std::uint64_t>(candidates - i));
    std::swap(order[static_cast<std::size_t>(i)], order[from]);
  }
  order.resize(static_cast<std::size_t>(count));
  return order;
}

/// Adds the candidate nearest to (x, y) unless the design already has it.
void take(std::vector<int>& design, const CandidateGrid& candidates, double x, double y, const Area& area) {
  const int index = candidates.nearest(x, y, area);
  if (std::find(design.begin(), design.end(), index) == design.end()) design.push_back(index);
}

std::vector<int> draw_sobol(std::size_t count, const CandidateGrid& candidates, const Area& area, Random& random) {
  // A digital shift (Owen 2003) XORs one random bit pattern per axis with every point. Unlike a shift modulo 1, a
  // digital shift keeps the even spread of the points over halves, quarters, .... The bit patterns depend on the seed.
  const std::array<std::uint64_t, 2> shift{random.bits(), random.bits()};
  boost::random::sobol sequence(2);
  const auto coordinate = [](std::uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1.0p-53; };
  std::vector<int> design;
  std::array<std::uint64_t, 2> point{0, 0};  // Boost's sequence omits the origin, its first point
  for (std::size_t i = 0; design.size() < count && i < 64 * static_cast<std::size_t>(candidates.size()); ++i) {
    take(design, candidates, coordinate(point[0] ^ shift[0]) * area.width, coordinate(point[1] ^ shift[1]) * area.depth,
         area);
    for (std::uint64_t& axis : point) axis = sequence();
  }
  return design;
}

std::vector<int> draw_lattice(std::size_t count, const CandidateGrid& candidates, const Area& area) {
  const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))));
  std::vector<int> design;
  for (int i = 0; i < side * side && design.size() < count; ++i) {
    const int column = i % side;
    const int row = i / side;
    const double x = (column + 0.5) * area.width / side;
    const double y = (row + 0.5) * area.depth / side;
    take(design, candidates, x, y, area);
  }
  return design;
}

}  // namespace

std::vector<int> initial_design(const InitialOptions& options, const CandidateGrid& candidates, const Area& area,
                                std::uint64_t seed) {
  const auto count = static_cast<std::size_t>(options.count);
  Random random(seed, "initial");
  using Design = InitialOptions::Design;
  if (options.design == Design::search) return {};  // chosen one at a time: see SearchDesign
  if (options.design == Design::random) return draw_random(static_cast<int>(count), candidates.size(), random);
  std::vector<int> design = options.design == Design::sobol ? draw_sobol(count, candidates, area, random)
                                                            : draw_lattice(count, candidates, area);
  // If the design has nearly as many points as there are candidates, several points may have the same nearest
  // candidate. The design is then filled with unused candidates, in the order of their indices.
  for (int i = 0; design.size() < count; ++i) {
    if (std::find(design.begin(), design.end(), i) == design.end()) design.push_back(i);
  }
  return design;
}

}  // namespace palpate
