// SPDX-License-Identifier: MIT
// Whatever a plugin's functions throw, whichever of them it was, is told with its name.
#include "host/plugin_calls.hpp"

#include "support/testing.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/backend.hpp>
#include <palpate/fitting.hpp>
#include <palpate/footprint.hpp>
#include <palpate/kernel.hpp>
#include <palpate/shape.hpp>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace palpate::test {
namespace {

[[noreturn]] void fail() { throw std::runtime_error("it broke"); }

struct BrokenKernel final : Kernel {
  void covariance(const PointsView&, const PointsView&, MatrixOut) const override { fail(); }
  void variance(const PointsView&, VectorOut) const override { fail(); }
  bool separable() const override { fail(); }
  void axis_covariance(int, const VectorView&, const VectorView&, MatrixOut) const override { fail(); }
  std::vector<KernelParameter> parameters() const override { fail(); }
  bool differentiable() const override { fail(); }
  void set_parameters(const VectorView&) override { fail(); }
  void derivatives(const PointsView&, const PointsView&, MatrixOut, MatrixOut) const override { fail(); }
};

struct BrokenFitting final : Fitting {
  bool due(int) const override { fail(); }
  std::string objection(const Kernel&) const override { fail(); }
  FitSummary fit(FitProblem&, Random&) const override { fail(); }
};

struct BrokenFootprint final : Footprint {
  bool is_weight() const override { fail(); }
  void add(const Touch&) override { fail(); }
  void probability(const PointsView&, VectorOut) override { fail(); }
  std::optional<double> undiscovered_probability() const override { fail(); }
  std::vector<FootprintNumber> numbers() const override { fail(); }
  std::string remark() const override { fail(); }
};

struct BrokenAcquisition final : Acquisition {
  QuantitySet reads() const override { fail(); }
  void score(const BeliefView&, VectorOut) const override { fail(); }
  double prior_scale() const override { fail(); }
};

struct BrokenBackend final : Backend {
  TapResult tap(const TapRequest&) override { fail(); }
  bool repeatable() const override { fail(); }
  std::vector<std::string> describe(const TapRequest&) override { fail(); }
  std::vector<Learnt> learnt() const override { fail(); }
  bool taps_any_line() const override { fail(); }
  void reaches(const Candidates&, BoolOut) const override { fail(); }
  QuantitySet predicts() const override { fail(); }
  QuantitySet reads() const override { fail(); }
  void show(const BeliefView&) override { fail(); }
  bool scene_is_truth() const override { fail(); }
};

struct BrokenShape final : Shape {
  double first_intersection(const Line&) const override { fail(); }
  std::vector<LineInterval> intervals(const Line&) const override { fail(); }
  double support(const Eigen::Vector3d&) const override { fail(); }
  double top(double, double) const override { fail(); }
};

template <class Broken, class Interface>
std::shared_ptr<Interface> broken() {
  return std::static_pointer_cast<Interface>(
      wrap_plugin(Interface::kKind, "mine", std::shared_ptr<Interface>(std::make_shared<Broken>())));
}

TEST(NamedPlugin, OfEachKindIsNamedByEachOfItsFunctions) {
  const Points points = Points::Zero(2, 2);
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(2);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2, 2);
  const auto kernel = broken<BrokenKernel, Kernel>();
  const std::string of_kernel = "kernel/mine: it broke";
  EXPECT_EQ(error_of([&] { kernel->covariance(points, points, matrix); }), of_kernel);
  EXPECT_EQ(error_of([&] { kernel->variance(points, vector); }), of_kernel);
  EXPECT_EQ(error_of([&] { kernel->separable(); }), of_kernel);
  EXPECT_EQ(error_of([&] { kernel->axis_covariance(0, vector, vector, matrix); }), of_kernel);
  EXPECT_EQ(error_of([&] { kernel->parameters(); }), of_kernel);
  EXPECT_EQ(error_of([&] { kernel->differentiable(); }), of_kernel);
  EXPECT_EQ(error_of([&] { kernel->set_parameters(vector); }), of_kernel);
  EXPECT_EQ(error_of([&] { kernel->derivatives(points, points.topRows(1), vector, matrix); }), of_kernel);

  const auto fitting = broken<BrokenFitting, Fitting>();
  double number = 1.0;
  FitProblem problem{points, *kernel, number, 0.0, {}};
  Random random(1, "test");
  EXPECT_EQ(error_of([&] { fitting->due(1); }), "fitting/mine: it broke");
  EXPECT_EQ(error_of([&] { fitting->objection(*kernel); }), "fitting/mine: it broke");
  EXPECT_EQ(error_of([&] { fitting->fit(problem, random); }), "fitting/mine: it broke");

  const auto footprint = broken<BrokenFootprint, Footprint>();
  EXPECT_EQ(error_of([&] { footprint->is_weight(); }), "footprint/mine: it broke");
  EXPECT_EQ(error_of([&] { footprint->add({}); }), "footprint/mine: it broke");
  EXPECT_EQ(error_of([&] { footprint->probability(points, vector); }), "footprint/mine: it broke");
  EXPECT_EQ(error_of([&] { footprint->undiscovered_probability(); }), "footprint/mine: it broke");
  EXPECT_EQ(error_of([&] { footprint->numbers(); }), "footprint/mine: it broke");
  EXPECT_EQ(error_of([&] { footprint->remark(); }), "footprint/mine: it broke");

  const auto acquisition = broken<BrokenAcquisition, Acquisition>();
  EXPECT_EQ(error_of([&] { acquisition->reads(); }), "acquisition/mine: it broke");
  EXPECT_EQ(error_of([&] { acquisition->prior_scale(); }), "acquisition/mine: it broke");

  const auto backend = broken<BrokenBackend, Backend>();
  EXPECT_EQ(error_of([&] { backend->tap({}); }), "backend/mine: it broke");
  EXPECT_EQ(error_of([&] { backend->repeatable(); }), "backend/mine: it broke");
  EXPECT_EQ(error_of([&] { backend->describe({}); }), "backend/mine: it broke");
  EXPECT_EQ(error_of([&] { backend->learnt(); }), "backend/mine: it broke");
  Eigen::Array<bool, Eigen::Dynamic, 1> reached(0);
  EXPECT_EQ(error_of([&] { backend->taps_any_line(); }), "backend/mine: it broke");
  EXPECT_EQ(error_of([&] { backend->reaches({}, reached); }), "backend/mine: it broke");
  EXPECT_EQ(error_of([&] { backend->predicts(); }), "backend/mine: it broke");
  EXPECT_EQ(error_of([&] { backend->reads(); }), "backend/mine: it broke");
  EXPECT_EQ(error_of([&] { backend->scene_is_truth(); }), "backend/mine: it broke");

  const auto shape = broken<BrokenShape, Shape>();
  EXPECT_EQ(error_of([&] { shape->first_intersection({}); }), "shape/mine: it broke");
  EXPECT_EQ(error_of([&] { shape->intervals({}); }), "shape/mine: it broke");
  EXPECT_EQ(error_of([&] { shape->support({}); }), "shape/mine: it broke");
  EXPECT_EQ(error_of([&] { shape->top(0.0, 0.0); }), "shape/mine: it broke");
}

TEST(NamedPlugin, KeepsPlaceReasonAndRemedyOfAnError) {
  struct Arm final : Backend {
    TapResult tap(const TapRequest& request) override {
      if (request.number == 1) throw Error("arm.txt:3", "has no joint", "add one", Error::Kind::busy);
      throw 42;
    }
    bool repeatable() const override { return true; }
    bool scene_is_truth() const override { return false; }
  };
  const auto backend = broken<Arm, Backend>();
  TapRequest request;
  request.number = 1;
  EXPECT_EQ(error_of([&] { backend->tap(request); }, Error::Kind::busy),
            "backend/mine: arm.txt:3: has no joint, add one");
  request.number = 2;
  EXPECT_EQ(error_of([&] { backend->tap(request); }), "backend/mine: threw an object that is not a std::exception");
  EXPECT_TRUE(backend->repeatable());
}

/// A kernel all of whose functions give NaN.
struct NoNumbers final : Kernel {
  void covariance(const PointsView&, const PointsView&, MatrixOut out) const override { out.setConstant(kNan); }
  void variance(const PointsView&, VectorOut out) const override { out.setConstant(kNan); }
  void axis_covariance(int, const VectorView&, const VectorView&, MatrixOut out) const override {
    out.setConstant(kNan);
  }
  std::vector<KernelParameter> parameters() const override { return {{"length_scale", kNan}}; }
  void derivatives(const PointsView&, const PointsView&, MatrixOut value, MatrixOut slopes) const override {
    value.setConstant(1.0);
    slopes.setConstant(kNan);
  }
  void gradient_covariance(const VectorView&, VectorOut across, VectorOut along) const override {
    across.setConstant(1.0);
    along.setConstant(kNan);
  }
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
};

TEST(NamedKernel, ThatGivesWhatIsNotFiniteIsNamedWithItsFunction) {
  const Points points = Points::Zero(2, 2);
  Eigen::VectorXd vector = Eigen::VectorXd::Zero(2);
  Eigen::VectorXd other = vector;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(2, 2);
  const auto kernel = broken<NoNumbers, Kernel>();
  const auto said = [](const std::string& function) {
    return "kernel/mine: " + function + "() returned a number that is not finite, correct the plugin";
  };
  EXPECT_EQ(error_of([&] { kernel->covariance(points, points, matrix); }), said("covariance"));
  EXPECT_EQ(error_of([&] { kernel->variance(points, vector); }), said("variance"));
  EXPECT_EQ(error_of([&] { kernel->axis_covariance(0, vector, vector, matrix); }), said("axis_covariance"));
  EXPECT_EQ(error_of([&] { kernel->parameters(); }), said("parameters"));
  EXPECT_EQ(error_of([&] { kernel->derivatives(points, points, matrix, matrix); }), said("derivatives"));
  EXPECT_EQ(error_of([&] { kernel->gradient_covariance(vector, vector, other); }), said("gradient_covariance"));
  // No kernel makes numbers of such hyperparameters: a fit that tries them turns back.
  kernel->set_parameters(Eigen::VectorXd::Constant(1, 1e200));
  kernel->covariance(points, points, matrix);
  EXPECT_TRUE(std::isnan(matrix(0, 0)));
}

}  // namespace
}  // namespace palpate::test
