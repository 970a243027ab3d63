// A belief without a GP: each position has the height of the nearest contact.
#include <palpate/grid.hpp>
#include <palpate/math.hpp>

#include <stdexcept>
#include <string>

using namespace palpate;

struct MyBeliefOptions : Options {
  double reach = 0.03;
  double signal = 0.05;

  void list(Fields& fields) override {
    fields.real(reach,
                Field("reach", "distance over which a contact tells the height nearby").in(Unit::metre).above(0));
    fields.real(signal,
                Field("signal", "standard deviation of the height far from all contacts").in(Unit::metre).above(0));
  }
};

class MyBelief final : public Belief {
 public:
  using Options = MyBeliefOptions;
  MyBelief(const Options& options, const Context& context)
      : options_(options), scene_(context.scene), lines_(grid_from_above(context)) {}

  std::vector<Quantity> offers() const override {
    return {
        {quantity::kUncertainty, "1 - exp(-(d / reach)^2 / 2), with the distance d to the nearest contact"},
        {quantity::kMeasurementStd, "standard deviation of the height: signal times the root of the uncertainty (m)"},
        {quantity::kHeightMean, "height of the nearest contact (m)"},
        {quantity::kHeightStd, "the same as measurement_std (m)"},
        {quantity::kObjectProbability, "1 if the nearest contact is on an object, otherwise 0"},
        {quantity::kDeskPosition, "fixed positions of the candidates on the desk"}};
  }

  const Candidates& candidates() const override { return lines_; }
  const TapsSoFar& taps() const override { return taps_; }

  std::optional<TapReading> read(const TapRequest& request, const TapResult& result) const override {
    if (!result.is_contact()) return std::nullopt;
    TapReading out;
    out.tap = request.number;
    out.position = {request.line.start.x(), request.line.start.y(), result.height()};
    out.on_object = scene_.on_object(result.height());
    return out;
  }

  void add(const TapRequest& request, const TapResult& result) override {
    taps_.add(request);
    if (const auto reading = read(request, result)) taps_.readings.push_back(*reading);
  }

  void infer() override {
    const Eigen::Index count = lines_.size();
    uncertainty_.setOnes(count);
    height_.setConstant(count, scene_.desk());
    probability_.setZero(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      for (const TapReading& one : taps_.readings) {
        const double d = math::hypot(lines_.starts(i, 0) - one.position.x(), lines_.starts(i, 1) - one.position.y());
        const double uncertainty = 1.0 - math::exp(-0.5 * (d / options_.reach) * (d / options_.reach));
        if (uncertainty >= uncertainty_(i)) continue;
        uncertainty_(i) = uncertainty;
        height_(i) = one.position.z();
        probability_(i) = one.on_object ? 1.0 : 0.0;
      }
    }
    std_ = options_.signal * uncertainty_.cwiseSqrt();
  }

  QuantitySet available() const override {
    using namespace quantity;
    return {kUncertainty, kMeasurementStd, kHeightMean, kHeightStd, kObjectProbability};
  }
  const Eigen::VectorXd& values(std::string_view quantity) const override {
    if (quantity == quantity::kUncertainty) return uncertainty_;
    if (quantity == quantity::kHeightMean) return height_;
    if (quantity == quantity::kObjectProbability) return probability_;
    if (quantity == quantity::kMeasurementStd || quantity == quantity::kHeightStd) return std_;
    throw std::out_of_range("no values of " + std::string(quantity));
  }

  /// Adds a field of its own to each line of the record.
  BeliefState state(std::optional<Eigen::Index> /*candidate*/) const override {
    BeliefState out;
    if (uncertainty_.size() > 0) out.add("nearest.mean_uncertainty", uncertainty_.mean());
    return out;
  }

  void set_truth(const Scene* scene) override { truth_ = scene; }
  std::optional<BeliefErrors> errors(ErrorsFor /*purpose*/) override {
    if (truth_ == nullptr || height_.size() == 0) return BeliefErrors();
    return BeliefErrors{height_errors(lines_, height_, probability_.array() > 0.5, *truth_)};
  }
  Surface surface(double /*resolution*/) override { return {height_, {}, {}, 0.0}; }

 private:
  Options options_;
  const Scene& scene_;
  Candidates lines_;
  TapsSoFar taps_;
  Eigen::VectorXd uncertainty_, std_, height_, probability_;  ///< M values
  const Scene* truth_ = nullptr;
};

PALPATE_PLUGIN(Belief, MyBelief, "starter", "each position has the height of the nearest contact")
