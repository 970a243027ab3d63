// SPDX-License-Identifier: MIT
// Memory for the loops of loops.hpp: numbers aligned to cache lines, and matrices in panels that grow by rows.
#pragma once

#include "gp/loops.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>

namespace palpate::loops {

constexpr int round_up(int value, int unit) { return (value + unit - 1) / unit * unit; }

/// Numbers from a cache line on, not initialised: memory that is never touched costs nothing.
class Lines {
 public:
  Lines() = default;
  /// Throws std::bad_alloc.
  explicit Lines(std::size_t size) : numbers_(allocate(size)), size_(size) {}

  std::size_t size() const { return size_; }
  double* data() { return numbers_.get(); }
  const double* data() const { return numbers_.get(); }

 private:
  static double* allocate(std::size_t size);
  struct Release {
    void operator()(double* numbers) const { std::free(numbers); }
  };
  std::unique_ptr<double, Release> numbers_;
  std::size_t size_ = 0;
};

/// A matrix that grows by rows, cut into panels of `width` columns; the rows of a panel follow each other in memory.
/// The last panel is as wide as its columns need, rounded up to `unit`; what lies beyond the columns is 0.
class Panels {
 public:
  Panels() = default;
  Panels(int columns, int width, int unit)
      : columns_(columns), width_(width), padded_(round_up(columns, unit)), panels_((columns + width - 1) / width) {}

  int panels() const { return panels_; }
  int rows() const { return rows_; }
  /// Columns with their padding.
  int padded() const { return padded_; }
  int width(int panel) const { return std::min(width_, padded_ - panel * width_); }
  /// Numbers from one panel to the next.
  std::size_t stride() const { return static_cast<std::size_t>(width_) * static_cast<std::size_t>(capacity_); }
  const double* panel(int panel) const { return numbers_.data() + static_cast<std::size_t>(panel) * stride(); }
  double* panel(int panel) { return numbers_.data() + static_cast<std::size_t>(panel) * stride(); }
  double* row(int panel, int row) { return this->panel(panel) + static_cast<std::ptrdiff_t>(row) * width(panel); }

  void clear() { rows_ = 0; }

  /// Room for so many rows; what is there is kept.
  void reserve(int rows) {
    if (rows <= capacity_) return;
    const Lines old = std::move(numbers_);
    const std::size_t old_stride = stride();
    capacity_ = rows;
    numbers_ = Lines(static_cast<std::size_t>(panels_) * stride());
    for (int p = 0; p < panels_; ++p) {
      const auto count = static_cast<std::ptrdiff_t>(rows_) * width(p);
      std::copy_n(old.data() + static_cast<std::size_t>(p) * old_stride, count, panel(p));
    }
  }

  /// One more row, not initialised.
  void extend() {
    if (rows_ == capacity_) reserve(std::max(16, 2 * capacity_));
    ++rows_;
  }

  /// One more row, from numbers at `values`.
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
  Lines numbers_;
};

}  // namespace palpate::loops
