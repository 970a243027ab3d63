// SPDX-License-Identifier: MIT
// The belief: what the taps so far say of the scene, and of the lines along which the next tap may be made.
#pragma once

#include <palpate/belief_quantities.hpp>
#include <palpate/errors.hpp>
#include <palpate/record_fields.hpp>
#include <palpate/scene.hpp>
#include <palpate/surface.hpp>
#include <palpate/tap.hpp>

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <set>
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

/// The taps that a belief has taken in.
struct TapsSoFar {
  int count = 0;                       ///< of all taps, failed taps included
  int initial = 0;                     ///< those of them that the initial design chose
  std::vector<TapReading> readings{};  ///< in the order of the taps, as they are read now; failed taps have none

  /// Counts a tap.
  void add(const TapRequest& request) {
    ++count;
    if (request.source == Source::initial) ++initial;
  }
};

/// The part of a belief that acquisitions and backends read. References stay valid until the next tap.
class BeliefView {
 public:
  virtual ~BeliefView() = default;

  virtual const Candidates& candidates() const = 0;
  virtual const TapsSoFar& taps() const = 0;
  /// Returns M values of a quantity. Throws Error for a quantity that the reader did not declare.
  virtual const Eigen::VectorXd& values(std::string_view quantity) const = 0;
  /// Returns a quantity that is one number; nullopt while it has no value.
  virtual std::optional<double> scalar(std::string_view /*quantity*/) const { return std::nullopt; }
  /// For readers of `hypotheses`.
  virtual const HypothesisSample& hypotheses() const {
    static const HypothesisSample none;
    return none;
  }
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
    bool is_optional = false;       ///< a quantity that the belief does not offer is left out
  };
  std::vector<Reader> readers;
  /// From when on errors, expected RMSE and surface are read; nullopt: never.
  std::optional<Stage> surface_from = Stage::summary;

  /// Returns what readers of these stages read in arrays.
  QuantitySet reads(const std::set<Stage>& begun) const {
    QuantitySet out;
    for (const Reader& one : readers) {
      if (begun.count(one.from) != 0 && !one.at_one_candidate) out.insert(one.reads.begin(), one.reads.end());
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

/// Purpose of errors: the record of a tap, the summary, or displays beside the record.
enum class ErrorsFor { tap, summary, display };

/// Errors of a reconstruction. Without a known truth, they are absent.
struct BeliefErrors {
  Errors errors;
  std::vector<ObjectErrors> objects = {};              ///< of each object of the scene, in its order; for the summary
  std::optional<double> expected_rmse = std::nullopt;  ///< metres; for displays
};

/// Expectation of a tap along a line by the particles of a belief, for explanations. Lengths in metres.
struct LineFacts {
  struct Solid {
    std::string form;                 ///< such as "box"
    Eigen::Vector3d extent{0, 0, 0};  ///< along its own axes
    double wall = 0.0;                ///< thickness of the wall; 0 without a hollow
  };
  struct Particle {
    double distance = 0.0;  ///< path length of the tap: up to an object, the desk, or the end of the line
    bool on_object = false;
    std::vector<Solid> solids;
  };
  std::vector<Particle> particles;  ///< the most probable one first; empty for beliefs without particles
  /// Where the line meets an object of the most probable particle: standard deviation of the surface along its normal,
  /// the same far from all contacts, and cosine between line and normal.
  double surface_std = 0.0, prior_std = 0.0, incidence_cosine = 0.0;
};

/// Returns for each line whether the backend can tap along it.
using LineFilter = std::function<void(const Candidates& lines, BoolOut out)>;

/// A model of the scene. It learns from the results of taps, and offers the lines of the next tap and named quantities
/// of them. A belief without models, stages or numerical trouble leaves the functions about them at their defaults.
///
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
  virtual std::vector<PlannedModel> plan(const ReadPlan& /*plan*/) { return {}; }

  /// The readers of `stage` read from now on; all that they read belongs to the record. Stages begin in any order; a
  /// stage that has begun stays as it is.
  virtual void begin(Stage /*stage*/) {}

  /// Returns the reading of a result as the belief stands, nullopt for a failed tap. Changes nothing.
  virtual std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const = 0;

  /// Takes the result of a tap. A failed tap is counted and teaches nothing. A second tap along one line is one more
  /// datum.
  virtual void add(const TapRequest& request, const TapResult& result) = 0;

  /// Brings the models of all begun stages up to the last tap, fits included.
  virtual void update() {}

  /// Computes the arrays that begun stages read, after update().
  virtual void infer() = 0;

  /// Returns the quantities whose arrays begun stages have, among them those of models that other quantities needed.
  virtual QuantitySet available() const = 0;

  /// Draws the lines of the next tap, unless they are fixed. `filter` says which of them the backend reaches.
  virtual void draw_candidates(const LineFilter& /*filter*/) {}

  /// Whether scores mean anything yet; until then the initial design goes on.
  virtual bool is_ready() const { return true; }
  /// Whether the belief reads the objects of Context::scene, as the view of a simulated camera does.
  virtual bool reads_scene() const { return false; }

  /// Returns height and, if `probability`, the object probability at a candidate. A reader at one candidate has
  /// declared them.
  virtual Prediction predict(Eigen::Index candidate, bool probability) const {
    Prediction out{values(quantity::kHeightMean)(candidate), values(quantity::kHeightStd)(candidate)};
    if (probability) out.probability = values(quantity::kObjectProbability)(candidate);
    return out;
  }

  /// Returns the record of the models that readers of begun stages have: at a candidate for a tap, without one for the
  /// summary.
  virtual BeliefState state(std::optional<Eigen::Index> /*candidate*/) const { return {}; }

  /// Sets the true scene as it stands now; null if it is not known. It stays valid until the next call.
  virtual void set_truth(const Scene* scene) = 0;
  /// Returns the errors against the truth, for the record as far as begun stages read the arrays for them. For
  /// displays, it uses all models that are built, returns nullopt if one is missing, and leaves the record as it is.
  virtual std::optional<BeliefErrors> errors(ErrorsFor purpose) = 0;

  /// Returns the reconstructed surface; in the stage `summary`. The cells of a mesh are about `resolution` metres wide,
  /// or wider if the mesh would be too large.
  virtual Surface surface(double resolution) = 0;
  /// Returns the expectation of a tap along a line.
  virtual LineFacts explain(const TapLine& /*line*/) const { return {}; }
};

}  // namespace palpate
