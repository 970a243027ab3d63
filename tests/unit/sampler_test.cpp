// SPDX-License-Identifier: MIT
// A belief as a set of hypotheses: what is told of them is what is told of each one, and they are drawn by their
// weights.
#include "primitives/sampler.hpp"

#include "hypothesis_bench.hpp"
#include "support/instruction_sets.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <array>
#include <utility>

namespace palpate::footprints {
namespace {

Sampler belief_of(int count, double moves, double label_error, std::uint64_t seed) {
  Prior::Settings settings;
  settings.area = {0.23, 0.23};
  SamplerSettings how;
  how.particles = count;
  how.moves = how.moves_apart = moves;
  how.label_error = how.false_contact = label_error;
  return {Prior(settings), how, Random(seed, "particles test")};
}

std::vector<Hypothesis> hypotheses(const Sampler& belief) {
  std::vector<Hypothesis> out;
  for (const Particle& particle : belief.particles()) out.push_back(particle.hypothesis);
  return out;
}

bool equal_forms(const Form& one, const Form& other) {
  return one.family == other.family && one.x == other.x && one.y == other.y && one.a == other.a && one.b == other.b &&
         one.cosine == other.cosine && one.sine == other.sine;
}

bool equal_hypotheses(const Hypothesis& one, const Hypothesis& other) {
  return std::equal(one.primitives.begin(), one.primitives.end(), other.primitives.begin(), other.primitives.end(),
                    [](const Primitive& a, const Primitive& b) {
                      return equal_forms(a.form, b.form) && a.hollow == b.hollow &&
                             (!a.hollow || equal_forms(a.hole, b.hole));
                    });
}

/// Whether bit `k` of a sample is set at place `i`.
template <class Bits>
bool bit(const Bits& bits, int k, Eigen::Index i) {
  return (bits(k / 64, i) >> (k % 64) & 1U) != 0;
}

TEST(Sampler, AreAsProbablyAtPlacesOfALatticeAsAtEachAloneAndNowhereLessThanTheirHypotheses) {
  Sampler belief = belief_of(500, 4, 0.02, 4);
  std::vector<Touch> touches = test::disc_touches(6);
  touches.insert(touches.begin() + 2, test::touch_at(0.115, 0.115, true));
  for (const Touch& touch : touches) {
    belief.add(touch);
    for (const auto& [columns, rows] :
         {std::pair{31, 31}, {31, 7}, {63, 5}, {64, 5}, {150, 3}, {1, 40}, {40, 1}, {1, 1}}) {
      const Points places = test::lattice(columns, rows);
      Eigen::VectorXd inside = Eigen::VectorXd::Zero(places.rows());
      belief.probability(places, inside);
      const Points twice = test::doubled(places, 0.0);  // which is no lattice
      Eigen::VectorXd one_by_one = Eigen::VectorXd::Zero(twice.rows());
      belief.probability(twice, one_by_one);
      for (Eigen::Index i = 0; i < places.rows(); ++i) {
        ASSERT_NEAR(inside(i), one_by_one(2 * i), 1e-9) << columns << " x " << rows << ", place " << i;
        const auto held = std::count_if(belief.particles().begin(), belief.particles().end(), [&](const Particle& one) {
          return one.hypothesis.contains(places(i, 0), places(i, 1));
        });
        ASSERT_GE(inside(i), static_cast<double>(held) / belief.size() - 1e-12);
        ASSERT_LE(inside(i), 1.0);
      }
    }
  }
}

TEST(Sampler, AreSampledAsTheyAreWithWhatMeetsThem) {
  constexpr int kSample = 6400;
  Sampler belief = belief_of(320, 4, 0.02, 5);
  const std::vector<Touch> touches{test::touch_at(0.08, 0.08, true), test::touch_at(0.03, 0.10, false),
                                   test::touch_at(0.09, 0.14, false), test::touch_at(0.12, 0.05, false)};
  for (const Touch& touch : touches) belief.add(touch);
  for (const Points& where : {test::lattice(23, 23), test::lattice(130, 4), test::scattered(200)}) {
    OutlineSample sample;
    belief.sample(where, kSample, sample);
    ASSERT_EQ(sample.count, kSample);
    Eigen::VectorXd probability(where.rows());
    belief.probability(where, probability);
    Eigen::VectorXd held = Eigen::VectorXd::Zero(where.rows());
    Eigen::VectorXd touched = Eigen::VectorXd::Zero(where.rows());
    for (int k = 0; k < kSample; ++k) {
      const int one = k / (kSample / belief.size());
      const Hypothesis& hypothesis = belief.particles()[static_cast<std::size_t>(one)].hypothesis;
      for (Eigen::Index i = 0; i < where.rows(); ++i) {
        const bool holds = bit(sample.holds, k, i);
        const bool has = hypothesis.contains(where(i, 0), where(i, 1));
        ASSERT_TRUE(holds || !has);
        held(i) += holds ? 1.0 / kSample : 0.0;
        touched(i) += has ? 1.0 / kSample : 0.0;
      }
    }
    // What is expected less often than once may be there once.
    for (Eigen::Index i = 0; i < where.rows(); ++i)
      EXPECT_LE(held(i),
                probability(i) + 5.0 * std::sqrt(probability(i) * (1.0 - probability(i)) / kSample) + 1.0 / kSample);
    EXPECT_GT(held.sum(), 1.01 * touched.sum()) << "some primitives that were not touched meet some that were";
  }
}

TEST(Sampler, TakesEveryParticleForSomeSampleThatIsSmallerThanThereAreParticles) {
  constexpr int kCount = 384;
  constexpr int kSample = 256;
  Sampler belief = belief_of(kCount / 2, 4, 0.02, 6);
  belief.add(test::touch_at(0.11, 0.12, true));  // doubles them
  const Points where = test::scattered(100);
  std::vector<bool> taken(kCount, false);
  for (int tap = 0; tap < 8; ++tap) {
    belief.add(test::touch_at(0.02 + 0.01 * tap, 0.2, false));
    ASSERT_EQ(belief.size(), kCount);
    OutlineSample sample;
    belief.sample(where, kSample, sample);
    // Two of three particles from a first one on: the sample is one of these, with other primitives beside.
    int possible = 0;
    for (const double first : {0.1, 0.5, 0.9}) {
      const auto particle = [&](int k) { return static_cast<std::size_t>((k + first) * kCount / kSample); };
      bool is = true;
      for (int k = 0; k < kSample && is; ++k) {
        for (Eigen::Index i = 0; i < where.rows(); ++i)
          is = is && (bit(sample.holds, k, i) ||
                      !belief.particles()[particle(k)].hypothesis.contains(where(i, 0), where(i, 1)));
      }
      if (!is) continue;
      ++possible;
      for (int k = 0; k < kSample; ++k) taken[particle(k)] = true;
    }
    EXPECT_EQ(possible, 1);
  }
  EXPECT_EQ(std::count(taken.begin(), taken.end(), false), 0);
}

TEST(Sampler, ExpectToFindWhatThePriorHasWhereNothingWasTouchedAndLessBesideAnObject) {
  const Points places = test::scattered(12);
  Eigen::VectorXd exact = Eigen::VectorXd::Zero(places.rows());
  Prior::Settings settings;
  settings.area = {0.23, 0.23};
  const Prior prior(settings);
  Random random(31, "particles test");
  const int draws = test::brief() ? 50000 : 200000;
  for (int i = 0; i < draws; ++i) {
    const Primitive primitive = prior.draw_primitive(random);
    for (Eigen::Index k = 0; k < places.rows(); ++k) {
      if (primitive.contains(places(k, 0), places(k, 1)))
        exact(k) += settings.expected * primitive.form.extent() / draws;
    }
  }
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(places.rows());
  Eigen::VectorXd beside = Eigen::VectorXd::Zero(places.rows());
  constexpr int kRuns = 10;
  OutlineSample sample;
  for (int run = 0; run < kRuns; ++run) {
    Sampler belief = belief_of(100, 20, 0.02, 40 + static_cast<std::uint64_t>(run));
    belief.sample(places, 64, sample);
    mean += sample.to_find / kRuns;
    belief.add(test::touch_at(places(0, 0), places(0, 1), true));
    belief.sample(places, 64, sample);
    beside += sample.to_find / kRuns;
    EXPECT_EQ(sample.to_find(0), 0.0) << "what holds it was found";
  }
  // Each run stands for the prior by four thousand primitives, of which at least one in a hundred holds a place.
  EXPECT_LT((mean - exact).cwiseQuotient(exact).cwiseAbs().maxCoeff(), 5.0 / std::sqrt(4096.0 * kRuns * 0.01));
  EXPECT_TRUE((beside.array() <= mean.array() + 1e-15).all());
}

TEST(Sampler, AreTwiceAsManyForTenTouchesFromWhenSomethingIsFound) {
  Sampler belief = belief_of(100, 1.0, 0.02, 3);
  const auto add = [&](double x, double y, bool on) {
    belief.add(test::touch_at(x, y, on));
    return belief.size();
  };
  EXPECT_EQ(add(0.02, 0.02, false), 100) << "nothing was found";
  EXPECT_EQ(add(0.11, 0.12, true), 200);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(add(0.11 + 0.001 * i, 0.12, true), 200) << "it was known";
  for (int i = 0; i < 5; ++i) EXPECT_EQ(add(0.15, 0.08 + 0.02 * i, false), 200);
  EXPECT_EQ(add(0.02, 0.02, false), 100);
  EXPECT_EQ(add(0.19, 0.12, true), 200) << "another thing";
}

TEST(Sampler, AreDrawnAsOftenAsTheirWeightSaysButForLessThanOneAndOnAverage) {
  constexpr std::size_t kCount = 100;
  const int seeds = test::brief() ? 40 : 400;
  constexpr double kWrong = 0.2;
  const std::array<std::size_t, 3> looked_at{0, kCount / 2, kCount - 1};
  constexpr int kLooks = 12;  // after some of which there are fewer
  std::array<double, 3> excess{};
  std::array<int, 3> times{};
  for (int seed = 1; seed <= seeds; ++seed) {
    Sampler belief = belief_of(static_cast<int>(kCount), 0.0, kWrong, static_cast<std::uint64_t>(seed));  // no moves
    belief.add(test::touch_at(0.11, 0.12, true));  // of which each hypothesis makes its own
    Random random(static_cast<std::uint64_t>(seed), "particles test: places");
    for (int touch = 0; touch < kLooks; ++touch) {
      const Target place{0.23 * random.uniform(), 0.23 * random.uniform()};
      const std::vector<Hypothesis> before = hypotheses(belief);
      const double evidence = belief.add({place, 0.0, false});
      const std::vector<Hypothesis> after = hypotheses(belief);
      // Evidence is the mean weight; from it is seen how probable it was that something new is there.
      const auto weight = [&](const Hypothesis& one) { return one.contains(place.x, place.y) ? kWrong : 1.0 - kWrong; };
      double mean = 0.0;
      for (const Hypothesis& one : before) mean += weight(one) / static_cast<double>(before.size());
      if (mean < kWrong + 1e-9) continue;  // all hold it
      const double something_new = (mean - evidence) / (mean - kWrong);
      ASSERT_GE(something_new, -1e-9);
      ASSERT_LT(something_new, 0.9);
      for (std::size_t k = 0; k < looked_at.size(); ++k) {
        const Hypothesis& one = before[looked_at[k]];
        const auto equal = [&](const Hypothesis& other) { return equal_hypotheses(other, one); };
        const auto alike = static_cast<double>(std::count_if(before.begin(), before.end(), equal));
        const auto copies = static_cast<double>(std::count_if(after.begin(), after.end(), equal));
        const double expected = ((1.0 - something_new) * weight(one) + something_new * kWrong) / evidence *
                                static_cast<double>(after.size()) / static_cast<double>(before.size());
        ASSERT_LT(std::abs(copies - alike * expected), alike + 1e-9);
        if (alike > 1.0) continue;
        excess[k] += copies - expected;
        ++times[k];
      }
    }
  }
  // A count that is one of two neighbours has a standard deviation of at most 1/2.
  for (std::size_t k = 0; k < excess.size(); ++k) {
    EXPECT_LT(std::abs(excess[k]) / times[k], 5.0 * 0.5 / std::sqrt(times[k])) << k;
    EXPECT_GT(times[k], seeds / 2) << k;
  }
}

TEST(Sampler, OfOneSeedAreTheSameToTheLastBitAndOfAnotherAreOthers) {
  const auto after = [](std::uint64_t seed) {
    Sampler belief = belief_of(300, 4, 0.02, seed);
    for (const Touch& touch : test::disc_touches(8)) belief.add(touch);
    return hypotheses(belief);
  };
  const std::vector<Hypothesis> one = after(7);
  EXPECT_TRUE(std::equal(one.begin(), one.end(), after(7).begin(), equal_hypotheses));
  EXPECT_FALSE(std::equal(one.begin(), one.end(), after(8).begin(), equal_hypotheses));
}

TEST(Sampler, OfOneSeedAreTheSameToTheLastBitOnEveryInstructionSet) {
  const Points positions = test::lattice(31, 29);
  const auto after = [&](Instructions set) {
    const test::OnInstructions on(set);
    Prior::Settings settings;
    settings.area = {0.23, 0.23};
    SamplerSettings how;
    how.position_noise = 0.003;
    how.push_probability = 0.05;
    Sampler belief(Prior(settings), how, Random(8, "sampler test: instructions"));
    for (const Touch& touch : test::disc_touches(12)) belief.add(touch);
    std::pair<std::vector<Hypothesis>, OutlineSample> out(hypotheses(belief), {});
    belief.sample(positions, 256, out.second);
    return out;
  };
  const auto [some, sample] = after(Instructions::baseline);
  for (const Instructions set : math::instruction_sets()) {
    const auto [others, other_sample] = after(set);
    EXPECT_TRUE(std::equal(some.begin(), some.end(), others.begin(), others.end(), equal_hypotheses));
    EXPECT_EQ(sample.holds, other_sample.holds);
    EXPECT_EQ(sample.to_find, other_sample.to_find);
  }
}

TEST(Sampler, AgreeWithLabelsThatAnHypothesisExplains) {
  Sampler belief = belief_of(1000, 4, 0.02, 9);
  for (const Touch& touch : test::disc_touches(25)) belief.add(touch);
  EXPECT_LT(belief.mean_label_errors(), 0.7);
  // Objects and desk by turns at one place: one half of the labels is wrong whatever the hypothesis.
  Sampler puzzled = belief_of(1000, 4, 0.02, 9);
  for (const Touch& touch : test::contradictory_touches(24)) puzzled.add(touch);
  EXPECT_NEAR(puzzled.mean_label_errors(), 12.0, 1e-9);
}

TEST(Sampler, KeepWhatTheyAskForAgainAndAgainAsItIs) {
  Prior::Settings settings;
  settings.area = {0.23, 0.23};
  const Prior prior(settings);
  for (const auto& [noise, pushes] : {std::pair(0.0, 0.0), std::pair(0.004, 0.0), std::pair(0.004, 0.2)}) {
    SamplerSettings how;
    how.particles = 300;
    how.label_error = 0.05;
    how.false_contact = 0.02;
    how.position_noise = noise;
    how.push_probability = pushes;
    Sampler belief(prior, how, Random(10, "particles test"));
    const std::vector<Touch> made = test::disc_touches(25);
    for (const Touch& touch : made) belief.add(touch);
    int primitives = 0;
    int beside = 0;
    for (const Particle& one : belief.particles()) {
      std::vector<Touch> touches = made;
      for (int i = 0; i < one.hypothesis.push.before; ++i) {
        Target& place = touches[static_cast<std::size_t>(i)].place;
        place = one.hypothesis.push.now(place);
      }
      const LabelModel labels(how.label_error, how.false_contact, one.hypothesis.noisy ? noise : 0.0);
      LogUnits loss = 0;
      for (std::size_t i = 0; i < touches.size(); ++i) {
        const Target& place = touches[i].place;
        LabelModel::Step deepest = LabelModel::kOutside;
        for (int p = 0; p < one.hypothesis.primitives.size(); ++p) {
          const LabelModel::Step kept = one.rows.row(p)[i];
          const Primitive& primitive = one.hypothesis.primitives[p];
          // Single precision may take it for the step beside it, once in some thousand.
          const LabelModel::Step step = labels.step(primitive.depth(place.x, place.y));
          ASSERT_LE(std::abs(kept - step), one.hypothesis.noisy ? 1 : 0);
          ASSERT_TRUE(one.hypothesis.noisy || LabelModel::inside(kept) == primitive.contains(place.x, place.y));
          beside += kept != step ? 1 : 0;
          deepest = std::max(deepest, kept);
        }
        loss += labels.loss(deepest, touches[i].on);
      }
      ASSERT_EQ(one.loss, loss) << "whole numbers do not drift";
      for (const Primitive& primitive : one.hypothesis.primitives) {
        ASSERT_EQ(primitive.density, prior.density(primitive));
        ASSERT_TRUE(touched(primitive, touches));
      }
      primitives += one.hypothesis.primitives.size();
    }
    EXPECT_LE(beside, 40) << "of some 20000";
    EXPECT_DOUBLE_EQ(belief.mean_primitives(), primitives / 300.0);
  }
}

/// Whether two primitives have a place in common, but for a hole: as is seen on a lattice.
bool meet(const Primitive& one, const Primitive& other, const Points& places) {
  const double distance = std::hypot(one.form.x - other.form.x, one.form.y - other.form.y);
  if (distance > radius_of(one.form) + radius_of(other.form)) return false;
  for (Eigen::Index i = 0; i < places.rows(); ++i) {
    if (one.form.contains(places(i, 0), places(i, 1)) && other.form.contains(places(i, 0), places(i, 1))) return true;
  }
  return false;
}

TEST(Sampler, ThinkAsOftenThatSomethingIsLeftAsTheDrawsDoThatAreWeighedByAllLabels) {
  constexpr double kWrong = 0.05;
  constexpr double kLong = 0.04;
  EXPECT_EQ(belief_of(10, 0, kWrong, 11).undiscovered_probability(1.0), 0.0) << "nothing is a metre long";
  // Once the desk alone, and once a thing in the middle.
  for (const bool on : {false, true}) {
    std::vector<Touch> touches;
    const Points places = test::lattice(3, 3);
    for (Eigen::Index i = 0; i < places.rows(); ++i)
      touches.push_back(test::touch_at(places(i, 0), places(i, 1), on && i == 4));
    const int runs = test::brief() ? 3 : 8;
    double found = 0.0;
    for (int run = 0; run < runs; ++run) {
      Sampler belief = belief_of(500, 40, kWrong, 20 + static_cast<std::uint64_t>(run));
      for (const Touch& touch : touches) belief.add(touch);
      found += belief.undiscovered_probability(kLong) / runs;
    }
    Prior::Settings settings;
    settings.area = {0.23, 0.23};
    const Prior prior(settings);
    Random random(12, "particles test");
    const Points fine = test::lattice(47, 47);
    double evidence = 0.0;
    double squares = 0.0;
    double left = 0.0;
    double before = 0.0;
    const int draws = test::brief() ? 20000 : 80000;
    for (int k = 0; k < draws; ++k) {
      const Hypothesis hypothesis = prior.draw(random);
      double weight = 1.0;
      for (const Touch& touch : touches)
        weight *= hypothesis.contains(touch.place.x, touch.place.y) == touch.on ? 1.0 - kWrong : kWrong;
      const auto is_long = [](const Primitive& primitive) { return 2.0 * primitive.form.a >= kLong; };
      before += std::any_of(hypothesis.primitives.begin(), hypothesis.primitives.end(), is_long) ? 1.0 / draws : 0.0;
      // Of those with little weight some are taken by lot and weigh more.
      constexpr double kLittle = 0.1;
      if (weight < kLittle && random.uniform() >= weight / kLittle) continue;
      weight = std::max(weight, kLittle);
      const auto [seen, undiscovered] = parts_of(hypothesis, touches);
      const bool any = std::any_of(
          undiscovered.primitives.begin(), undiscovered.primitives.end(),
          [&, &known = seen](const Primitive& primitive) {
            return is_long(primitive) && std::none_of(known.primitives.begin(), known.primitives.end(),
                                                      [&](const Primitive& one) { return meet(one, primitive, fine); });
          });
      evidence += weight;
      squares += weight * weight;
      left += any ? weight : 0.0;
    }
    left /= evidence;
    // What is left is counted by the touches of the desk for each primitive, not for all together: that comes to less
    // than a hundredth, as does what is not seen on the lattice.
    EXPECT_NEAR(found, left, 5.0 * std::sqrt(left * (1.0 - left) * squares) / evidence + 0.02);
    EXPECT_LT(left, before - 0.2) << "the labels say something";
  }
}

}  // namespace
}  // namespace palpate::footprints
