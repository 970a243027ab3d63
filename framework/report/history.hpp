// SPDX-License-Identifier: MIT
// History of a run: belief, errors and next choice after each of its taps. All of it is computed from the recorded
// taps, so runs need not store their maps.
#pragma once

#include "record/run_replay.hpp"
#include "report/contours.hpp"

#include <palpate/error.hpp>
#include <palpate/surface.hpp>
#include <palpate/types.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A tap as figures mark it.
struct TapMark {
  enum class Kind { on, off, failed };
  int tap = 1;
  Kind kind = Kind::failed;  ///< by the label that the contact has at that moment
  double x = 0.0;            ///< metres, as is `y`
  double y = 0.0;
  double height = 0.0;  ///< metres; the height of the desk for a tap without a contact
};

/// State of a run after its first `taps` taps.
struct RunAtTap {
  int taps = 0;
  RunResult result;                  ///< the result if the run had ended here
  std::optional<TapRecord> next;     ///< the next tap; nullopt if no candidate is left, or if its choice is unknown
  bool is_next_known = true;         ///< false if a program chooses: reports do not start programs
  std::optional<double> next_along;  ///< from any side: path length of the next tap by the most probable particle
  std::vector<TapReading> suspected_outliers;  ///< contacts that may be outliers
  double largest_deviation = 0.0;  ///< greatest standard deviation, metres: of the candidates' heights given all taps;
                                   ///< from any side of the surface
  /// Range of the label GP's mean over the candidates; nullopt if the footprint is not the weight.
  std::optional<double> least_weight, most_weight;
};

/// The same with the maps of the belief, one value per candidate.
struct MapsAtTap : RunAtTap {
  std::vector<TapMark> marks;   ///< these taps in their order
  Eigen::VectorXd surface;      ///< reconstructed heights, metres
  Eigen::VectorXd deviation;    ///< standard deviation of the height, metres
  Eigen::VectorXd uncertainty;  ///< u
  /// Either w, as the strategy reads it, if the footprint is the weight, or the footprint's p. The other vector is
  /// empty.
  Eigen::VectorXd weight;
  Eigen::VectorXd probability;
  bool has_scores = true;  ///< whether the strategy gives scores
  Eigen::VectorXd scores;  ///< scores of the candidates; 0 without scores
  bool has_weight() const { return weight.size() > 0; }
  Eigen::VectorXd exploration() const { return uncertainty.cwiseProduct(weight); }  ///< e, defined if there is a w
};

/// Returns the readers of a page: all that it shows, from the first tap on.
ReadPlan page_readers(const RecordedRun& recording);

/// Returns the maps after each of these numbers of taps, which ascend from 1 to the number of all taps.
std::vector<MapsAtTap> maps_at_taps(RunReplay& playback, const RecordedRun& recording, const std::vector<int>& taps);

/// Returns "7 on the object, 10 on the desk, 1 failed"; without failed taps the last part is missing.
std::string count_words(const RunResult& result);

/// A quantity over the candidates at several moments; all frames have the same number of cells.
struct MapSeries {
  std::string name;
  std::vector<Eigen::VectorXf> frames;
};

struct History {
  std::vector<RunAtTap> moments;  ///< before the first tap and after each tap
  std::vector<int> shown;         ///< indices of the moments with maps, ascending
  /// Maps with a frame per shown moment. "height" is the reconstruction, metres. "deviation" is the standard deviation
  /// of the height, metres, at most the largest of the height GP at any moment; the surface GP has a meaningless value
  /// before the first contact with an object. "u"; "w", or "p" if the footprint is not the weight; "score" if the
  /// scores equal neither these nor u w. Last, if the truth is known, "truth" in one frame, metres.
  std::vector<MapSeries> maps;
  Eigen::VectorXd x, y;  ///< coordinates of the maps' columns and rows, metres; maps are stored row by row
  /// From any side, instead of maps: the surface at each shown moment, empty before the first contact with an object.
  /// The contours of the true surface are those at the last moment; empty if the truth is unknown.
  std::vector<Surface> surfaces;
  std::vector<Ring> true_contours;
  /// Reason why the truth is no longer known (RunReplay::truth_lost()); the errors are then those of the record.
  std::optional<Error> truth_lost;
};

/// Callback with the number of taps done and the number of all taps.
using OnProgress = std::function<void(int done, int all)>;

/// Largest number of columns or rows of a map; larger grids are shown with every second, third, ... cell.
inline constexpr int kMostCellsAcross = 128;

/// Builds a history tap by tap. The history so far can be read while the run goes on.
class HistoryBuilder {
 public:
  /// Begins before the first tap. `environment` and `recording` must outlive the object; `recording` has at least one
  /// tap and may grow. Throws Error as RunReplay does.
  HistoryBuilder(const RunEnvironment& environment, const RecordedRun& recording);

  /// Returns the number of taps that were added.
  int taps() const { return playback_.taps(); }
  bool has_own_scores() const { return own_scores_; }
  /// Adds the next recorded tap, which must exist.
  void advance();
  /// If maps or surfaces hold more numbers than `most`, drops those of every second moment, but never those of the
  /// last.
  void thin(std::size_t most);

  /// Returns the history so far, with maps of the moments from `moment` on: the history of a run that ends here.
  History since(int moment) const;

 private:
  void add();
  void add_maps();
  void add_surface();
  Eigen::VectorXf shown(const Eigen::VectorXd& map);

  const RecordedRun& recording_;
  RunReplay playback_;
  bool any_side_;
  int stride_ = 1;  ///< maps show every stride_-th column and row
  bool own_scores_ = false;
  std::optional<Eigen::VectorXf> truth_;  ///< after the taps so far; pushed objects change it
  double largest_ = 0.0;                  ///< greatest standard deviation of the height GP at any moment
  History history_;                       ///< with unlimited deviations; since() limits them
};

/// Builds the history of a whole recorded run. Throws Error as RunReplay does.
History make_history(const RunEnvironment& environment, const RecordedRun& recording, const OnProgress& progress);

}  // namespace palpate
