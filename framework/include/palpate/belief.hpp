// SPDX-License-Identifier: MIT
// The belief: a model of the scene that learns from the taps, and the lines along which the next tap may be made.
#pragma once

#include <palpate/belief_quantities.hpp>
#include <palpate/reconstruction_errors.hpp>
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
  bool from_above = false;  ///< whether TapLine::from_above is true for all lines
  bool fixed = true;        ///< the same lines for the whole run; else drawn before each tap
  int rows = 0;             ///< number of rows if fixed lines form a grid, stored row by row: M = rows x columns
  int columns = 0;

  Eigen::Index size() const { return starts.rows(); }
  TapLine line(Eigen::Index index) const {
    return {starts.row(index), directions.row(directions.rows() == 1 ? 0 : index),
            lengths(lengths.size() == 1 ? 0 : index), from_above};
  }
};

/// The taps whose results a belief contains.
struct TapsSoFar {
  int count = 0;                       ///< number of taps, including failed taps
  int initial = 0;                     ///< number of taps that the initial design chose
  std::vector<TapReading> readings{};  ///< current readings, in the order of the taps; failed taps have none

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
  /// Returns the values of a quantity, one per candidate. Throws Error for a quantity that the reader did not declare.
  virtual const Eigen::VectorXd& values(std::string_view quantity) const = 0;
  /// Returns the value of a quantity that is a single number; nullopt while the quantity has no value.
  virtual std::optional<double> scalar(std::string_view /*quantity*/) const { return std::nullopt; }
  /// Returns the sampled hypotheses of the footprint. Only for readers that declare the quantity `hypotheses`.
  virtual const HypothesisSample& hypotheses() const {
    static const HypothesisSample none;
    return none;
  }
};

/// The event in a run from which on a reader reads its quantities.
enum class Stage {
  first_tap,
  first_object_contact,
  first_scored_tap,       ///< first tap that is chosen by scores, from the acquisition or a calling program
  first_acquisition_tap,  ///< first tap that is chosen by the acquisition's scores
  first_fallback,
  summary,
};

/// The readers of a belief: parts of the program that read its quantities. The plan is fixed before the first tap.
struct ReadPlan {
  struct Reader {
    std::string name;  ///< such as "acquisition weighted"
    QuantitySet reads;
    Stage from = Stage::first_acquisition_tap;
    bool at_one_candidate = false;  ///< whether it reads only by predict()
    bool is_optional = false;       ///< whether to omit quantities that the belief does not offer
  };
  std::vector<Reader> readers;
  /// Stage from which on errors, expected RMSE and surface are read; nullopt if they are never read.
  std::optional<Stage> surface_from = Stage::summary;

  /// Returns the quantities that the readers of these stages read as arrays.
  QuantitySet reads(const std::set<Stage>& begun) const {
    QuantitySet out;
    for (const Reader& one : readers) {
      if (begun.count(one.from) != 0 && !one.at_one_candidate) out.insert(one.reads.begin(), one.reads.end());
    }
    return out;
  }
};

/// A model that a run builds, such as "label GP", and a reader that needs this model.
struct PlannedModel {
  std::string model;
  std::string reader;
};

using BoolOut = Eigen::Ref<Eigen::Array<bool, Eigen::Dynamic, 1>>;

/// Purpose of errors: the record of a tap, the summary, or a display whose errors are not recorded.
enum class ErrorsFor { tap, summary, display };

/// Errors of a reconstruction. Without a known truth, they are absent.
struct BeliefErrors {
  Errors errors;
  std::vector<ObjectErrors> objects = {};  ///< errors per object, in the order of the scene; only for the summary
  std::optional<double> expected_rmse = std::nullopt;  ///< metres; only for displays
};

/// Result of a tap along a line, as the particles of a belief predict it. Used for explanations. Lengths are in metres.
struct LineFacts {
  struct Solid {
    std::string form;                 ///< such as "box"
    Eigen::Vector3d extent{0, 0, 0};  ///< lengths along its own axes
    double wall = 0.0;                ///< thickness of the wall; 0 without a hollow
  };
  struct Particle {
    double distance = 0.0;  ///< path length of the tap: up to an object, the desk, or the end of the line
    bool on_object = false;
    std::vector<Solid> solids;
  };
  std::vector<Particle> particles;  ///< the most probable one first; empty for beliefs without particles
  /// Values at the point where the line meets an object of the most probable particle: standard deviation of the
  /// surface along its normal, this deviation far from all contacts, and cosine of the angle between line and normal.
  double surface_std = 0.0, prior_std = 0.0, incidence_cosine = 0.0;
};

/// Returns for each line whether the backend can tap along it.
using LineFilter = std::function<void(const Candidates& lines, BoolOut out)>;

/// A model of the scene. It learns from the results of taps. It offers the lines along which the next tap may be made,
/// and named quantities with one value per line. A simple belief without models, stages or numerical problems need not
/// override the functions about them.
///
/// Laws of every belief: the same plan, stages and taps give the same bytes, on any number of threads. Calls of
/// infer(), surface(), errors() and const functions do not change later results. Random numbers come only from
/// Context::random(). state() returns the counts of numerical problems. infer() throws Error for values that are not
/// finite.
class Belief : public BeliefView {
 public:
  static constexpr const char* kKind = "belief";

  /// Returns all quantities that the belief offers; constant over the object's lifetime.
  virtual std::vector<Quantity> offers() const = 0;

  /// Sets the readers of the run, before the first tap. Returns the models that the readers of all stages before the
  /// summary need. A model without a reader is never built. The plan contains only quantities that the belief offers.
  virtual std::vector<PlannedModel> plan(const ReadPlan& /*plan*/) { return {}; }

  /// Begins a stage: from now on its readers read, and the record contains the quantities that they read. Stages may
  /// begin in any order. A second call for the same stage has no effect.
  virtual void begin(Stage /*stage*/) {}

  /// Returns the reading of a result by the belief in its present state; nullopt for a failed tap. Changes nothing.
  virtual std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const = 0;

  /// Adds the result of a tap. A failed tap is counted, but not used as data. A second tap along the same line is an
  /// additional datum.
  virtual void add(const TapRequest& request, const TapResult& result) = 0;

  /// Updates the models of all begun stages with the taps since the last call, including the fits that are due.
  virtual void update() {}

  /// Computes the arrays that the readers of begun stages read. Requires update() after the last tap.
  virtual void infer() = 0;

  /// Returns the quantities whose arrays are available in the begun stages. If a model is built for one quantity, its
  /// other quantities are available, too.
  virtual QuantitySet available() const = 0;

  /// Draws the lines for the next tap, unless the lines are fixed. `filter` returns which lines the backend can reach.
  virtual void draw_candidates(const LineFilter& /*filter*/) {}

  /// Returns whether scores are meaningful yet. Until then, the initial design chooses further taps.
  virtual bool is_ready() const { return true; }
  /// Returns whether the belief reads the objects of Context::scene. For example, a simulated camera view reads them.
  virtual bool reads_scene() const { return false; }

  /// Returns the height and, if `probability` is true, the object probability at a candidate. Requires a reader that
  /// declares these quantities.
  virtual Prediction predict(Eigen::Index candidate, bool probability) const {
    Prediction out{values(quantity::kHeightMean)(candidate), values(quantity::kHeightStd)(candidate)};
    if (probability) out.probability = values(quantity::kObjectProbability)(candidate);
    return out;
  }

  /// Returns the fields that the models of begun stages add to the record: the record of a tap at `candidate`, or the
  /// summary if `candidate` is nullopt.
  virtual BeliefState state(std::optional<Eigen::Index> /*candidate*/) const { return {}; }

  /// Sets the true scene in its current state; null if the truth is not known. `scene` stays valid until the next call.
  virtual void set_truth(const Scene* scene) = 0;
  /// Returns the errors against the truth. For the record, an error is absent if no begun stage reads the arrays that
  /// it needs. For displays, all models that are built are used, the record is not changed, and the result is nullopt
  /// if a model is missing.
  virtual std::optional<BeliefErrors> errors(ErrorsFor purpose) = 0;

  /// Returns the reconstructed surface. Requires that the stage ReadPlan::surface_from has begun. The cells of a mesh
  /// are about `resolution` metres wide, or wider if the mesh would be too large.
  virtual Surface surface(double resolution) = 0;
  /// Returns the predicted result of a tap along a line.
  virtual LineFacts explain(const TapLine& /*line*/) const { return {}; }
};

}  // namespace palpate
