// SPDX-License-Identifier: MIT
#include "plugin/named.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/backend.hpp>
#include <palpate/error.hpp>
#include <palpate/fitting.hpp>
#include <palpate/footprint.hpp>
#include <palpate/kernel.hpp>
#include <palpate/shape.hpp>

#include <utility>

namespace palpate {
namespace {

/// A plugin has read what it did not declare. By whatever parts of it the call went, it is the plugin's own fault.
class Undeclared final : public Error {
 public:
  using Error::Error;
};

/// A belief of which a plugin may read what it said it reads.
class Declared final : public Belief {
 public:
  /// `belief` and the plugin's `name` must outlive it.
  Declared(const Belief& belief, Quantities reads, const std::string& name)
      : belief_(belief), reads_(reads), name_(name) {}
  const Points& candidates() const override { return belief_.candidates(); }
  Area area() const override { return belief_.area(); }
  int taps() const override { return belief_.taps(); }
  int initial_taps() const override { return belief_.initial_taps(); }
  const Eigen::VectorXd& uncertainty() const override {
    return declared(Quantity::uncertainty, "the uncertainty u").uncertainty();
  }
  const Eigen::VectorXd& weight() const override { return declared(Quantity::weight, "the weight w").weight(); }
  const Eigen::VectorXd& probability() const override {
    return declared(Quantity::probability, "the probability p").probability();
  }
  const Eigen::VectorXd& height_mean() const override { return declared(Quantity::height, "the height").height_mean(); }
  const Eigen::VectorXd& height_variance() const override {
    return declared(Quantity::height, "the height").height_variance();
  }

 private:
  const Belief& declared(Quantity one, const char* name) const {
    if (reads_.has(one)) return belief_;
    throw Undeclared(name_, std::string("reads ") + name + ", which its reads() does not name", "add it there",
                     Error::Kind::run);
  }

  const Belief& belief_;
  Quantities reads_;
  const std::string& name_;
};

template <class Interface>
class Named : public Interface {
 public:
  Named(std::string name, std::shared_ptr<Interface> inner) : name_(std::move(name)), inner_(std::move(inner)) {}

 protected:
  const std::string& name() const { return name_; }

  template <class Call>
  auto in_plugin(const Call& call) const {
    try {
      return call(*inner_);
    } catch (const Undeclared&) {
      throw;
    } catch (const Error& trouble) {
      const std::string place = trouble.where().empty() ? std::string() : trouble.where() + ": ";
      throw Error(name_, place + trouble.reason(), trouble.hint(), trouble.kind());
    } catch (const std::exception& trouble) {
      throw Error(name_, trouble.what(), {}, Error::Kind::run);
    } catch (...) {
      throw Error(name_, "threw something that is no exception", {}, Error::Kind::run);
    }
  }

 private:
  std::string name_;
  std::shared_ptr<Interface> inner_;
};

class NamedKernel final : public Named<Kernel> {
 public:
  using Named::Named;
  void covariance(const PointsView& a, const PointsView& b, MatrixOut out) const override {
    in_plugin([&](const Kernel& inner) { inner.covariance(a, b, out); });
  }
  void variance(const PointsView& a, VectorOut out) const override {
    in_plugin([&](const Kernel& inner) { inner.variance(a, out); });
  }
  bool separable() const override {
    return in_plugin([](const Kernel& inner) { return inner.separable(); });
  }
  void axis_covariance(int axis, const VectorView& a, const VectorView& b, MatrixOut out) const override {
    in_plugin([&](const Kernel& inner) { inner.axis_covariance(axis, a, b, out); });
  }
  std::vector<KernelParameter> parameters() const override {
    return in_plugin([](const Kernel& inner) { return inner.parameters(); });
  }
  bool differentiable() const override {
    return in_plugin([](const Kernel& inner) { return inner.differentiable(); });
  }
  void set_parameters(const VectorView& values) override {
    in_plugin([&](Kernel& inner) { inner.set_parameters(values); });
  }
  void derivatives(const PointsView& a, const PointsView& b, VectorOut value, MatrixOut slopes) const override {
    in_plugin([&](const Kernel& inner) { inner.derivatives(a, b, value, slopes); });
  }
};

class NamedAcquisition final : public Named<Acquisition> {
 public:
  using Named::Named;
  Quantities reads() const override {
    return in_plugin([](const Acquisition& inner) { return inner.reads(); });
  }
  void score(const Belief& belief, VectorOut out) const override {
    in_plugin([&](const Acquisition& inner) { inner.score(Declared(belief, inner.reads(), this->name()), out); });
  }
  double prior_scale() const override {
    return in_plugin([](const Acquisition& inner) { return inner.prior_scale(); });
  }
};

class NamedFitting final : public Named<Fitting> {
 public:
  using Named::Named;
  bool due(int taps) const override {
    return in_plugin([&](const Fitting& inner) { return inner.due(taps); });
  }
  std::string objection(const Kernel& kernel) const override {
    return in_plugin([&](const Fitting& inner) { return inner.objection(kernel); });
  }
  FitSummary fit(FitProblem& problem, Random& random) const override {
    return in_plugin([&](const Fitting& inner) { return inner.fit(problem, random); });
  }
};

class NamedFootprint final : public Named<Footprint> {
 public:
  using Named::Named;
  bool is_weight() const override {
    return in_plugin([](const Footprint& inner) { return inner.is_weight(); });
  }
  void add(const Touch& touch) override {
    in_plugin([&](Footprint& inner) { inner.add(touch); });
  }
  void probability(const PointsView& places, VectorOut out) override {
    in_plugin([&](Footprint& inner) { inner.probability(places, out); });
  }
  std::vector<FootprintNumber> numbers() const override {
    return in_plugin([](const Footprint& inner) { return inner.numbers(); });
  }
  std::string remark() const override {
    return in_plugin([](const Footprint& inner) { return inner.remark(); });
  }
};

class NamedBackend final : public Named<Backend> {
 public:
  using Named::Named;
  Contact tap(const TapRequest& request) override {
    return in_plugin([&](Backend& inner) { return inner.tap(request); });
  }
  bool repeatable() const override {
    return in_plugin([](const Backend& inner) { return inner.repeatable(); });
  }
  std::vector<std::string> describe(const TapRequest& request) override {
    return in_plugin([&](Backend& inner) { return inner.describe(request); });
  }
  std::vector<Learnt> learnt() const override {
    return in_plugin([](const Backend& inner) { return inner.learnt(); });
  }
  bool wants_prediction() const override {
    return in_plugin([](const Backend& inner) { return inner.wants_prediction(); });
  }
  Quantities reads() const override {
    return in_plugin([](const Backend& inner) { return inner.reads(); });
  }
  void show(const Belief& belief) override {
    in_plugin([&](Backend& inner) { inner.show(Declared(belief, inner.reads(), this->name())); });
  }
  bool scene_is_truth() const override {
    return in_plugin([](const Backend& inner) { return inner.scene_is_truth(); });
  }
};

class NamedShape final : public Named<Shape> {
 public:
  using Named::Named;
  double first_hit(const Line& line) const override {
    return in_plugin([&](const Shape& inner) { return inner.first_hit(line); });
  }
  double support(const Eigen::Vector3d& direction) const override {
    return in_plugin([&](const Shape& inner) { return inner.support(direction); });
  }
  double top(double s, double t) const override {
    return in_plugin([&](const Shape& inner) { return inner.top(s, t); });
  }
};

/// A pointer to the interface, as it was: what becomes of it is cast back to that.
template <class Wrapper, class Interface>
std::shared_ptr<void> wrapped(const std::string& name, const std::shared_ptr<void>& object) {
  return std::shared_ptr<Interface>(std::make_shared<Wrapper>(name, std::static_pointer_cast<Interface>(object)));
}

}  // namespace

std::shared_ptr<void> named(const std::string& kind, const std::string& type, const std::shared_ptr<void>& object) {
  const std::string name = kind + "/" + type;
  if (kind == Kernel::kKind) return wrapped<NamedKernel, Kernel>(name, object);
  if (kind == Acquisition::kKind) return wrapped<NamedAcquisition, Acquisition>(name, object);
  if (kind == Fitting::kKind) return wrapped<NamedFitting, Fitting>(name, object);
  if (kind == Footprint::kKind) return wrapped<NamedFootprint, Footprint>(name, object);
  if (kind == Backend::kKind) return wrapped<NamedBackend, Backend>(name, object);
  return wrapped<NamedShape, Shape>(name, object);
}

}  // namespace palpate
