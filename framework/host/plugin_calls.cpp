// SPDX-License-Identifier: MIT
#include "host/plugin_calls.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/backend.hpp>
#include <palpate/belief.hpp>
#include <palpate/error.hpp>
#include <palpate/fitting.hpp>
#include <palpate/footprint.hpp>
#include <palpate/kernel.hpp>
#include <palpate/motions.hpp>
#include <palpate/shape.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

namespace palpate {
namespace {

/// The error of a plugin that reads a quantity without declaring it. The error names this plugin, even if another
/// plugin's wrapper catches the error.
class UndeclaredReadError final : public Error {
 public:
  using Error::Error;
};

/// A belief that allows a plugin to read only the quantities that it declared.
class RestrictedBeliefView final : public BeliefView {
 public:
  /// `belief` and `name`, the name of the plugin, must outlive the object.
  RestrictedBeliefView(const BeliefView& belief, QuantitySet reads, const std::string& name)
      : belief_(belief), reads_(std::move(reads)), name_(name) {}
  const Candidates& candidates() const override { return belief_.candidates(); }
  const TapsSoFar& taps() const override { return belief_.taps(); }
  const Eigen::VectorXd& values(std::string_view quantity) const override {
    return declared(quantity).values(quantity);
  }
  std::optional<double> scalar(std::string_view quantity) const override { return declared(quantity).scalar(quantity); }
  const HypothesisSample& hypotheses() const override { return declared(quantity::kHypotheses).hypotheses(); }

 private:
  const BeliefView& declared(std::string_view quantity) const {
    if (reads_.find(quantity) != reads_.end()) return belief_;
    throw UndeclaredReadError(name_, "reads " + std::string(quantity) + ", which its reads() does not list",
                              "add it there", Error::Kind::run);
  }

  const BeliefView& belief_;
  QuantitySet reads_;
  const std::string& name_;
};

template <class Derived>
bool are_finite(const Eigen::DenseBase<Derived>& values) {
  return values.allFinite();
}
bool are_finite(double value) { return std::isfinite(value); }
bool are_finite(const std::optional<double>& value) { return !value || std::isfinite(*value); }
bool are_finite(const KernelParameter& parameter) { return std::isfinite(parameter.value); }
bool are_finite(const FootprintNumber& number) { return std::isfinite(number.value); }
bool are_finite(const FitOutput& output) { return std::isfinite(output.signal) && std::isfinite(output.mean); }
bool are_finite(const LineInterval& stretch) { return std::isfinite(stretch.begin) && std::isfinite(stretch.end); }
template <class Value>
bool are_finite(const std::vector<Value>& values) {
  return std::all_of(values.begin(), values.end(), [](const Value& one) { return are_finite(one); });
}

/// Base class of the wrappers: holds the object of a plugin, and forwards all calls to it.
template <class Interface>
class Wrapper : public Interface {
 public:
  Wrapper(std::string name, std::shared_ptr<Interface> inner) : name_(std::move(name)), inner_(std::move(inner)) {}

 protected:
  /// Calls the method of the plugin's object. Any exception becomes an Error with the name of the plugin.
  template <class Method, class... Arguments>
  decltype(auto) call(Method method, Arguments&&... arguments) const {
    try {
      return std::invoke(method, *inner_, std::forward<Arguments>(arguments)...);
    } catch (const UndeclaredReadError&) {
      throw;
    } catch (const Error& trouble) {
      const std::string place = trouble.where().empty() ? std::string() : trouble.where() + ": ";
      throw Error(name_, place + trouble.reason(), trouble.hint(), trouble.kind());
    } catch (const std::exception& trouble) {
      throw Error(name_, trouble.what(), {}, Error::Kind::run);
    } catch (...) {
      throw Error(name_, "threw an object that is not a std::exception", {}, Error::Kind::run);
    }
  }

  [[noreturn]] void fail(const std::string& reason) const {
    throw Error(name_, reason, "correct the plugin", Error::Kind::run);
  }

  /// Throws Error if a result of the plugin is not finite.
  template <class Values>
  void require_finite(const char* function, const Values& values) const {
    if (!are_finite(values)) fail(std::string(function) + " returned a number that is not finite");
  }

  /// Returns the value, or throws Error if it is not finite.
  template <class Values>
  Values finite(const char* function, Values values) const {
    require_finite(function, values);
    return values;
  }

  /// Returns a view of `belief` that allows only the access that the plugin has declared.
  RestrictedBeliefView declared(const BeliefView& belief) const {
    return RestrictedBeliefView(belief, call(&Interface::reads), name_);
  }

 private:
  std::string name_;
  std::shared_ptr<Interface> inner_;
};

class WrappedKernel final : public Wrapper<Kernel> {
 public:
  using Wrapper::Wrapper;
  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    call(&Kernel::covariance, a, b, out);
    require("covariance()", out);
  }
  void variance(const PointsView& a, VectorOut out) const override {
    call(&Kernel::variance, a, out);
    require("variance()", out);
  }
  bool separable() const override { return call(&Kernel::separable); }
  void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const override {
    call(&Kernel::axis_covariance, axis, a, b, out);
    require("axis_covariance()", out);
  }
  std::vector<KernelParameter> parameters() const override {
    std::vector<KernelParameter> out = call(&Kernel::parameters);
    require("parameters()", out);
    return out;
  }
  bool differentiable() const override { return call(&Kernel::differentiable); }
  void set_parameters(const VectorView& values) override {
    call(&Kernel::set_parameters, values);
    reasonable_ = (values.array() > kLeast && values.array() < kMost).all();
  }
  /// Checks all results from now on, because the fit has chosen the hyperparameters.
  void settle() { reasonable_ = true; }
  void derivatives(const PointsView& a, const PointsView& b, MatrixOut value, MatrixOut slopes) const override {
    call(&Kernel::derivatives, a, b, value, slopes);
    require("derivatives()", value);
    require("derivatives()", slopes);
  }
  bool has_gradient() const override { return call(&Kernel::has_gradient); }
  // Views are passed by value, as in covariance(). NOLINTNEXTLINE(performance-unnecessary-value-param)
  void gradient_covariance(const VectorView& distances, VectorOut across, VectorOut along) const override {
    call(&Kernel::gradient_covariance, distances, across, along);
    require("gradient_covariance()", across);
    require("gradient_covariance()", along);
  }

 private:
  /// During a fit, hyperparameters outside of these bounds may give results that are not finite. The fit itself rejects
  /// such hyperparameters.
  static constexpr double kLeast = 1e-12;
  static constexpr double kMost = 1e12;

  template <class Values>
  void require(const char* function, const Values& values) const {
    if (reasonable_) require_finite(function, values);
  }

  bool reasonable_ = true;
};

class WrappedAcquisition final : public Wrapper<Acquisition> {
 public:
  using Wrapper::Wrapper;
  QuantitySet reads() const override { return call(&Acquisition::reads); }
  void score(const BeliefView& belief, VectorOut out) const override {
    call(&Acquisition::score, declared(belief), out);
  }
  double prior_scale() const override { return finite("prior_scale()", call(&Acquisition::prior_scale)); }
};

class WrappedFitting final : public Wrapper<Fitting> {
 public:
  using Wrapper::Wrapper;
  bool due(int taps) const override { return call(&Fitting::due, taps); }
  std::string objection(const Kernel& kernel) const override { return call(&Fitting::objection, kernel); }
  FitSummary fit(FitProblem& problem, Random& random) const override {
    FitSummary out = call(&Fitting::fit, problem, random);
    require_finite("fit()", out.objective);
    require_finite("fit()", problem.noise_ratio);
    require_finite("fit()", problem.outputs);
    require_finite("fit()", problem.kernel.parameters());
    if (auto* const kernel = dynamic_cast<WrappedKernel*>(&problem.kernel)) kernel->settle();
    return out;
  }
};

class WrappedFootprint final : public Wrapper<Footprint> {
 public:
  using Wrapper::Wrapper;
  bool is_weight() const override { return call(&Footprint::is_weight); }
  void add(const Touch& touch) override { call(&Footprint::add, touch); }
  void probability(const PointsView& places, VectorOut out) override {
    call(&Footprint::probability, places, out);
    require_finite("probability()", out);
  }
  void sample(const PointsView& places, HypothesisSample& out) const override {
    call(&Footprint::sample, places, out);
    require_finite("sample()", out.expected_discovery_area);
  }
  void doubt(VectorOut out) const override {
    call(&Footprint::doubt, out);
    require_finite("doubt()", out);
  }
  void current_positions(Points& places) const override {
    call(&Footprint::current_positions, places);
    require_finite("current_positions()", places);
  }
  std::optional<double> undiscovered_probability() const override {
    return finite("undiscovered_probability()", call(&Footprint::undiscovered_probability));
  }
  std::vector<FootprintNumber> numbers() const override { return finite("numbers()", call(&Footprint::numbers)); }
  std::string remark() const override { return call(&Footprint::remark); }
};

/// The checks return references to the plugin's values and make no copies, because these references must stay valid
/// until the next tap.
class WrappedBelief final : public Wrapper<Belief> {
 public:
  using Wrapper::Wrapper;
  const Candidates& candidates() const override { return call(&Belief::candidates); }
  const TapsSoFar& taps() const override { return call(&Belief::taps); }
  const Eigen::VectorXd& values(std::string_view quantity) const override {
    const Eigen::VectorXd& out = call(&Belief::values, quantity);
    if (out.size() != candidates().size())
      fail("values() of " + std::string(quantity) + " has not one value per candidate");
    require_finite("values()", out);
    return out;
  }
  std::optional<double> scalar(std::string_view quantity) const override {
    return finite("scalar()", call(&Belief::scalar, quantity));
  }
  const HypothesisSample& hypotheses() const override { return call(&Belief::hypotheses); }
  std::vector<Quantity> offers() const override { return call(&Belief::offers); }
  std::vector<PlannedModel> plan(const ReadPlan& plan) override {
    check_candidates();
    return call(&Belief::plan, plan);
  }
  void begin(Stage stage) override { call(&Belief::begin, stage); }
  std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const override {
    return call(&Belief::read, request, result);
  }
  void add(const TapRequest& request, const TapResult& result) override { call(&Belief::add, request, result); }
  void update() override { call(&Belief::update); }
  void infer() override { call(&Belief::infer); }
  QuantitySet available() const override { return call(&Belief::available); }
  void draw_candidates(const LineFilter& filter) override {
    call(&Belief::draw_candidates, filter);
    check_candidates();
  }
  bool is_ready() const override { return call(&Belief::is_ready); }
  bool reads_scene() const override { return call(&Belief::reads_scene); }
  Prediction predict(Eigen::Index candidate, bool probability) const override {
    const Prediction out = call(&Belief::predict, candidate, probability);
    require_finite("predict()", out.height);
    require_finite("predict()", out.standard_deviation);
    require_finite("predict()", out.probability);
    return out;
  }
  BeliefState state(std::optional<Eigen::Index> candidate) const override { return call(&Belief::state, candidate); }
  void set_truth(const Scene* scene) override { call(&Belief::set_truth, scene); }
  std::optional<BeliefErrors> errors(ErrorsFor purpose) override { return call(&Belief::errors, purpose); }
  Surface surface(double resolution) override { return call(&Belief::surface, resolution); }
  LineFacts explain(const TapLine& line) const override { return call(&Belief::explain, line); }

 private:
  void check_candidates() const {
    const Candidates& all = candidates();
    const auto fits = [&](Eigen::Index rows) { return rows == 1 || rows == all.size(); };
    if (!fits(all.directions.rows()) || !fits(all.lengths.size()))
      fail("its candidates have neither one direction and length nor one for each line");
    require_finite("candidates()", all.starts);
    require_finite("candidates()", all.directions);
    require_finite("candidates()", all.lengths);
    if (all.fixed && (all.size() == 0 || all.size() != Eigen::Index{all.rows} * all.columns))
      fail("its fixed candidates are not rows x columns lines");
  }
};

class WrappedBackend final : public Wrapper<Backend> {
 public:
  using Wrapper::Wrapper;
  TapResult tap(const TapRequest& request) override { return call(&Backend::tap, request); }
  bool repeatable() const override { return call(&Backend::repeatable); }
  std::vector<std::string> describe(const TapRequest& request) override { return call(&Backend::describe, request); }
  std::vector<Learnt> learnt() const override { return call(&Backend::learnt); }
  bool taps_any_line() const override { return call(&Backend::taps_any_line); }
  void reaches(const Candidates& lines, BoolOut out) const override { call(&Backend::reaches, lines, out); }
  QuantitySet predicts() const override { return call(&Backend::predicts); }
  QuantitySet reads() const override { return call(&Backend::reads); }
  void show(const BeliefView& belief) override { call(&Backend::show, declared(belief)); }
  bool scene_is_truth() const override { return call(&Backend::scene_is_truth); }
};

class WrappedShape final : public Wrapper<Shape> {
 public:
  using Wrapper::Wrapper;
  // If a line misses the shape, first_intersection() returns infinity and top() minus infinity.
  double first_intersection(const Line& line) const override {
    const double out = call(&Shape::first_intersection, line);
    if (out != kNever) require_finite("first_intersection()", out);
    return out;
  }
  std::vector<LineInterval> intervals(const Line& line) const override {
    return finite("intervals()", call(&Shape::intervals, line));
  }
  double support(const Eigen::Vector3d& direction) const override {
    return finite("support()", call(&Shape::support, direction));
  }
  double top(double s, double t) const override {
    const double out = call(&Shape::top, s, t);
    if (out != -kNever) require_finite("top()", out);
    return out;
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();
};

class WrappedMotions final : public Wrapper<Motions> {
 public:
  using Wrapper::Wrapper;
  int count() const override { return call(&Motions::count); }
  double seconds(const TapRequest& request, double surface) const override {
    return finite("its motions' seconds()", call(&Motions::seconds, request, surface));
  }
  double deviation(int motion) const override {
    return finite("its motions' deviation()", call(&Motions::deviation, motion));
  }
};

/// Returns a pointer to the interface, because callers cast the result back to that type.
template <class Concrete, class Interface>
std::shared_ptr<void> wrap_as(const std::string& name, const std::shared_ptr<void>& object) {
  return std::shared_ptr<Interface>(std::make_shared<Concrete>(name, std::static_pointer_cast<Interface>(object)));
}

}  // namespace

std::shared_ptr<const Motions> wrap_plugin(const std::string& name, const std::shared_ptr<Motions>& motions) {
  return std::make_shared<WrappedMotions>(name, motions);
}

std::shared_ptr<void> wrap_plugin(const std::string& kind, const std::string& type,
                                  const std::shared_ptr<void>& object) {
  const std::string name = kind + "/" + type;
  if (kind == Kernel::kKind) return wrap_as<WrappedKernel, Kernel>(name, object);
  if (kind == Acquisition::kKind) return wrap_as<WrappedAcquisition, Acquisition>(name, object);
  if (kind == Fitting::kKind) return wrap_as<WrappedFitting, Fitting>(name, object);
  if (kind == Footprint::kKind) return wrap_as<WrappedFootprint, Footprint>(name, object);
  if (kind == Belief::kKind) return wrap_as<WrappedBelief, Belief>(name, object);
  if (kind == Backend::kKind) return wrap_as<WrappedBackend, Backend>(name, object);
  return wrap_as<WrappedShape, Shape>(name, object);
}

}  // namespace palpate
