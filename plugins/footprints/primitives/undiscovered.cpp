// SPDX-License-Identifier: MIT
#include "undiscovered.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>

namespace palpate::footprints {
namespace {

constexpr int kDraws = 8192;

/// Draws an index with probability proportional to its weight, from cumulative weights.
std::size_t draw_index(const std::vector<std::uint64_t>& cumulative, Random& random) {
  const auto at = static_cast<std::uint64_t>(static_cast<double>(cumulative.back()) * random.uniform());
  const auto index = std::upper_bound(cumulative.begin(), cumulative.end(), at) - cumulative.begin();
  return std::min(static_cast<std::size_t>(index), cumulative.size() - 1);
}

}  // namespace

UndiscoveredPrimitives::UndiscoveredPrimitives(const Prior& prior, Random& random)
    : unit_(prior.settings().expected / (static_cast<double>(kDraws) * kWhole)) {
  draws_.reserve(kDraws);
  for (int i = 0; i < kDraws; ++i) draws_.push_back({prior.draw_primitive(random), kWhole, {}});
  update();
}

void UndiscoveredPrimitives::update() {
  draws_.erase(std::remove_if(draws_.begin(), draws_.end(), [](const Draw& one) { return one.weight == 0; }),
               draws_.end());
  std::vector<const Form*> forms;
  for (const Draw& one : draws_) forms.push_back(&one.primitive.form);
  forms_.set(forms);
  overlaps_.assign(forms_.x.size(), 0.0F);
  known_ = 1;
}

template <class Draws, class Visit>
void UndiscoveredPrimitives::for_each_near(Draws& draws, const Target& position, double reach,
                                           const Visit& visit) const {
  const auto x = static_cast<float>(position.x);
  const auto y = static_cast<float>(position.y);
  const auto margin = static_cast<float>(reach * reach);
  std::vector<std::uint8_t> near(draws.size());
  for (std::size_t i = 0; i < near.size(); ++i) {
    const float dx = forms_.x[i] - x;
    const float dy = forms_.y[i] - y;
    // 2 * (radius^2 + reach^2) is at least (radius + reach)^2.
    near[i] = dx * dx + dy * dy <= 2.0F * (forms_.a[i] * forms_.a[i] + forms_.b[i] * forms_.b[i] + margin);
  }
  for (auto one = near.begin(); (one = std::find(one, near.end(), 1)) != near.end(); ++one)
    visit(draws[static_cast<std::size_t>(one - near.begin())]);
}

const Primitive& UndiscoveredPrimitives::CoveringDraws::draw(Random& random) const {
  return *primitives_[draw_index(cumulative_, random)];
}

UndiscoveredPrimitives::CoveringDraws UndiscoveredPrimitives::covering(const Target& position) const {
  CoveringDraws out;
  std::uint64_t sum = 0;
  for_each_near(draws_, position, 0.0, [&](const Draw& one) {
    if (!one.primitive.contains(position.x, position.y)) return;
    out.primitives_.push_back(&one.primitive);
    out.cumulative_.push_back(sum += one.weight);
  });
  out.rate_ = unit_ * static_cast<double>(sum);
  return out;
}

void UndiscoveredPrimitives::change(Draw& draw, Weight to) {
  const std::int64_t more = std::int64_t{to} - std::int64_t{draw.weight};
  draw.weight = to;
  rates_.add(draw.spans, more);
}

void UndiscoveredPrimitives::add(const Touch& touch, const LabelModel& labels) {
  const Target& place = touch.place;
  const double outside = labels.probability(LabelModel::kOutside, false);
  bool any_gone = false;
  for_each_near(draws_, place, labels.reach(), [&](Draw& one) {
    Weight to = one.weight;
    if (touch.on) {
      if (one.primitive.contains(place.x, place.y)) to = 0;
    } else {
      const LabelModel::Step step = labels.step(one.primitive.depth(place.x, place.y));
      to = static_cast<Weight>(std::lround(one.weight * (labels.probability(step, false) / outside)));
    }
    if (to != one.weight) change(one, to);
    any_gone = any_gone || to == 0;
  });
  if (any_gone) update();
}

bool UndiscoveredPrimitives::prepare(const PointsView& positions) {
  if (grid_ && grid_->matches(positions)) return false;
  grid_.emplace(positions);
  rates_ = GridSums(grid_->size());
  for (Draw& one : draws_) {
    one.spans.clear();
    grid_->add_spans(one.primitive, one.spans);
    rates_.add(one.spans, one.weight);
  }
  return true;
}

Eigen::VectorXd UndiscoveredPrimitives::expected_extent() const {
  // units per square metre; areas are rounded to units so that sums are exact integers
  constexpr double kExtentUnits = 0x1p24;
  GridSums sums(grid_->size());
  for (std::size_t i = 0; i < draws_.size(); i += 2) {
    const Draw& one = draws_[i];
    const std::int64_t value = std::llround(kExtentUnits * one.primitive.form.extent()) * one.weight * apart(i);
    if (value != 0) sums.add(one.spans, value);
  }
  return sums.values(2.0 * unit_ / (kExtentUnits * static_cast<double>(known_)));
}

void UndiscoveredPrimitives::compare(const std::vector<const Hypothesis*>& known) {
  known_ = static_cast<std::int64_t>(known.size());
  std::fill(overlaps_.begin(), overlaps_.end(), 0.0F);
  for (const Hypothesis* one : known) count_overlaps(*one, forms_, overlaps_.data());
}

double UndiscoveredPrimitives::expected_apart(double length) const {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < draws_.size(); ++i) {
    if (2.0 * draws_[i].primitive.form.a >= length) sum += draws_[i].weight * apart(i);
  }
  return unit_ * static_cast<double>(sum) / static_cast<double>(known_);
}

std::vector<UndiscoveredPrimitives::Member> UndiscoveredPrimitives::draw(int count, Random& random) const {
  std::vector<std::uint64_t> cumulative;
  cumulative.reserve(draws_.size());
  std::uint64_t sum = 0;
  for (const Draw& one : draws_) cumulative.push_back(sum += one.weight);
  // The number of members has a Poisson distribution: it is the number of events of rate 1 within the time `rate`.
  const double rate = unit_ * static_cast<double>(sum);
  const auto pause = [&] { return -math::log(1.0 - random.uniform()); };
  std::vector<Member> out;
  for (int set = 0; set < count; ++set) {
    double time = pause();
    for (; time < rate; time += pause()) out.push_back({set, &draws_[draw_index(cumulative, random)].primitive});
  }
  return out;
}

}  // namespace palpate::footprints
