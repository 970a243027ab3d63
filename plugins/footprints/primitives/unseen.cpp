// SPDX-License-Identifier: MIT
#include "unseen.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace palpate::footprints {
namespace {

constexpr int kPieces = 8192;
constexpr float kNowhere = 1e6F;  // metres

}  // namespace

Unseen::Unseen(const OutlinePrior& prior, Random& random)
    : weights_(kPieces, kWhole),
      apart_(kPieces, 1.0F),
      xs_(kPieces),
      ys_(kPieces),
      radii_(kPieces),
      unit_(prior.settings().expected / (static_cast<double>(kPieces) * kWhole)),
      counted_(kPieces, 0) {
  pieces_.reserve(kPieces);
  for (int i = 0; i < kPieces; ++i) {
    const Piece& piece = pieces_.emplace_back(prior.draw_piece_or_hollow(random));
    xs_(i) = static_cast<float>(piece.form.x);
    ys_(i) = static_cast<float>(piece.form.y);
    radii_(i) = static_cast<float>(piece.form.radius() + 1e-6);  // above what rounding takes off
  }
}

std::size_t Unseen::Holding::draw(const std::vector<std::uint64_t>& reached, Random& random) {
  const auto at = static_cast<std::uint64_t>(static_cast<double>(reached.back()) * random.uniform());
  const auto one = std::upper_bound(reached.begin(), reached.end(), at) - reached.begin();
  return std::min(static_cast<std::size_t>(one), reached.size() - 1);
}

const Piece& Unseen::Holding::draw(Random& random) const { return *pieces_[draw(reached_, random)]; }

template <class Visit>
void Unseen::for_each_near(const Target& place, double reach, const Visit& visit) const {
  const auto x = static_cast<float>(place.x);
  const auto y = static_cast<float>(place.y);
  using Marks = Eigen::Array<bool, Eigen::Dynamic, 1>;
  const Marks near = (xs_ - x).square() + (ys_ - y).square() <= (radii_ + static_cast<float>(reach)).square();
  constexpr std::size_t kAtOnce = 8;  // most are not
  static_assert(kPieces % kAtOnce == 0);
  for (std::size_t from = 0; from < pieces_.size(); from += kAtOnce) {
    std::uint64_t any;
    std::memcpy(&any, near.data() + from, sizeof(any));
    for (std::size_t i = from; any != 0 && i < from + kAtOnce; ++i) {
      if (near(static_cast<Eigen::Index>(i))) visit(i);
    }
  }
}

Unseen::Holding Unseen::holding(const Target& place) const {
  Holding out;
  std::uint64_t sum = 0;
  for_each_near(place, 0.0, [&](std::size_t i) {
    if (!pieces_[i].contains(place.x, place.y)) return;
    out.pieces_.push_back(&pieces_[i]);
    out.reached_.push_back(sum += weights_[i]);
  });
  out.rate_ = unit_ * static_cast<double>(sum);
  return out;
}

void Unseen::change(std::size_t one, Weight to) {
  if (to == weights_[one]) return;
  weights_[one] = to;
  if (to == 0) xs_(static_cast<Eigen::Index>(one)) = kNowhere;
  changed_.push_back(one);
}

void Unseen::add(const Touch& touch, const LabelModel& labels) {
  const double outside = labels.probability(LabelModel::kOutside, false);
  for_each_near(touch.place, labels.reach(), [&](std::size_t i) {
    const Piece& piece = pieces_[i];
    if (touch.on) {
      if (piece.contains(touch.place.x, touch.place.y)) change(i, 0);
      return;
    }
    const double depth = piece.depth(touch.place.x, touch.place.y);
    if (depth < -labels.reach()) return;
    const double share = labels.probability(labels.step(depth), false) / outside;
    change(i, static_cast<Weight>(std::lround(weights_[i] * share)));
  });
}

void Unseen::rates(const PointsView& places, const std::optional<Lattice>& lattice, VectorOut out) {
  if (!lattice) {
    for (Eigen::Index i = 0; i < out.size(); ++i) out(i) = holding({places(i, 0), places(i, 1)}).rate();
    return;
  }
  if (!counts_ || !(counts_->lattice() == *lattice)) {
    counts_.emplace(*lattice);
    std::fill(counted_.begin(), counted_.end(), 0);
    changed_.resize(pieces_.size());
    for (std::size_t i = 0; i < changed_.size(); ++i) changed_[i] = i;
    runs_.emplace(*lattice);
    Outline outline;
    outline.add({});
    for (const Piece& piece : pieces_) {
      outline[0] = piece;
      runs_->append(outline);
    }
  }
  for (const std::size_t i : changed_) {
    if (weights_[i] == counted_[i]) continue;
    const double more = static_cast<double>(weights_[i]) - counted_[i];
    runs_->for_each(i, [&](const Lattice::Run& run) { counts_->add(run, more); });
    counted_[i] = weights_[i];
  }
  changed_.clear();
  counts_->sum(out);
  out *= unit_;
}

void Unseen::lie_apart_from(const std::vector<const Outline*>& known) {
  // Of those that are not there any more some are asked about, too, until they are many.
  const auto left =
      static_cast<std::size_t>(std::count_if(weights_.begin(), weights_.end(), [](Weight w) { return w > 0; }));
  if (there_.empty() || 5 * left < 4 * there_.size()) {
    there_.clear();
    forms_.clear();
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (weights_[i] == 0) continue;
      there_.push_back(i);
      forms_.add(pieces_[i].form);
    }
  }
  std::vector<std::uint8_t> met;
  std::vector<std::uint8_t> times;  // that each meets an outline
  for (const Outline* outline : known) {
    for (int i = 0; i < outline->size(); ++i) forms_.mark_met((*outline)[i].form, i > 0, met);
    if (outline->size() > 0) Forms::count_met(met, times);
  }
  times.resize(std::max(times.size(), there_.size()), 0);
  const auto all = static_cast<float>(known.size());
  for (std::size_t k = 0; k < there_.size(); ++k) apart_[there_[k]] = (all - static_cast<float>(times[k])) / all;
}

double Unseen::apart(double size) const {
  double sum = 0.0;
  for_each([&](const Piece& piece, double expected, double apart) {
    sum += 2.0 * piece.form.a >= size ? expected * apart : 0.0;
  });
  return sum;
}

void Unseen::to_find(const PointsView& places, const std::optional<Lattice>& lattice, VectorOut out) const {
  std::optional<LatticeCounts> counts;
  if (lattice) counts.emplace(*lattice);
  const LatticeRuns* const known = lattice ? runs(*lattice) : nullptr;
  out.setZero();
  Outline outline;
  outline.add({});
  constexpr int kOneIn = 2;  // is asked
  int next = 0;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    if (weights_[i] == 0 || next++ % kOneIn != 0 || !(apart_[i] > 0.0F)) continue;
    const Piece& piece = pieces_[i];
    const double extent = kOneIn * expected(i) * static_cast<double>(apart_[i]) * piece.form.extent();
    if (known) {
      known->for_each(i, [&](const Lattice::Run& run) { counts->add(run, extent); });
      continue;
    }
    outline[0] = piece;
    if (counts) {
      counts->add(outline, extent);
      continue;
    }
    for (Eigen::Index k = 0; k < out.size(); ++k) out(k) += outline.contains(places(k, 0), places(k, 1)) ? extent : 0.0;
  }
  if (counts) counts->sum(out);
  out = out.cwiseMax(0.0);  // sums of both signs leave some rounding where there is nothing
}

std::vector<Unseen::Drawn> Unseen::draw(std::size_t count, Random& random) const {
  std::vector<std::uint64_t> reached;
  reached.reserve(pieces_.size());
  std::uint64_t sum = 0;
  for (const Weight weight : weights_) reached.push_back(sum += weight);
  std::vector<Drawn> out;
  // Poisson: as many as fit into a unit of time.
  const double time = unit_ * static_cast<double>(sum);
  const auto pause = [&] { return -math::log(1.0 - random.uniform()); };
  for (std::size_t one = 0; one < count; ++one) {
    for (double at = pause(); at < time; at += pause()) out.push_back({one, Holding::draw(reached, random)});
  }
  return out;
}

}  // namespace palpate::footprints
