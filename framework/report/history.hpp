// SPDX-License-Identifier: MIT
// History of a run: belief, errors and next tap after each tap. The history is computed from the recorded taps alone,
// so a run need not store its maps.
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

/// The mark of a tap in figures.
struct TapMark {
  enum class Kind { on, off, failed };
  int tap = 1;
  Kind kind = Kind::failed;  ///< depends on the label that the contact has at the shown moment
  double x = 0.0;            ///< position of the tap (x, y), metres
  double y = 0.0;
  double height = 0.0;  ///< metres; the height of the desk for a tap without a contact
};

/// State of a run after its first `taps` taps.
struct RunAtTap {
  int taps = 0;
  RunResult result;               ///< the result that the run would have if it ended here
  std::optional<TapRecord> next;  ///< the next tap; nullopt if no candidate is left, or if its choice is unknown
  /// false if an external program scores the candidates, because reports do not start programs
  bool is_next_known = true;
  /// only for a run from any side: path length of the next tap, predicted by the most probable particle, metres
  std::optional<double> next_along;
  std::vector<TapReading> suspected_outliers;  ///< contacts that may be outliers
  /// Greatest standard deviation given all taps so far, metres: of the heights at the candidates, or of the surface for
  /// a run from any side.
  double largest_deviation = 0.0;
  /// Range of the label GP's mean w over the candidates; nullopt if the footprint is not the label GP.
  std::optional<double> least_weight, most_weight;
};

/// State of a run after its first `taps` taps, with the maps of the belief: one value per candidate.
struct MapsAtTap : RunAtTap {
  std::vector<TapMark> marks;   ///< marks of the first `taps` taps, in their order
  Eigen::VectorXd surface;      ///< reconstructed heights, metres
  Eigen::VectorXd deviation;    ///< standard deviation of the height, metres
  Eigen::VectorXd uncertainty;  ///< u
  /// If the footprint is the label GP, `weight` is its mean w as the strategy uses it, and `probability` is empty.
  /// Otherwise `probability` is the footprint's p, and `weight` is empty.
  Eigen::VectorXd weight;
  Eigen::VectorXd probability;
  bool has_scores = true;  ///< whether the scores are known: reports do not start acquisition programs
  Eigen::VectorXd scores;  ///< scores of the candidates; all 0 if the scores are unknown
  bool has_weight() const { return weight.size() > 0; }
  /// e = u w, only valid if has_weight()
  Eigen::VectorXd exploration() const { return uncertainty.cwiseProduct(weight); }
};

/// Returns the quantities that a page reads, all from the first tap on.
ReadPlan page_readers(const RecordedRun& recording);

/// Returns the maps after each of the given numbers of taps, which are ascending and between 1 and the number of all
/// taps.
std::vector<MapsAtTap> maps_at_taps(RunReplay& playback, const RecordedRun& recording, const std::vector<int>& taps);

/// Returns "7 on the object, 10 on the desk, 1 failed". Without failed taps the last part is missing.
std::string count_words(const RunResult& result);

/// A map of one quantity at several moments. All frames have the same number of cells.
struct MapSeries {
  std::string name;
  std::vector<Eigen::VectorXf> frames;
};

struct History {
  std::vector<RunAtTap> moments;  ///< before the first tap and after each tap
  std::vector<int> shown;         ///< indices of the moments with maps, ascending
  /// Maps with one frame per shown moment, in this order. "height" is the reconstruction, metres. "deviation" is the
  /// standard deviation of the height, metres. It is limited to the largest standard deviation of the height GP at any
  /// moment. Before the first contact with an object, the standard deviation of the surface GP is meaningless. The next
  /// maps are "u", and "w" if the footprint is the label GP, else "p". "score" follows if the scores equal neither
  /// these maps nor e = u w. The last map is "truth" in metres, with a single frame, if the truth is known.
  std::vector<MapSeries> maps;
  Eigen::VectorXd x, y;  ///< coordinates of the maps' columns and rows, metres; maps are stored row by row
  /// For a run from any side: surfaces instead of maps, one per shown moment. A surface is empty before the first
  /// contact with an object. `true_contours` are the contours of the true surface at the last moment; they are empty if
  /// the truth is unknown.
  std::vector<Surface> surfaces;
  std::vector<Ring> true_contours;
  /// Reason why the truth is no longer known (RunReplay::truth_lost()). If it is set, the errors are the recorded
  /// errors.
  std::optional<Error> truth_lost;
};

/// Callback with the number of finished taps and the number of all taps.
using OnProgress = std::function<void(int done, int all)>;

/// Largest number of columns or rows of a map. If a grid is larger, maps show only every second, third, ... row and
/// column.
inline constexpr int kMostCellsAcross = 128;

/// Builds a history tap by tap. Other code can read the history so far while the run goes on.
class HistoryBuilder {
 public:
  /// Begins before the first tap. `environment` and `recording` must outlive the object; `recording` has at least one
  /// tap and may grow. Throws the errors of RunReplay.
  HistoryBuilder(const RunEnvironment& environment, const RecordedRun& recording);

  /// Returns the number of taps that advance() has added.
  int taps() const { return playback_.taps(); }
  bool has_own_scores() const { return own_scores_; }
  /// Adds the next recorded tap, which must exist.
  void advance();
  /// If maps and surfaces contain more than `most` numbers, removes the maps and surfaces of every second moment. The
  /// last moment always keeps its maps or surface.
  void thin(std::size_t most);

  /// Returns the history so far. Only moments from `moment` on have maps.
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
  std::optional<Eigen::VectorXf> truth_;  ///< true heights after the taps so far; they change if a tap pushes an object
  double largest_ = 0.0;                  ///< greatest standard deviation of the height GP at any moment
  History history_;                       ///< standard deviations are not limited to `largest_` yet; since() does this
};

/// Builds the history of a whole recorded run. Throws the errors of RunReplay.
History make_history(const RunEnvironment& environment, const RecordedRun& recording, const OnProgress& progress);

}  // namespace palpate
