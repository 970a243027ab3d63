// SPDX-License-Identifier: MIT
#include "belief/object_errors.hpp"

#include <cmath>
#include <limits>

namespace palpate {
namespace {

/// The cells of a grid and their neighbours.
class CellGrid {
 public:
  explicit CellGrid(const CandidateGrid& candidates) : columns_(candidates.columns), rows_(candidates.rows) {}

  int size() const { return columns_ * rows_; }

  template <class Visit>
  void beside(int cell, bool corners, const Visit& visit) const {
    const int row = cell / columns_;
    const int column = cell % columns_;
    for (int down = -1; down <= 1; ++down) {
      for (int right = -1; right <= 1; ++right) {
        const bool shares_a_side = (down == 0) != (right == 0);
        if (!shares_a_side && !(corners && down != 0)) continue;
        if (row + down < 0 || row + down >= rows_ || column + right < 0 || column + right >= columns_) continue;
        visit(cell + down * columns_ + right);
      }
    }
  }

 private:
  int columns_, rows_;
};

/// Index of the component of each cell, counted from 0; -1 for cells without a component.
struct Components {
  std::vector<int> of;
  int count = 0;
};

template <class In>
Components components(const CellGrid& grid, const In& in) {
  Components out{std::vector<int>(static_cast<std::size_t>(grid.size()), -1), 0};
  std::vector<int> open;
  const auto take = [&](int cell) {
    if (!in(cell) || out.of[static_cast<std::size_t>(cell)] >= 0) return;
    out.of[static_cast<std::size_t>(cell)] = out.count;
    open.push_back(cell);
  };
  for (int cell = 0; cell < grid.size(); ++cell) {
    take(cell);
    if (open.empty()) continue;
    while (!open.empty()) {
      const int next = open.back();
      open.pop_back();
      grid.beside(next, false, take);
    }
    ++out.count;
  }
  return out;
}

/// Returns whether `part` cells are at least a fifth of `whole`.
bool has_a_fifth(int part, int whole) { return part > 0 && 5 * part >= whole; }

class ObjectComparison {
 public:
  ObjectComparison(const SurfaceMaps& maps, const Truth& truth, const CandidateGrid& candidates)
      : maps_(maps), truth_(truth), candidates_(candidates), grid_(candidates) {
    out_.resize(static_cast<std::size_t>(truth.objects));
    for (int cell = 0; cell < grid_.size(); ++cell) {
      if (truth_.object(cell) >= 0) ++at(truth_.object(cell)).cells;
    }
  }

  std::vector<ObjectErrors> take() {
    if (maps_.height != nullptr) measure_heights();
    if (maps_.probability != nullptr) {
      measure_outlines();
      find_merged_and_split();
    }
    return std::move(out_);
  }

 private:
  ObjectErrors& at(int object) { return out_[static_cast<std::size_t>(object)]; }
  bool predicted(int cell) const { return (*maps_.probability)(cell) >= 0.5; }

  void measure_heights() {
    std::vector<double> squares(out_.size());
    for (int cell = 0; cell < grid_.size(); ++cell) {
      if (truth_.object(cell) < 0) continue;
      const double error = (*maps_.height)(cell)-truth_.height(cell);
      squares[static_cast<std::size_t>(truth_.object(cell))] += error * error;
    }
    for (std::size_t i = 0; i < out_.size(); ++i) {
      if (out_[i].cells > 0) out_[i].rmse_height = std::sqrt(squares[i] / out_[i].cells);
    }
  }

  void measure_outlines() {
    // The nearest cell of an object to an outside cell always has a neighbour outside the object.
    std::vector<int> rim;
    for (int cell = 0; cell < grid_.size(); ++cell) {
      if (truth_.object(cell) < 0) continue;
      bool on_rim = false;
      grid_.beside(cell, false, [&](int other) { on_rim = on_rim || truth_.object(other) != truth_.object(cell); });
      if (on_rim) rim.push_back(cell);
    }
    std::vector<int> common(out_.size());
    std::vector<int> beyond(out_.size());
    for (int cell = 0; cell < grid_.size(); ++cell) {
      if (!predicted(cell)) continue;
      if (const int object = truth_.object(cell); object >= 0) {
        ++common[static_cast<std::size_t>(object)];
      } else if (const int nearest = nearest_object(cell, rim); nearest >= 0) {
        ++beyond[static_cast<std::size_t>(nearest)];
      }
    }
    for (std::size_t i = 0; i < out_.size(); ++i) {
      if (out_[i].cells > 0) out_[i].iou = static_cast<double>(common[i]) / (out_[i].cells + beyond[i]);
    }
  }

  /// Returns the object with the nearest rim cell; the first in the grid if several are equally near.
  int nearest_object(int cell, const std::vector<int>& rim) const {
    double least = std::numeric_limits<double>::infinity();
    int out = Scene::kNoObject;
    for (const int other : rim) {
      const double distance = (candidates_.points.row(other) - candidates_.points.row(cell)).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      out = truth_.object(other);
    }
    return out;
  }

  void find_merged_and_split() {
    const int objects = truth_.objects;
    const Components seen = components(grid_, [&](int cell) { return predicted(cell); });
    Eigen::ArrayXXi part = Eigen::ArrayXXi::Zero(objects, seen.count);
    Eigen::ArrayXXi touch = Eigen::ArrayXXi::Zero(objects, objects);
    for (int cell = 0; cell < grid_.size(); ++cell) {
      const int object = truth_.object(cell);
      if (object < 0) continue;
      if (const int component = seen.of[static_cast<std::size_t>(cell)]; component >= 0) ++part(object, component);
      grid_.beside(cell, true, [&](int other) {
        if (truth_.object(other) >= 0) touch(object, truth_.object(other)) = 1;
      });
    }
    for (int a = 0; a < objects; ++a) {
      int pieces = 0;
      for (int component = 0; component < seen.count; ++component) {
        if (!has_a_fifth(part(a, component), at(a).cells)) continue;
        ++pieces;
        for (int b = 0; b < a; ++b) {
          if (touch(a, b) != 0 || !has_a_fifth(part(b, component), at(b).cells)) continue;
          at(a).merged = at(b).merged = true;
        }
      }
      at(a).split = pieces > 1 && components(grid_, [&](int cell) { return truth_.object(cell) == a; }).count == 1;
    }
  }

  const SurfaceMaps& maps_;
  const Truth& truth_;
  const CandidateGrid& candidates_;
  CellGrid grid_;
  std::vector<ObjectErrors> out_;
};

}  // namespace

std::vector<ObjectErrors> object_errors(const SurfaceMaps& maps, const Truth& truth, const CandidateGrid& candidates) {
  return ObjectComparison(maps, truth, candidates).take();
}

}  // namespace palpate
