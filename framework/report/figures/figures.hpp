// SPDX-License-Identifier: MIT
// Figures of runs and sweeps. Each figure is a file NAME.png in a folder, with its script and data in NAME.gnuplot. The
// folder is created.
#pragma once

#include "analysis/group_curves.hpp"
#include "report/history.hpp"
#include "sweep/sweep.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// Result of drawing figures.
struct Figures {
  std::vector<std::filesystem::path> pictures;
  std::vector<std::string> notes;  ///< one line per figure that lacks data
};

/// Draws the figures `surface`, `maps` and `curves` of a run. Throws Error of kind `run` if gnuplot fails; the scripts
/// remain.
Figures write_run_figures(const RunEnvironment& environment, const RecordedRun& recording, const History& history,
                          const std::filesystem::path& folder);

/// Draws the figures of a sweep. `distributions` is always drawn. `heat_map` is drawn if two keys besides the seed are
/// swept. `curves` is drawn if `palpate curves` has stored the values after each tap. Throws the errors of
/// write_run_figures(), and Error if every job has failed or is unfinished.
Figures write_sweep_figures(const Sweep& sweep, const std::filesystem::path& folder);

/// Default width of figures with curves, metres: the text width of a page with two columns.
inline constexpr double kFigureWidth = 0.178;

/// Draws curves of groups into `file`, a .png, .pdf or .svg. The picture is `width` metres wide, and its letters have 8
/// points in print. Each scene has one panel, and all panels have the same axes. Each group has a line (the mean) with
/// a band (the interval). The script with all data remains as NAME.gnuplot. Comments at its beginning contain `title`
/// and the text of a caption. Returns a remark about panels or groups that are not drawn because there are too many.
/// Returns "" if all are drawn. Throws Error of kind `run` if gnuplot fails; the script remains.
std::string write_curves_figure(const GroupCurves& curves, const std::string& title, double width,
                                const std::filesystem::path& file);

/// Draws the figure `paper_progress` of a run, in the layout of figure 2 of the paper (Sun and Min 2021, arXiv
/// 2110.09593). Throws the errors of write_run_figures().
Figures write_paper_figures(const RunEnvironment& environment, const RecordedRun& recording,
                            const std::filesystem::path& folder);

/// Draws `figure_2` to `figure_5` from a sweep with the necessary jobs. They reproduce figures 2 to 5 of the paper (Sun
/// and Min 2021). Throws the errors of write_run_figures(), and Error if every figure lacks jobs.
Figures write_paper_figures(const RunEnvironment& environment, const Sweep& sweep, const std::filesystem::path& folder);

}  // namespace palpate
