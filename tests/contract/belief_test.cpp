// SPDX-License-Identifier: MIT
// The laws of belief.hpp, over every belief found, and over those that the program contains.
#include "support/instruction_sets.hpp"
#include "support/testing.hpp"

#include <palpate/belief.hpp>
#include <palpate/kernel.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ostream>

namespace palpate::test {
namespace {

struct BeliefCase {
  std::string name;
  std::string type;
  std::string options = "{}";
};

void PrintTo(const BeliefCase& one, std::ostream* out) { *out << one.name; }

std::vector<BeliefCase> belief_cases() {
  std::vector<BeliefCase> out{
      {"height_map", "height_map"},
      {"height_map_two_part", "height_map",
       "{surface: two_part, height: {signal: 10 cm, noise: 6 mm, outlier_probability: 0.03, offset: {}}, "
       "footprint: {type: primitives, particles: 100, kernel: {type: rbf, length_scale: 3 cm}}}"},
      {"solids", "solids", "{particles: 4, moves: 20}"}};
  for (const std::string& name : plugins_under_contract("belief")) {
    if (name != "solids") out.push_back({test_name(name), name});
  }
  return out;
}

/// Every quantity that belongs to one candidate or is one number; `hypotheses` are read by a call of their own.
bool is_array(const Belief& belief, const std::string& name) {
  return belief.available().count(name) != 0 && name != quantity::kHypotheses && name != quantity::kDeskPosition;
}

/// A belief over the wave, its taps answered by the scene.
class Believer {
 public:
  explicit Believer(const BeliefCase& one, bool reads = true) : context_(context_of(contract_host())) {
    context_.run.kernel = choose(contract_host(), "kernel", "matern32", "{length_scale: 3 cm}");
    context_.run.fitting = choose(contract_host(), "fitting", "fixed");
    context_.run.candidates = one.type == "solids" ? 40 : 9;
    context_.run.taps = 12;
    belief_ = context_.create<Belief>(choose(contract_host(), "belief", one.type, one.options));
    if (!reads) return;
    ReadPlan plan;
    QuantitySet all;
    for (const Quantity& quantity : belief_->offers()) all.insert(quantity.name);
    plan.readers.push_back({"test", all, Stage::first_tap});
    plan.surface_from = Stage::first_tap;
    belief_->plan(plan);
    belief_->begin(Stage::first_tap);
    look();
  }

  Belief& belief() { return *belief_; }

  void look() {
    belief_->update();
    belief_->draw_candidates([](const Candidates&, BoolOut out) { out.setConstant(true); });
    belief_->infer();
  }

  /// Returns the request along a candidate and its result in the scene.
  std::pair<TapRequest, TapResult> tapped(Eigen::Index candidate) const {
    const Scene& scene = context_.scene;
    TapRequest request;
    request.number = belief_->taps().count + 1;
    request.line = belief_->candidates().line(candidate);
    const double desk = distance_down_to(scene.desk(), request.line.line());
    const double along = std::min({scene.first_intersection(request.line.line()), desk, request.line.length});
    if (along >= request.line.length) return {request, tap_without_contact(Outcome::no_contact, 1.0, "")};
    TapResult result = contact_on(request.line, 0.0, 1.0, 1.0);
    result.contact = request.line.at(along);
    result.distance = along;
    return {request, result};
  }

  void tap(Eigen::Index candidate) {
    const auto [request, result] = tapped(candidate % belief_->candidates().size());
    belief_->add(request, result);
    look();
  }

  void tap_some(int count) {
    for (int i = 0; i < count; ++i) tap(Eigen::Index{7} * i + 4);
  }

  /// Returns all that a reader may see, as text.
  std::string seen() {
    std::string out = fmt::format("taps {}, of the design {}\n", belief_->taps().count, belief_->taps().initial);
    for (const TapReading& one : belief_->taps().readings)
      out +=
          fmt::format("{} {} {} {} {}\n", one.tap, one.position.z(), one.on_object, one.outlier_probability, one.moved);
    for (const Quantity& one : belief_->offers()) {
      if (is_array(*belief_, one.name)) {
        const Eigen::VectorXd& values = belief_->values(one.name);
        out += fmt::format("{}: {}\n", one.name, fmt::join(values.begin(), values.end(), " "));
      } else if (const std::optional<double> number = belief_->scalar(one.name)) {
        out += fmt::format("{}: {}\n", one.name, *number);
      }
    }
    const Surface surface = belief_->surface(kFineResolution);
    out += fmt::format("heights {}\n", fmt::join(surface.heights.begin(), surface.heights.end(), " "));
    for (const Surface::Vertex& one : surface.vertices)
      out += fmt::format("{} {}\n", one.position.x(), one.position.z());
    return out;
  }

 private:
  Context context_;
  std::shared_ptr<Belief> belief_;
};

class BeliefContract : public testing::TestWithParam<BeliefCase> {};

TEST_P(BeliefContract, OffersEachQuantityOnceWithItsMeaning) {
  Believer one(GetParam());
  std::set<std::string> names;
  for (const Quantity& quantity : one.belief().offers()) {
    EXPECT_TRUE(names.insert(quantity.name).second) << quantity.name;
    EXPECT_FALSE(quantity.meaning.empty()) << quantity.name;
  }
  for (const std::string& name : one.belief().available()) EXPECT_EQ(names.count(name), 1U) << name;
}

TEST_P(BeliefContract, GivesOneFiniteNumberPerCandidate) {
  Believer one(GetParam());
  for (int taps = 0; taps <= 5; ++taps) {
    if (taps > 0) one.tap(11 * Eigen::Index{taps});
    int arrays = 0;
    for (const Quantity& quantity : one.belief().offers()) {
      if (!is_array(one.belief(), quantity.name)) continue;
      ++arrays;
      const Eigen::VectorXd& values = one.belief().values(quantity.name);
      EXPECT_EQ(values.size(), one.belief().candidates().size()) << quantity.name << " after tap " << taps;
      EXPECT_TRUE(values.allFinite()) << quantity.name << " after tap " << taps;
      const bool is_share = quantity.name == quantity::kUncertainty || quantity.name == quantity::kObjectProbability;
      EXPECT_TRUE(!is_share || (values.array() >= 0.0 && values.array() <= 1.0).all()) << quantity.name;
    }
    EXPECT_GT(arrays, 0) << "after tap " << taps;
  }
}

TEST_P(BeliefContract, OffersCandidatesWhoseDirectionsAreUnitVectors) {
  Believer one(GetParam());
  one.tap_some(2);
  const Candidates& all = one.belief().candidates();
  ASSERT_GT(all.size(), 0);
  for (Eigen::Index i = 0; i < all.size(); ++i) {
    EXPECT_NEAR(all.line(i).direction.norm(), 1.0, 1e-12);
    EXPECT_GT(all.line(i).length, 0.0);
  }
  EXPECT_TRUE(!all.fixed || all.size() == Eigen::Index{all.rows} * all.columns);
}

TEST_P(BeliefContract, IsTheSameAfterTheSameTaps) {
  Believer one(GetParam());
  Believer other(GetParam());
  for (Believer* each : {&one, &other}) each->tap_some(5);
  EXPECT_EQ(one.seen(), other.seen());
}

TEST_P(BeliefContract, IsChangedByNoReader) {
  Believer read(GetParam());
  Believer unread(GetParam());
  for (int i = 0; i < 5; ++i) {
    read.seen();
    read.belief().state(0);
    read.belief().errors(ErrorsFor::tap);
    const auto [request, result] = read.tapped(3);
    read.belief().read(request, result);
    read.look();
    for (Believer* each : {&read, &unread}) each->tap(Eigen::Index{5} * i + 2);
  }
  EXPECT_EQ(read.seen(), unread.seen());
}

TEST_P(BeliefContract, LearnsFromTapsThatWereMadeBeforeItsReadersBegan) {
  Believer early(GetParam());
  early.tap_some(5);
  Believer late(GetParam(), false);
  ReadPlan plan;
  QuantitySet all;
  for (const Quantity& quantity : late.belief().offers()) all.insert(quantity.name);
  plan.readers.push_back({"test", all, Stage::first_scored_tap});
  plan.surface_from = Stage::first_scored_tap;
  late.belief().plan(plan);
  late.look();
  late.tap_some(5);
  late.belief().begin(Stage::first_scored_tap);
  late.look();
  EXPECT_EQ(late.belief().taps().count, 5);
  for (const std::string& name : late.belief().available()) {
    if (!is_array(late.belief(), name)) continue;
    const Eigen::VectorXd& values = late.belief().values(name);
    EXPECT_LT((values - early.belief().values(name)).cwiseAbs().maxCoeff(), 1e-9) << name;
  }
}

TEST_P(BeliefContract, CountsAFailedTapAndLearnsNothingFromIt) {
  Believer one(GetParam());
  one.tap_some(3);
  const std::size_t readings = one.belief().taps().readings.size();
  TapRequest request;
  request.number = 4;
  request.source = Source::initial;
  request.line = one.belief().candidates().line(0);
  const TapResult failed = tap_without_contact(Outcome::aborted, 1.0, "stopped");
  EXPECT_FALSE(one.belief().read(request, failed));
  const int initial = one.belief().taps().initial;
  one.belief().add(request, failed);
  one.look();
  EXPECT_EQ(one.belief().taps().count, 4);
  EXPECT_EQ(one.belief().taps().initial, initial + 1);
  EXPECT_EQ(one.belief().taps().readings.size(), readings);
}

TEST_P(BeliefContract, ReadsAContactAsItTakesItIn) {
  Believer one(GetParam());
  one.tap_some(3);
  const auto [request, result] = one.tapped(4);
  const std::optional<TapReading> read = one.belief().read(request, result);
  one.belief().add(request, result);
  ASSERT_TRUE(read || !result.is_contact());
  if (!read) return;
  const TapReading& taken_in = one.belief().taps().readings.back();
  EXPECT_EQ(taken_in.tap, 4);
  EXPECT_EQ(taken_in.on_object, read->on_object);
  EXPECT_NEAR((taken_in.position - read->position).norm(), 0.0, 0.01) << "an offset is estimated with the tap itself";
}

TEST_P(BeliefContract, HasErrorsOnlyWhereTheTruthIsKnown) {
  Believer one(GetParam());
  one.tap_some(4);
  one.belief().set_truth(nullptr);
  EXPECT_FALSE(one.belief().errors(ErrorsFor::tap)->errors.overall());
  one.belief().set_truth(&wave_scene());
  const std::optional<double> error = one.belief().errors(ErrorsFor::tap)->errors.overall();
  ASSERT_TRUE(error);
  EXPECT_TRUE(std::isfinite(*error));
}

TEST_P(BeliefContract, RefusesANameThatNobodyOffers) {
  Believer one(GetParam());
  EXPECT_FALSE(one.belief().scalar("nothing_of_this_name"));
  EXPECT_EQ(one.belief().available().count("nothing_of_this_name"), 0U);
  EXPECT_ANY_THROW(one.belief().values("nothing_of_this_name"));
}

INSTANTIATE_TEST_SUITE_P(Every, BeliefContract, testing::ValuesIn(belief_cases()),
                         [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace palpate::test
