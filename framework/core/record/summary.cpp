// SPDX-License-Identifier: MIT
#include "record/summary.hpp"

#include <array>
#include <charconv>
#include <ctime>
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
/// and once for the coordinates.
std::string grid_csv(const Candidates& candidates, const std::vector<Column>& columns) {
  std::string out = "x,y";
  for (const Column& column : columns) out += std::string(",") + column.first;
  out += '\n';
  out.reserve(out.size() + static_cast<std::size_t>(candidates.size()) * (columns.size() + 2) * 20);
  const auto append = [](std::string& to, double value) {
    std::array<char, 24> text;  // as long as a double in shortest form may be
    to.append(text.data(), std::to_chars(text.begin(), text.end(), value).ptr);
  };
  std::vector<std::string> xs(static_cast<std::size_t>(candidates.columns));
  for (std::size_t i = 0; i < xs.size(); ++i) append(xs[i], candidates.points(static_cast<Eigen::Index>(i), 0));
  for (int row = 0, cell = 0; row < candidates.rows; ++row) {
    std::string y = ",";
    append(y, candidates.points(cell, 1));
    for (const std::string& x : xs) {
      out.append(x).append(y);
      for (const Column& column : columns) {
        out += ',';
        if (column.second != nullptr) append(out, (*column.second)(cell));
      }
      out += '\n';
      ++cell;
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
