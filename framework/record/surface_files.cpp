// SPDX-License-Identifier: MIT
#include "record/surface_files.hpp"

#include "record/mesh_ply.hpp"
#include "record/row.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate {
namespace {

using Column = std::pair<const char*, const Eigen::VectorXd*>;

/// Returns a table with x, y and one column per map; the cells of a null map are empty.
std::string grid_csv(const Candidates& candidates, const std::vector<Column>& columns) {
  std::string out = "x,y";
  for (const Column& column : columns) out.append(",").append(column.first);
  out += '\n';
  // Formatting every number would take half of the time of a short run, so texts are reused for the axes, for columns
  // with the same map, and for cells with the value of the previous cell.
  std::vector<std::string> xs(static_cast<std::size_t>(candidates.columns));
  for (int column = 0; column < candidates.columns; ++column)
    append_number(xs[static_cast<std::size_t>(column)], candidates.starts(column, 0));
  std::vector<std::size_t> first;  // for each column, the index of the first column with the same map
  for (const Column& column : columns) {
    const auto same = [&](const Column& other) { return other.second == column.second; };
    first.push_back(static_cast<std::size_t>(std::find_if(columns.begin(), columns.end(), same) - columns.begin()));
  }
  std::vector<std::pair<std::size_t, std::size_t>> cells(columns.size());  // offsets in `out`, and lengths
  for (int row = 0, cell = 0; row < candidates.rows; ++row) {
    std::string y = ",";
    append_number(y, candidates.starts(cell, 1));
    for (int column = 0; column < candidates.columns; ++column, ++cell) {
      out.append(xs[static_cast<std::size_t>(column)]).append(y);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        out += ',';
        const Eigen::VectorXd* const map = columns[i].second;
        const bool again = map != nullptr && cell > 0 && (*map)(cell) == (*map)(cell - 1) &&
                           std::signbit((*map)(cell)) == std::signbit((*map)(cell - 1));
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

/// Returns the array of a quantity, null if the belief has none.
const Eigen::VectorXd* array_of(Belief& belief, const char* quantity) {
  if (belief.available().count(quantity) == 0) return nullptr;
  return &belief.values(quantity);
}

std::string surface_csv(Experiment& experiment, const Eigen::VectorXd& heights) {
  Belief& belief = experiment.belief();
  const Candidates& candidates = belief.candidates();
  const Eigen::VectorXd* const mean = array_of(belief, quantity::kHeightMean);
  const bool is_mean = mean != nullptr && *mean == heights;
  const Scene* const truth = experiment.truth();
  const Eigen::VectorXd truly = truth != nullptr ? true_heights(candidates, *truth) : Eigen::VectorXd();
  return grid_csv(candidates, {{"height_mean", mean},
                               {"height_standard_deviation", array_of(belief, quantity::kHeightStd)},
                               {"object_probability", array_of(belief, quantity::kObjectProbability)},
                               {"reconstructed_height", is_mean ? mean : &heights},
                               {"true_height", truth != nullptr ? &truly : nullptr}});
}

}  // namespace

Eigen::VectorXd true_heights(const Candidates& candidates, const Scene& scene) {
  Eigen::VectorXd out(candidates.size());
  for (Eigen::Index i = 0; i < candidates.size(); ++i)
    out(i) = scene.height(candidates.starts(i, 0), candidates.starts(i, 1));
  return out;
}

std::pair<std::string, std::string> surface_file(Experiment& experiment) {
  const Surface surface = experiment.belief().surface(kFineResolution);
  if (surface.heights.size() > 0) return {"surface.csv", surface_csv(experiment, surface.heights)};
  return {"surface.ply", mesh_ply(surface, "standard_deviation", "metres, in the frame of the area")};
}

std::string maps_csv(Belief& belief, const BeliefState& state) {
  if (!belief.candidates().fixed) return "";
  std::vector<Column> columns;
  for (const auto& [column, quantity] :
       {std::pair{"height_mean", quantity::kHeightMean}, std::pair{"height_standard_deviation", quantity::kHeightStd},
        std::pair{"u", quantity::kUncertainty}, std::pair{"w", quantity::kLabelMean},
        std::pair{"p", quantity::kObjectProbability}}) {
    const bool is_of_label_gp = quantity == quantity::kObjectProbability && state.find("p") == nullptr;
    if (is_of_label_gp) continue;  // this probability can be computed from column w
    if (const Eigen::VectorXd* const map = array_of(belief, quantity)) columns.emplace_back(column, map);
  }
  return columns.empty() ? "" : grid_csv(belief.candidates(), columns);
}

}  // namespace palpate
