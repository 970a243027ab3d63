// SPDX-License-Identifier: MIT
// A correct plugin of each kind, except for the function in the option `spoils`: it returns the value of `by` instead
// of a finite number. CMakeLists.txt selects the kind.
#include <palpate/acquisition.hpp>
#include <palpate/backend.hpp>
#include <palpate/fitting.hpp>
#include <palpate/footprint.hpp>
#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>
#include <palpate/shape.hpp>

#include <cmath>
#include <limits>
#include <string>

namespace broken {

struct Options : palpate::Options {
  enum class By { nan, infinity };
  std::string spoils;
  By by = By::nan;
  void list(palpate::Fields& fields) override {
    fields.text(spoils, palpate::Field("spoils", "function that is spoilt"));
    fields.choice(by, palpate::Field("by", "what it gives"), {{"nan", "NaN", {}}, {"infinity", "infinity", {}}});
  }
};

/// Common part of all kinds.
class Spoilt {
 public:
  explicit Spoilt(const Options& options)
      : name_(options.spoils), value_(options.by == Options::By::nan ? std::nan("") : kInfinity) {}

 protected:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  bool is(const char* function) const { return name_ == function; }
  /// Returns `sound`, unless `function` is spoilt.
  double number(const char* function, double sound) const { return is(function) ? value_ : sound; }
  double bad() const { return value_; }
  template <class Values>
  void spoil(const char* function, Values& values) const {
    if (is(function) && values.size() > 0) values(values.size() / 2) = value_;
  }
  void spoil(const char* function, palpate::MatrixOut& values) const {
    if (is(function) && values.size() > 0) values(values.rows() - 1, values.cols() - 1) = value_;
  }

 private:
  std::string name_;
  double value_;
};

#ifdef KERNEL
class Kernel final : public palpate::Kernel, Spoilt {
 public:
  using Options = broken::Options;
  Kernel(const Options& options, const palpate::Context&) : Spoilt(options) {}

  void covariance(const palpate::PointsView& a, const palpate::PointsView& b, palpate::MatrixOut out) const override {
    fill(a, b, out);
    spoil("covariance", out);
    if (length_ > 1e12) spoil("covariance of a far fit", out);
  }
  void variance(const palpate::PointsView&, palpate::VectorOut out) const override {
    out.setOnes();
    spoil("variance", out);
  }
  bool separable() const override { return true; }
  void axis_covariance(int, const palpate::VectorView& a, const palpate::VectorView& b,
                       palpate::MatrixOut out) const override {
    for (Eigen::Index j = 0; j < b.size(); ++j) out.col(j) = bell((a.array() - b(j)).square());
    spoil("axis_covariance", out);
  }
  std::vector<palpate::KernelParameter> parameters() const override {
    return {{"length_scale", number("parameters", length_), palpate::Unit::metre}};
  }
  bool differentiable() const override { return true; }
  void set_parameters(const palpate::VectorView& values) override { length_ = number("set_parameters", values(0)); }
  void derivatives(const palpate::PointsView& a, const palpate::PointsView& b, palpate::MatrixOut value,
                   palpate::MatrixOut slopes) const override {
    fill(a, b, value);
    slopes = -2.0 * value.array() * value.array().log();
    spoil("derivatives", slopes);
  }
  bool has_gradient() const override { return true; }
  void gradient_covariance(const palpate::VectorView& r, palpate::VectorOut across,
                           palpate::VectorOut along) const override {
    const double square = length_ * length_;
    across = bell(r.array().square()) / square;
    along = across.array() * (1.0 - r.array().square() / square);
    spoil("gradient_covariance", along);
  }

 private:
  Eigen::ArrayXd bell(const Eigen::ArrayXd& squares) const { return (-0.5 / (length_ * length_) * squares).exp(); }
  void fill(const palpate::PointsView& a, const palpate::PointsView& b, palpate::MatrixOut& out) const {
    for (Eigen::Index j = 0; j < b.rows(); ++j)
      out.col(j) = bell((a.col(0).array() - b(j, 0)).square() + (a.col(1).array() - b(j, 1)).square());
  }

  double length_ = 0.03;
};
PALPATE_PLUGIN(palpate::Kernel, Kernel, PLUGIN_NAME, "gives what is not finite")

#elif defined(ACQUISITION)
class Acquisition final : public palpate::Acquisition, Spoilt {
 public:
  using Options = broken::Options;
  Acquisition(const Options& options, const palpate::Context&) : Spoilt(options) {}
  palpate::QuantitySet reads() const override { return {palpate::quantity::kUncertainty}; }
  void score(const palpate::BeliefView& belief, palpate::VectorOut out) const override {
    out = belief.values(palpate::quantity::kUncertainty);
    spoil("score", out);
  }
  double prior_scale() const override { return number("prior_scale", 1.0); }
};
PALPATE_PLUGIN(palpate::Acquisition, Acquisition, PLUGIN_NAME, "gives what is not finite")

#elif defined(FITTING)
class Fitting final : public palpate::Fitting, Spoilt {
 public:
  using Options = broken::Options;
  Fitting(const Options& options, const palpate::Context&) : Spoilt(options) {}
  bool due(int) const override { return true; }
  palpate::FitSummary fit(palpate::FitProblem& problem, palpate::Random&) const override {
    problem.noise_ratio = number("fit: noise", problem.noise_ratio);
    problem.outputs.front().signal = number("fit: signal", problem.outputs.front().signal);
    problem.outputs.front().mean = number("fit: mean", problem.outputs.front().mean);
    palpate::FitSummary out;
    out.changed = true;
    out.objective = number("fit: objective", 0.0);
    if (is("fit: far")) problem.kernel.set_parameters(Eigen::VectorXd::Constant(1, 1e13));
    if (is("fit: kernel")) problem.kernel.set_parameters(Eigen::VectorXd::Constant(1, bad()));
    return out;
  }
};
PALPATE_PLUGIN(palpate::Fitting, Fitting, PLUGIN_NAME, "gives what is not finite")

#elif defined(FOOTPRINT)
class Footprint final : public palpate::Footprint, Spoilt {
 public:
  using Options = broken::Options;
  Footprint(const Options& options, const palpate::Context&) : Spoilt(options) {}
  void add(const palpate::Touch&) override {}
  void probability(const palpate::PointsView&, palpate::VectorOut out) override {
    out.setConstant(0.5);
    spoil("probability", out);
  }
  void sample(const palpate::PointsView& places, palpate::HypothesisSample& out) const override {
    out.count = 64;
    out.holds.resize(1, places.rows());
    out.holds.setConstant(0xff);
    out.expected_discovery_area = Eigen::VectorXd::Zero(places.rows());
    spoil("sample", out.expected_discovery_area);
  }
  void doubt(palpate::VectorOut out) const override {
    out.setZero();
    spoil("doubt", out);
  }
  void current_positions(palpate::Points& places) const override { spoil("current_positions", places); }
  std::optional<double> undiscovered_probability() const override { return number("undiscovered_probability", 0.0); }
  std::vector<palpate::FootprintNumber> numbers() const override { return {{"one", number("numbers", 1.0)}}; }

 private:
  using Spoilt::spoil;
  void spoil(const char* function, palpate::Points& values) const {
    if (is(function) && values.rows() > 0) values(0, 0) = bad();
  }
};
PALPATE_PLUGIN(palpate::Footprint, Footprint, PLUGIN_NAME, "gives what is not finite")

#elif defined(BACKEND)
class Motions final : public palpate::Motions, Spoilt {
 public:
  explicit Motions(const Options& options) : Spoilt(options) {}
  int count() const override { return 2; }
  double seconds(const palpate::TapRequest&, double) const override { return number("motions: seconds", 1.0); }
  double deviation(int) const override { return number("motions: deviation", 1e-3); }
};

class Backend final : public palpate::Backend, Spoilt {
 public:
  using Options = broken::Options;
  Backend(const Options& options, const palpate::Context&) : Spoilt(options) {}
  static std::unique_ptr<palpate::Motions> motions(const Options& options, const palpate::Scene&) {
    if (options.spoils.rfind("motions", 0) != 0) return nullptr;
    return std::make_unique<Motions>(options);
  }
  palpate::TapResult tap(const palpate::TapRequest& request) override {
    palpate::TapResult out = palpate::contact_on(request.line, number("tap: height", 0.05), number("tap: force", 8.0),
                                                 number("tap: seconds", 1.0));
    out.peak_force = number("tap: peak", 8.0);
    if (request.line.from_above) return out;
    constexpr double kDistance = 0.1;  // metres
    out.distance = number("tap: along", kDistance);
    out.contact = request.line.at(kDistance);
    return out;
  }
  bool taps_any_line() const override { return true; }
  bool repeatable() const override { return true; }
  bool scene_is_truth() const override { return false; }
};
PALPATE_PLUGIN(palpate::Backend, Backend, PLUGIN_NAME, "gives what is not finite")

#elif defined(SHAPE)
/// Cube of 8 cm.
class Shape final : public palpate::Shape, Spoilt {
 public:
  using Options = broken::Options;
  Shape(const Options& options, const palpate::Context&) : Spoilt(options) {}
  double first_intersection(const palpate::Line& line) const override {
    const palpate::LineInterval in = within(line);
    // Infinity is a valid result for a line without intersection.
    if (is("first_intersection")) return std::isnan(bad()) ? bad() : -bad();
    return in.begin < in.end ? in.begin : kInfinity;
  }
  double support(const Eigen::Vector3d& direction) const override {
    return number("support", kHalf * (std::abs(direction.x()) + std::abs(direction.y())) +
                                 std::max(0.0, 2.0 * kHalf * direction.z()));
  }
  double top(double s, double t) const override {
    const bool inside = std::abs(s) <= kHalf && std::abs(t) <= kHalf;
    return number("top", inside ? 2.0 * kHalf : -kInfinity);
  }
  std::vector<palpate::LineInterval> intervals(const palpate::Line& line) const override {
    palpate::LineInterval in = within(line);
    if (!(in.begin < in.end)) return {};
    in.end = number("intervals", in.end);
    return {in};
  }

 private:
  static constexpr double kHalf = 0.04;
  static palpate::LineInterval within(const palpate::Line& line) {
    palpate::LineInterval in{-kInfinity, kInfinity};
    for (int axis = 0; axis < 3; ++axis) {
      const double least = axis < 2 ? -kHalf : 0.0;
      const double a = (least - line.origin(axis)) / line.direction(axis);
      const double b = (least + 2.0 * kHalf - line.origin(axis)) / line.direction(axis);
      in.begin = std::max(in.begin, std::min(a, b));
      in.end = std::min(in.end, std::max(a, b));
    }
    return in;
  }
};
PALPATE_PLUGIN(palpate::Shape, Shape, PLUGIN_NAME, "gives what is not finite")
#endif

}  // namespace broken
