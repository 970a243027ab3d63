// SPDX-License-Identifier: MIT
// A comparison for people, as tables with a word on how to read them, and for programs, as rows.
#pragma once

#include "analysis/compare.hpp"

#include <string>
#include <vector>

namespace palpate {

/// The groups, a line each, and below them the pairs, in readable units; then what needs a remark.
std::string compare_tables(const Comparison& comparison);

/// What the intervals, p and effects of such tables mean.
std::string compare_legend(const std::vector<Comparison>& comparisons);

/// A row a group, then a row a pair, in SI units. `where` is the condition as it was written, "" for none.
std::vector<Row> compare_rows(const Comparison& comparison, const std::string& where);

}  // namespace palpate
