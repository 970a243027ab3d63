// SPDX-License-Identifier: MIT
// A run looked at from each of its taps: what was believed then, how wrong it was, where the next tap would go. All of
// it is computed again from the recorded taps, so that runs need not store their maps.
#pragma once

#include "record/recording.hpp"

#include <palpate/error.hpp>
#include <palpate/types.hpp>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace palpate {

/// A tap as it is drawn.
struct TapMark {
  enum class Kind { on, off, failed };
  int tap = 1;
  Kind kind = Kind::failed;  ///< as the contact is read at that moment
  double x = 0.0;            ///< metres, as `y`
  double y = 0.0;
  double height = 0.0;  ///< metres; the desk's where nothing was touched
};

/// A run after its first `taps` taps.
struct RunAtTap {
  int taps = 0;
  RunResult result;                  ///< what summary.json would say if the run had ended here
  std::optional<TapRecord> next;     ///< what would be tapped next; absent if no candidate is left, or if nobody says
  bool is_next_known = true;         ///< false where a program chooses, which is not started for a record
  std::optional<double> next_along;  ///< of it, from any side: how far it would come by the most probable composition
  double largest_deviation = 0.0;  ///< of the candidates' heights, all taps seen, metres; from any side of the surface
  /// Of the candidates, as the label GP has it; absent where the footprint is not the weight.
  std::optional<double> least_weight, most_weight;
};

/// The same with what was believed. The maps have one value for each candidate.
struct MapsAtTap : RunAtTap {
  std::vector<TapMark> marks;   ///< of these taps, in their order
  Eigen::VectorXd surface;      ///< as reconstructed, metres
  Eigen::VectorXd deviation;    ///< standard deviation of the height, metres
  Eigen::VectorXd uncertainty;  ///< u
  /// What speaks for an object, one of the two: w, as the strategy reads it, where the footprint is the weight, or
  /// else the footprint's p. The other is empty.
  Eigen::VectorXd weight;
  Eigen::VectorXd probability;
  bool has_scores = true;  ///< whether the strategy could be asked
  Eigen::VectorXd scores;  ///< what the strategy gives each candidate; else 0
  bool has_weight() const { return weight.size() > 0; }
  Eigen::VectorXd exploration() const { return uncertainty.cwiseProduct(weight); }  ///< e, where there is w
};

/// The run after each of these numbers of taps, which ascend and lie between 1 and all.
std::vector<MapsAtTap> maps_at_taps(Playback& playback, const Recording& recording, const std::vector<int>& taps);

/// "7 on the object, 10 on the desk, 1 failed"; what there is none of but the first two is left out.
std::string count_words(const RunResult& result);

/// One quantity over the candidates at several moments; all frames have the same number of cells.
struct MapSeries {
  std::string name;
  std::vector<Eigen::VectorXf> frames;
};

struct History {
  std::vector<RunAtTap> moments;  ///< before the first tap, and after each
  std::vector<int> shown;         ///< the moments of which there are maps, ascending
  /// "height" (of the reconstruction, metres), "deviation" (its standard deviation, metres, at most
  /// the largest that the height GP has at any moment: that of an object's level before it is touched means
  /// nothing), "u", "w" or, where the footprint is not the weight, "p", and "score" where the acquisition's is none of
  /// these nor u w: a frame for each moment that is shown.
  /// Last, where truth is known, "truth" in one frame, metres.
  std::vector<MapSeries> maps;
  Eigen::VectorXd x, y;  ///< of the columns and rows of the maps, metres; a map has row after row
  /// Of a run from any side, in the place of maps: the surface at each moment that is shown, which of a long run are
  /// not all; none before a tap has hit an object, when it is anywhere. And lines on the true one as it is at the last
  /// moment, where it is known.
  std::vector<Crossings> surfaces;
  std::vector<Ring> true_contours;
  /// Why the truth is not known any more, see Playback::truth_lost(); the errors are those of the record then.
  std::optional<Error> truth_lost;
};

/// Tells how many of all taps are done.
using OnProgress = std::function<void(int done, int all)>;

/// Maps of more columns or rows than this have only every second, third, ... of them.
inline constexpr int kMostCellsAcross = 128;

/// A history that is lived through tap by tap, and may be looked at in between: of a run that goes on.
class HistoryBuilder {
 public:
  /// At the moment before the first tap. `workshop` and `recording` must outlive it; `recording`, which has a tap, may
  /// get more of them. Throws Error as Playback does.
  HistoryBuilder(const Workshop& workshop, const Recording& recording);

  /// As many as there are moments so far, less one.
  int taps() const { return playback_.taps(); }
  bool has_own_scores() const { return own_scores_; }
  /// Takes in the next recorded tap, which must be there.
  void advance();
  /// Where its maps, or surfaces, hold more numbers than that, drops every second moment's but never the last one's.
  void thin(std::size_t most);

  /// The history so far, with the maps of the moments from `moment` on; equal to that of a run that ends here.
  History since(int moment) const;
  /// All of it. Nothing may be asked afterwards.
  History take();

 private:
  void add();
  void add_surface();
  History finished(History history) const;
  Eigen::VectorXf shown(const Eigen::VectorXd& map);

  const Recording& recording_;
  Playback playback_;
  FromAnySide* any_side_;  ///< what is played; null where it taps from above
  int stride_ = 1;         ///< shown is every so-many-th column and row
  bool own_scores_ = false;
  std::optional<Eigen::VectorXf> truth_;  ///< as of now: what is pushed moves it
  double largest_ = 0.0;                  ///< standard deviation of the height GP, of all moments
  History history_;                       ///< maps as they are: finished() has the last word on them
};

/// Lives through the taps of a recorded run again. Throws Error as Playback does.
History make_history(const Workshop& workshop, const Recording& recording, const OnProgress& progress);

}  // namespace palpate
