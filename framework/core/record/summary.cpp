// SPDX-License-Identifier: MIT
#include "record/summary.hpp"

#include "record/row.hpp"

#include <algorithm>
#include <cstdint>
#include <cstring>
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

/// x, y and one column per map; a null map leaves its cells empty.
std::string grid_csv(const Candidates& candidates, const std::vector<Column>& columns) {
  std::string out = "x,y";
  for (const Column& column : columns) out.append(",").append(column.first);
  out += '\n';
  // Half of the time of a short run would go into numbers that were written before: those of the axes, of columns with
  // the same map as an earlier one, and of places with the same value as the one before.
  const auto text_of = [](double value) {
    std::string text;
    append_number(text, value);
    return text;
  };
  std::vector<std::string> xs;
  for (int column = 0; column < candidates.columns; ++column) xs.push_back(text_of(candidates.points(column, 0)) + ",");
  std::vector<std::size_t> first;  // of the columns with the same map
  for (const Column& column : columns) {
    const auto same = [&](const Column& other) { return other.second == column.second; };
    first.push_back(static_cast<std::size_t>(std::find_if(columns.begin(), columns.end(), same) - columns.begin()));
  }
  std::vector<std::pair<std::size_t, std::size_t>> cells(columns.size());  // places in `out`, and lengths
  for (int row = 0, cell = 0; row < candidates.rows; ++row) {
    const std::string y = text_of(candidates.points(cell, 1));
    for (int column = 0; column < candidates.columns; ++column, ++cell) {
      out.append(xs[static_cast<std::size_t>(column)]).append(y);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        out += ',';
        const Eigen::VectorXd* const map = columns[i].second;
        const bool again =
            map != nullptr && cell > 0 && std::memcmp(&(*map)(cell), &(*map)(cell - 1), sizeof(double)) == 0;
        if (first[i] < i || again) {
          const auto [place, length] = cells[first[i]];
          out.append(out, place, length);
          continue;
        }
        cells[i].first = out.size();
        if (map != nullptr) append_number(out, (*map)(cell));
        cells[i].second = out.size() - cells[i].first;
      }
      out += '\n';
    }
  }
  return out;
}

std::string surface_csv(FromAbove& experiment) {
  experiment.ask(Quantity::height | Quantity::probability);
  const TapBelief& belief = experiment.belief();
  const Eigen::VectorXd deviation = belief.height_variance().cwiseSqrt();
  const Eigen::VectorXd gated = belief.two_part() ? reconstruction(belief) : Eigen::VectorXd();
  const Truth* truth = experiment.truth();
  return grid_csv(experiment.candidates(),
                  {{"height_mean", &belief.height_mean()},
                   {"height_standard_deviation", &deviation},
                   {"object_probability", &belief.probability()},
                   {"reconstructed_height", belief.two_part() ? &gated : &belief.height_mean()},
                   {"true_height", truth != nullptr ? &truth->height : nullptr}});
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

std::pair<std::string, std::string> surface_file(Experiment& experiment) {
  if (auto* const any_side = dynamic_cast<FromAnySide*>(&experiment)) return {"surface.ply", any_side->surface_ply()};
  return {"surface.csv", surface_csv(from_above_of(experiment, ""))};
}

std::string maps_csv(const FromAbove& experiment) {
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
  return columns.empty() ? "" : grid_csv(experiment.candidates(), columns);
}

}  // namespace palpate
