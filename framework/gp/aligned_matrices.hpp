// SPDX-License-Identifier: MIT
// Memory for the loops of vector_loops.hpp: arrays aligned to cache lines, and matrices that grow by rows.
#pragma once

#include "gp/vector_loops.hpp"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace palpate::loops {

constexpr int round_up(int value, int unit) { return (value + unit - 1) / unit * unit; }

/// Array of numbers, aligned to a cache line. It is not initialised, so unused memory costs nothing.
class AlignedArray {
 public:
  AlignedArray() = default;
  /// Throws std::bad_alloc.
  explicit AlignedArray(std::size_t size)
      : numbers_(static_cast<double*>(::operator new(size * sizeof(double), kAlignment))), size_(size) {}

  std::size_t size() const { return size_; }
  double* data() { return numbers_.get(); }
  const double* data() const { return numbers_.get(); }

 private:
  static constexpr std::align_val_t kAlignment{kLineBytes};
  struct Release {
    void operator()(double* numbers) const { ::operator delete(numbers, kAlignment); }
  };
  std::unique_ptr<double, Release> numbers_;
  std::size_t size_ = 0;
};

/// Matrix that grows by rows, divided into panels of `width` columns. The rows of a panel are contiguous in memory. The
/// last panel has the remaining columns; their number is rounded up to a multiple of `unit`, and the padding is 0.
class Panels {
 public:
  Panels() = default;
  Panels(int columns, int width, int unit)
      : columns_(columns), width_(width), padded_(round_up(columns, unit)), panels_((columns + width - 1) / width) {}

  int panels() const { return panels_; }
  int rows() const { return rows_; }
  /// Returns the number of columns with padding.
  int padded() const { return padded_; }
  int width(int panel) const { return std::min(width_, padded_ - panel * width_); }
  /// Returns the distance between panels, in numbers.
  std::size_t stride() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(capacity_); }
  const double* panel(int panel) const { return numbers_.data() + static_cast<std::size_t>(panel) * stride(); }
  double* panel(int panel) { return numbers_.data() + static_cast<std::size_t>(panel) * stride(); }
  double* row(int panel, int row) { return this->panel(panel) + static_cast<std::ptrdiff_t>(row) * width(panel); }

  void clear() { rows_ = 0; }

  /// Reserves memory for this many rows. Keeps the rows.
  void reserve(int rows) {
    if (rows <= capacity_) return;
    const AlignedArray old = std::move(numbers_);
    const std::size_t old_stride = stride();
    capacity_ = rows;
    numbers_ = AlignedArray(static_cast<std::size_t>(panels_) * stride());
    for (int p = 0; p < panels_; ++p) {
      const auto count = static_cast<std::ptrdiff_t>(rows_) * width(p);
      std::copy_n(old.data() + static_cast<std::size_t>(p) * old_stride, count, panel(p));
    }
  }

  /// Adds a row whose values are not initialised.
  void extend() {
    if (rows_ == capacity_) reserve(std::max(16, 2 * capacity_));
    ++rows_;
  }

  /// Adds a row with these values, one per column.
  void append(const double* values) {
    extend();
    for (int p = 0; p < panels_; ++p) {
      double* const out = row(p, rows_ - 1);
      const int first = p * width_;
      const int count = std::min(width(p), columns_ - first);
      for (int i = 0; i < count; ++i) out[i] = values[first + i];
      std::fill(out + count, out + width(p), 0.0);
    }
  }

 private:
  int columns_ = 0;
  int width_ = 1;
  int padded_ = 0;
  int panels_ = 0;
  int rows_ = 0;
  int capacity_ = 0;
  AlignedArray numbers_;
};

}  // namespace palpate::loops
