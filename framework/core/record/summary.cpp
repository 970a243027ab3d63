// SPDX-License-Identifier: MIT
#include "record/summary.hpp"

#include <algorithm>
#include <charconv>
#include <ctime>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/resource.h>

namespace palpate {
namespace {

double thread_cpu_seconds() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

using Column = std::pair<const char*, const Eigen::VectorXd*>;

/// x, y and one column a map; a null map leaves its cells empty. Thousands of numbers: to_chars, the fastest there is,
/// and once for the coordinates and for a map that stands there twice.
std::string grid_csv(const Candidates& candidates, const std::vector<Column>& columns) {
  constexpr std::size_t kLongest = 24;  // a double in shortest form
  std::vector<char> line((columns.size() + 2) * (kLongest + 1));
  const auto put = [](char* to, double value) { return std::to_chars(to, to + kLongest, value).ptr; };
  const auto text = [&](double value) { return std::string(line.data(), put(line.data(), value)); };
  std::vector<std::string> xs;
  for (int i = 0; i < candidates.columns; ++i) xs.push_back(text(candidates.points(i, 0)) + ',');

  std::string out = "x,y";
  std::vector<std::size_t> twins;  // the first column of the same map
  for (const Column& column : columns) {
    out += std::string(",") + column.first;
    const auto same = [&](const Column& one) { return one.second == column.second; };
    twins.push_back(static_cast<std::size_t>(std::find_if(columns.begin(), columns.end(), same) - columns.begin()));
  }
  out += '\n';
  out.reserve(out.size() + static_cast<std::size_t>(candidates.size()) * (columns.size() + 2) * 20);
  std::vector<std::string_view> cells(columns.size());  // of one line
  for (int row = 0; row < candidates.rows; ++row) {
    const std::string y = text(candidates.points(row * candidates.columns, 1));
    for (int i = 0; i < candidates.columns; ++i) {
      const std::string& x = xs[static_cast<std::size_t>(i)];
      char* end = std::copy(y.begin(), y.end(), std::copy(x.begin(), x.end(), line.data()));
      for (std::size_t c = 0; c < columns.size(); ++c) {
        *end++ = ',';
        char* const begin = end;
        if (twins[c] < c) {
          end = std::copy(cells[twins[c]].begin(), cells[twins[c]].end(), end);
        } else if (columns[c].second != nullptr) {
          end = put(end, (*columns[c].second)(row * candidates.columns + i));
        }
        cells[c] = {begin, static_cast<std::size_t>(end - begin)};
      }
      *end++ = '\n';
      out.append(line.data(), static_cast<std::size_t>(end - line.data()));
    }
  }
  return out;
}

}  // namespace

Stopwatch::Stopwatch() : wall_(std::chrono::steady_clock::now()), cpu_(thread_cpu_seconds()) {}
double Stopwatch::wall_seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
}
double Stopwatch::cpu_seconds() const { return thread_cpu_seconds() - cpu_; }

std::int64_t peak_rss_bytes() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

std::string surface_csv(Experiment& experiment) {
  experiment.ask(Quantity::height | Quantity::probability);
  const TapBelief& belief = experiment.belief();
  const Eigen::VectorXd deviation = belief.height_variance().cwiseSqrt();
  const Eigen::VectorXd gated = belief.two_part() ? reconstruction(belief) : Eigen::VectorXd();
  const Truth* truth = experiment.truth();
  return grid_csv(experiment.candidates(),
                  {{"height_mean", &belief.height_mean()},
                   {"height_standard_deviation", &deviation},
                   {"on_surface_probability", &belief.probability()},
                   {"reconstructed_height", belief.two_part() ? &gated : &belief.height_mean()},
                   {"true_height", truth != nullptr ? &truth->height : nullptr}});
}

std::string maps_csv(const Experiment& experiment) {
  const TapBelief& belief = experiment.belief();
  const Quantities known = belief.recorded();
  std::vector<Column> columns;
  if (known.has(Quantity::height)) {
    columns.insert(columns.end(),
                   {{"height_mean", &belief.height_mean()}, {"height_variance", &belief.height_variance()}});
  }
  if (known.has(Quantity::uncertainty)) columns.emplace_back("u", &belief.uncertainty());
  if (known.has(Quantity::weight)) columns.emplace_back("w", &belief.weight());
  if (known.has(Quantity::probability) && !belief.footprint_is_weight()) {
    columns.emplace_back("p", &belief.probability());
  }
  return columns.empty() ? std::string() : grid_csv(experiment.candidates(), columns);
}

}  // namespace palpate
