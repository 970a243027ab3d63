// SPDX-License-Identifier: MIT
// Rows of the table: a case, run through the framework on every posterior engine that serves its kernel, and held
// against what is true.
#pragma once

#include "stability/cases.hpp"

#include <string>
#include <vector>

namespace palpate::stability {

/// Errors and bounds are in units of a scale, lengths and variances apart: prior variances for variances; for means,
/// prior standard deviations times max(1, largest standardised target), as the mean is linear in the targets, or the
/// largest posterior mean itself where that is larger: an answer of a thousand prior deviations is not known to
/// the rounding of one.
///
/// With n taps, eps = 2.2e-16 and cond the 2-norm condition number of their covariance with noise, the bound of both
/// errors is
///     cond < 1e8            min(10 n eps cond, 1e-6)
///     1e8 <= cond < 1e12    n eps cond
///     beyond                the least of n eps cond', the sensitivity of this very answer and a cap, where cond' is of
///                           the matrix A with its jitter, and the truth is that of the model with the jitter.
/// The sensitivity is what a backward error of n eps |A| can do to first order: n eps |A| |A^-1 k_*| |A^-1 y| to a mean
/// and n eps |A| |A^-1 k_*|^2 to a variance. The cap keeps the bound below what would be no answer at all.
///
/// `lowrank` may add its tolerance times cond, up to the caps, and its tolerance to the residual; `auto`, which lets no
/// engine add more than its accuracy, is held to the bound of `grid`.
struct Row {
  std::string name;
  std::string engine = "dense";  ///< as a config names it
  int points = 0;
  double condition = 1.0;      ///< cond; infinite from 1e14 on
  double jitter = 0.0;         ///< relative to the prior variance
  double jitter_effect = 0.0;  ///< what the jitter itself changes, without rounding; NaN where that is not known
  double mean_error = 0.0;
  double mean_bound = 0.0;
  double variance_error = 0.0;
  double variance_bound = 0.0;
  /// |m - m*| / (|A| |alpha| + |y|) over the taps, m* the true mean: a backward error, small for any condition number.
  double residual = 0.0;
  std::string trouble;  ///< empty if the row holds

  double n_eps() const;
};

/// Up to here the bound is that of a matrix that double precision can hold.
constexpr double kBeyond = 1e12;
constexpr double kMeanCap = 0.1;
constexpr double kVarianceCap = 1e-4;

/// Multiples of n eps. The jitter is the promise to users; a residual of one n eps is ten times what was ever measured.
constexpr double kJitterLimit = 100.0;
constexpr double kResidualLimit = 1.0;

/// Of `dense`, and for a separable kernel of all engines.
std::vector<Row> check(const Case& one);

/// The names of the columns, and a row, separated by commas. An unknown effect is an empty cell.
std::string header();
std::string text(const Row& row);

}  // namespace palpate::stability
