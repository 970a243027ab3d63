// SPDX-License-Identifier: MIT
// The figures that are made, one function each, and the folder that they are written to. report/figures/figures.hpp
// says which belong to what.
#pragma once

#include "report/figures/figures.hpp"
#include "report/figures/sheet.hpp"
#include "report/history.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpate {

/// A picture before it is drawn.
struct Figure {
  std::string name;
  Sheet sheet;
};

Figure surface_figure(const ExperimentOptions& options, const Ground& ground, const Snapshot& last);
Figure maps_figure(const ExperimentOptions& options, const Ground& ground, const Snapshot& last);
/// Curves over the taps. What the run has not is left out. Throws Error for a damaged timings.csv.
Figure curves_figure(const Recording& recording, const History& history);

/// What a figure of the paper shows of one run.
struct Progress {
  std::string strategy;
  std::vector<int> iterations;
  std::vector<Snapshot> snapshots;  ///< one for each iteration
  Ground ground;
};

/// The run after these iterations of the paper: k is the state after k taps beyond the initial ones but one. The first
/// that lies beyond the run's end shows its last tap, those after it are left out.
Progress progress_of(const Workshop& workshop, const Recording& recording, const std::vector<int>& iterations);

/// A panel for each of the run's snapshots: the surface seen from the side, or the map of the scores or of u.
struct PanelRow {
  const Progress& run;
  Eigen::VectorXd Snapshot::*map;
};
/// Rows below each other, of one run or of several with as many snapshots; `rows` is not empty.
Figure panels_figure(const std::string& name, const std::string& title, const std::vector<PanelRow>& rows);
/// Surfaces above, the strategy's suggestion function below: figures 2 and 3.
Figure progress_figure(const std::string& name, const std::string& title, const Progress& progress);

/// The paper's figures of a sweep; adds to `notes` which job is missing for which.
std::vector<Figure> paper_figures(const Workshop& workshop, const Sweep& sweep, std::vector<std::string>& notes);

Figure distributions_figure(const Sweep& sweep, const std::vector<Row>& results);
/// Of two swept keys but the seed that have two values or more; empty where there are none.
std::vector<Figure> heat_maps(const Sweep& sweep, const std::vector<Row>& results);

/// Writes all scripts to `folder`, then draws them. Throws Error.
std::vector<std::filesystem::path> write_gallery(const std::filesystem::path& folder,
                                                 const std::vector<Figure>& figures);

}  // namespace palpate
