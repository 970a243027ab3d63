// SPDX-License-Identifier: MIT
// The belief: what the taps so far say of the scene, and of the lines along which the next tap may be made.
#pragma once

#include <palpate/errors.hpp>
#include <palpate/quantity.hpp>
#include <palpate/record_fields.hpp>
#include <palpate/scene.hpp>
#include <palpate/surface.hpp>
#include <palpate/tap.hpp>

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

using Points3 = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// M lines among which the next tap is chosen; ties go to the lowest index.
struct Candidates {
  Points3 starts;           ///< M x 3, metres
  Points3 directions;       ///< M x 3 unit vectors, or one row if all are equal
  Eigen::VectorXd lengths;  ///< M values, metres, or one if all are equal
  bool from_above = false;  ///< TapLine::from_above of all of them
  bool fixed = true;        ///< for the whole run; else drawn before each tap
  int rows = 0;             ///< of a grid of fixed lines, row after row: M = rows x columns
  int columns = 0;

  Eigen::Index size() const { return starts.rows(); }
  TapLine line(Eigen::Index index) const {
    return {starts.row(index), directions.row(directions.rows() == 1 ? 0 : index),
            lengths(lengths.size() == 1 ? 0 : index), from_above};
  }
};

/// Numbers of taps so far, failed taps included.
struct TapCounts {
  int all = 0;
  int initial = 0;  ///< chosen by the initial design
};

/// The part of a belief that acquisitions and backends read. References stay valid until the next tap.
class BeliefView {
 public:
  virtual ~BeliefView() = default;

  virtual const Candidates& candidates() const = 0;
  virtual TapCounts counts() const = 0;
  /// Returns the readings of the taps in their order, as they are read now. Failed taps have none.
  virtual const std::vector<TapReading>& readings() const = 0;
  /// Returns M values of a quantity. Throws Error for a quantity that the reader did not declare.
  virtual const Eigen::VectorXd& values(std::string_view quantity) const = 0;
  /// Returns a quantity that is one number; nullopt while it has no value.
  virtual std::optional<double> scalar(std::string_view quantity) const = 0;
  /// For readers of `hypotheses`.
  virtual const HypothesisSample& hypotheses() const = 0;
};

/// From when on a reader reads.
enum class Stage {
  first_tap,
  first_object_contact,
  first_scored_tap,       ///< the first tap that scores choose, of the acquisition or of a calling program
  first_acquisition_tap,  ///< the first tap that the acquisition's scores choose
  first_fallback,
  summary,
};

/// The readers of a belief, fixed before the first tap.
struct ReadPlan {
  struct Reader {
    std::string name;  ///< such as "acquisition weighted"
    QuantitySet reads;
    Stage from = Stage::first_acquisition_tap;
    bool at_one_candidate = false;  ///< by predict() alone
  };
  std::vector<Reader> readers;
  /// From when on errors, expected RMSE and surface are read; nullopt: never.
  std::optional<Stage> surface_from = Stage::summary;

  /// Returns what is read in arrays from a stage on.
  QuantitySet reads(Stage from) const {
    QuantitySet out;
    for (const Reader& one : readers) {
      if (one.from == from && !one.at_one_candidate) out.insert(one.reads.begin(), one.reads.end());
    }
    return out;
  }
};

/// A model of a run, such as "label GP", and a reader because of which it is built.
struct PlannedModel {
  std::string model;
  std::string reader;
};

using BoolOut = Eigen::Ref<Eigen::Array<bool, Eigen::Dynamic, 1>>;

/// What displays show of a reconstruction.
struct ShownErrors {
  Errors errors;
  std::optional<double> expected_rmse;  ///< metres
};

/// Returns for each line whether the backend can tap along it.
using LineFilter = std::function<void(const Candidates& lines, BoolOut out)>;

/// Laws of every belief: the same plan, stages and taps give the same bytes, on any number of threads. infer(),
/// surface(), errors() and all reading change no later value. Random numbers come from
/// Context::random() alone. Numerical trouble is counted in state(). infer() throws Error for values that are not
/// finite.
class Belief : public BeliefView {
 public:
  static constexpr const char* kKind = "belief";

  /// Returns every quantity that the belief offers, the same from birth to death.
  virtual std::vector<Quantity> offers() const = 0;

  /// Takes the readers of the run, before the first tap, and returns the models that those before the summary need. No
  /// model without a reader is ever built. The belief offers every quantity of the plan.
  virtual std::vector<PlannedModel> plan(const ReadPlan& plan) = 0;

  /// The readers of `stage` read from now on; all that they read belongs to the record. Stages begin in any order; a
  /// stage that has begun stays as it is.
  virtual void begin(Stage stage) = 0;

  /// Returns the reading of a result as the belief stands, nullopt for a failed tap. Changes nothing.
  virtual std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const = 0;

  /// Takes the result of a tap. A failed tap is counted and teaches nothing. A second tap along one line is one more
  /// datum.
  virtual void add(const TapRequest& request, const TapResult& result) = 0;

  /// Brings the models of all begun stages up to the last tap, fits included.
  virtual void update() = 0;

  /// Computes the arrays that begun stages read, after update().
  virtual void infer() = 0;

  /// Returns the quantities whose arrays begun stages have, among them those of models that other quantities needed.
  virtual QuantitySet available() const = 0;

  /// Draws the lines of the next tap, unless they are fixed. `filter` says which of them the backend reaches.
  virtual void draw_candidates(const LineFilter& /*filter*/) {}

  /// Whether scores mean anything yet; until then the initial design goes on.
  virtual bool is_ready() const { return true; }

  /// Returns height and, if `probability`, the object probability at a candidate. A reader at one candidate has
  /// declared them.
  virtual Prediction predict(Eigen::Index candidate, bool probability) const {
    Prediction out{values(quantity::kHeightMean)(candidate), values(quantity::kHeightStd)(candidate)};
    if (probability) out.probability = values(quantity::kObjectProbability)(candidate);
    return out;
  }

  /// Returns the record of the models that readers of begun stages have: at a candidate for a tap, without one for the
  /// summary.
  virtual BeliefState state(std::optional<Eigen::Index> candidate) const = 0;

  /// Sets the true scene as it stands now; null if it is not known. It stays valid until the next call.
  virtual void set_truth(const Scene* scene) = 0;
  /// Returns the errors against the truth, as far as begun stages read the arrays for them.
  virtual Errors errors() = 0;
  /// Returns errors and expected RMSE for displays, by all models that are built; nullopt if one is missing. The record
  /// stays as it is.
  virtual std::optional<ShownErrors> shown_errors() = 0;
  /// Returns the errors of each object of the scene, in its order; empty for a belief that has none.
  virtual std::vector<ObjectErrors> object_errors() { return {}; }

  /// Returns the reconstructed surface; in the stage `summary`.
  virtual Surface surface() = 0;
};

}  // namespace palpate
