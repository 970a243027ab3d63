// SPDX-License-Identifier: MIT
#include "gp/candidates.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

Candidates grid(const Area& area, int columns, int rows) {
  Candidates out{columns, rows, Points(columns * rows, 2)};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int index = row * columns + column;
      out.points(index, 0) = (column + 0.5) * area.width / columns;
      out.points(index, 1) = (row + 0.5) * area.depth / rows;
    }
  }
  return out;
}

int cell(double place, double side, int count) {
  return static_cast<int>(std::clamp(std::floor(place / side * count), 0.0, count - 1.0));
}

}  // namespace

int Candidates::nearest(double x, double y, const Area& area) const {
  return cell(y, area.depth, rows) * columns + cell(x, area.width, columns);
}

Candidates grid_by_count(const Area& area, int count) { return grid(area, count, count); }

Candidates grid_by_spacing(const Area& area, double spacing) {
  const auto cells = [spacing](double side) { return static_cast<int>(cells_along(side, spacing)); };
  return grid(area, cells(area.width), cells(area.depth));
}

double cells_along(double side, double spacing) { return std::max(1.0, std::round(side / spacing)); }

}  // namespace palpate
