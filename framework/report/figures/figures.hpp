// SPDX-License-Identifier: MIT
// Figures of runs and sweeps. Each figure is NAME.png in a folder, which is created, with its script and data in
// NAME.gnuplot.
#pragma once

#include "analysis/group_curves.hpp"
#include "record/run_replay.hpp"
#include "report/history.hpp"
#include "sweep/sweep.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// Result of drawing figures.
struct Figures {
  std::vector<std::filesystem::path> pictures;
  std::vector<std::string> notes;  ///< figures that lack data, one line each
};

/// Draws the figures `surface`, `maps` and `curves` of a run. Throws Error of kind `run` if gnuplot fails; the scripts
/// remain.
Figures write_run_figures(const RunEnvironment& environment, const RecordedRun& recording, const History& history,
                          const std::filesystem::path& folder);

/// Draws the figures of a sweep: `distributions`; `heat_map` if two keys besides the seed are swept; `curves` if the
/// values after each tap are stored, as `palpate curves` stores them. Throws Error as above, and if no job has ended
/// without a failure.
Figures write_sweep_figures(const Sweep& sweep, const std::filesystem::path& folder);

/// Default width of curves, metres: the text width of a page with two columns.
inline constexpr double kFigureWidth = 0.178;

/// Draws curves of groups into `file`, a .png, .pdf or .svg of this width in metres, with letters of 8 points in print.
/// Each scene has a panel with the same axes, each group a line with a band. The script with all data remains as
/// NAME.gnuplot; its first comments have `title` and the text for a caption. Returns a remark on panels or groups that
/// are not drawn because there are too many; "" if all are drawn. Throws Error of kind `run` if gnuplot fails; the
/// script remains.
std::string write_curves_figure(const GroupCurves& curves, const std::string& title, double width,
                                const std::filesystem::path& file);

/// Draws `paper_progress` of a run, in the layout of the paper's figure 2. Throws Error as above.
Figures write_paper_figures(const RunEnvironment& environment, const RecordedRun& recording,
                            const std::filesystem::path& folder);

/// Draws the paper's `figure_2` to `figure_5` from a sweep with the jobs that they need. Throws Error as above, and if
/// jobs are missing for all of them.
Figures write_paper_figures(const RunEnvironment& environment, const Sweep& sweep, const std::filesystem::path& folder);

}  // namespace palpate
