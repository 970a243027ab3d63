// SPDX-License-Identifier: MIT
// A run looked at from each of its taps: what was believed then, how wrong it was, where the next tap would go. All of
// it is computed again from the recorded taps, so that runs need not store their maps.
#pragma once

#include "report/snapshot.hpp"

#include <functional>
#include <string>
#include <vector>

namespace palpate {

/// One quantity over the candidates at several moments; all frames have the same number of cells.
struct MapSeries {
  std::string name;
  std::vector<Eigen::VectorXf> frames;
};

struct History {
  std::vector<Moment> moments;  ///< before the first tap, and after each
  /// "height" (of the reconstruction, metres), "deviation" (its standard deviation, metres, at most
  /// the largest that the height process has at any moment: that of an object's level before it is touched means
  /// nothing), "u", "w" or, where the footprint is not the weight, "p", and "score" where the acquisition's is none of
  /// these nor u w: a frame for each moment.
  /// Last, where truth is known, "truth" in one frame, metres.
  std::vector<MapSeries> maps;
  Eigen::VectorXd x, y;  ///< of the columns and rows of the maps, metres; a map has row after row
};

/// Tells how many of all taps are done.
using OnProgress = std::function<void(int done, int all)>;

/// Maps of more columns or rows than this have only every second, third, ... of them.
inline constexpr int kMostCellsAcross = 128;

/// Lives through the taps of a recorded run again. Throws Error as Playback does.
History make_history(const Workshop& workshop, const Recording& recording, const OnProgress& progress);

}  // namespace palpate
