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

/// x, y and one column a map; a null map leaves its cells empty.
std::string grid_csv(const Candidates& candidates, const std::vector<Column>& columns) {
  std::string out = "x,y";
  for (const Column& column : columns) out.append(",").append(column.first);
  const auto add = [&](char separator, double value) {
    std::array<char, 32> text;
    out += separator;
    out.append(text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr);
  };
  for (Eigen::Index cell = 0; cell < candidates.points.rows(); ++cell) {
    add('\n', candidates.points(cell, 0));
    add(',', candidates.points(cell, 1));
    for (const Column& column : columns) {
      if (column.second != nullptr) {
        add(',', (*column.second)(cell));
      } else {
        out += ',';
      }
    }
  }
  return out + "\n";
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
  return columns.empty() ? std::string() : grid_csv(experiment.candidates(), columns);
}

}  // namespace palpate
