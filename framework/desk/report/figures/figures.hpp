// SPDX-License-Identifier: MIT
// Pictures of runs and sweeps: NAME.png in a folder, which is made, each with the script that draws it, and all its
// data, beside it as NAME.gnuplot.
#pragma once

#include "analysis/group_curves.hpp"
#include "record/recording.hpp"
#include "report/history.hpp"
#include "sweep/sweep.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace palpate {

/// What was written.
struct Figures {
  std::vector<std::filesystem::path> pictures;
  std::vector<std::string> notes;  ///< what could not be drawn for want of data, a line each
};

/// Of a run: `surface`, `maps` and `curves`. Throws Error, of kind `run` and with the scripts left, if gnuplot draws
/// none.
Figures write_run_figures(const Workshop& workshop, const Recording& recording, const History& history,
                          const std::filesystem::path& folder);

/// Of a sweep: `distributions`, `heat_map` where two keys but the seed are swept, and `curves` of the groups where
/// their values after each tap are kept, as `palpate curves` leaves them. Throws Error as above, and where
/// no job ended well.
Figures write_sweep_figures(const Sweep& sweep, const std::filesystem::path& folder);

/// The width of curves where nobody gives one, metres: the text of a page with two columns.
inline constexpr double kFigureWidth = 0.178;

/// Draws curves of groups into `file`, a .png, .pdf or .svg of this width in metres, with letters of 8 points in print:
/// a panel per scene, all with the same axes, in each a line with its band per group. Leaves the script, which has all
/// data, beside it as NAME.gnuplot; it begins with `title` and what a caption should say. Returns in words what is left
/// out of very many panels or groups, "" for nothing. Throws Error of kind `run`, with the script left, if gnuplot
/// draws nothing.
std::string write_curves_figure(const GroupCurves& curves, const std::string& title, double width,
                                const std::filesystem::path& file);

/// Of a run: `paper_progress`, in the grid of the paper's figure 2. Throws Error as above.
Figures write_paper_figures(const Workshop& workshop, const Recording& recording, const std::filesystem::path& folder);

/// Of a sweep: the paper's `figure_2` to `figure_5`, of the jobs that they need. Throws Error as above, and where not
/// one can be drawn.
Figures write_paper_figures(const Workshop& workshop, const Sweep& sweep, const std::filesystem::path& folder);

}  // namespace palpate
