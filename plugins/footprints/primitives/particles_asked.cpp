// SPDX-License-Identifier: MIT
// What is asked of a set of outlines between its moves: which places are on an object, what is doubted, pushed or left.
#include "lattice.hpp"
#include "particles.hpp"

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

namespace palpate::footprints {

double Particles::mean_mistakes() const {
  double sum = 0.0;
  for (const Particle& particle : particles_) sum += particle.mistakes;
  return sum / size();
}

double Particles::mean_pieces() const {
  double sum = 0.0;
  for (const Particle& particle : particles_) sum += particle.outline.size();
  return sum / size();
}

double Particles::undiscovered_probability(double size) const { return 1.0 - math::exp(-unseen_.apart(size)); }

void Particles::doubt(VectorOut out) const {
  out.setZero();
  for (const Particle& particle : particles_) {
    if (!(particle.labels > 0.0)) continue;  // nothing speaks against it
    const LabelModel& labels = this->labels(particle.blurred);
    for (std::size_t i = 0; i < touches_.size(); ++i)
      out(static_cast<Eigen::Index>(i)) += labels.wrong(particle.depths.deepest()[i], touches_[i].on);
  }
  out /= size();
}

void Particles::current_positions(Points& places) const {
  Points sums = Points::Zero(places.rows(), 2);
  std::vector<int> counts(touches_.size(), 0);
  for (const Particle& particle : particles_) {
    for (int i = 0; i < particle.push.before; ++i) {
      const Target now = particle.push.now(touches_[static_cast<std::size_t>(i)].place);
      sums.row(i) += Eigen::RowVector2d(now.x, now.y);
      ++counts[static_cast<std::size_t>(i)];
    }
  }
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (2 * counts[i] > size()) places.row(row) = sums.row(row) / counts[i];
  }
}

Particles::Pushed Particles::pushed() const {
  Pushed out;
  for (const Particle& particle : particles_) {
    if (!particle.push) continue;
    const Form first = particle.outline.size() > 0 ? particle.outline[0].form : Form{};
    const Target then = particle.push.then({first.x, first.y});
    out.share += 1.0;
    out.before += particle.push.before;
    out.shift += math::hypot(first.x - then.x, first.y - then.y);
  }
  if (!(out.share > 0.0)) return out;
  out.before /= out.share;
  out.shift /= out.share;
  out.share /= size();
  return out;
}

LatticeBits Particles::held(const Lattice& lattice) const {
  LatticeBits out(lattice, particles_.size());
  for (const Particle& particle : particles_) out.append(particle.outline);
  out.fill();
  return out;
}

void Particles::probability(const PointsView& places, VectorOut out) {
  const std::optional<Lattice> lattice = Lattice::over(places);
  Eigen::VectorXd rates(places.rows());
  unseen_.rates(places, lattice, rates);
  if (lattice) {
    if (!held_ || !(held_->lattice() == *lattice)) held_ = held(*lattice);
    held_->count(out);
  } else {
    out.setZero();
    for (const Particle& particle : particles_) {
      for (Eigen::Index i = 0; i < out.size(); ++i)
        out(i) += particle.outline.contains(places(i, 0), places(i, 1)) ? 1.0 : 0.0;
    }
  }
  rates = -rates;
  math::exp(rates.data(), rates.size(), rates.data());  // that nothing undiscovered is there
  out = (1.0 - (1.0 - out.array() / size()) * rates.array()).cwiseMax(0.0).cwiseMin(1.0);
}

void Particles::sample(const PointsView& places, int count, OutlineSample& out) const {
  const auto words = static_cast<std::size_t>(count) / 64;
  out.count = count;
  out.holds.resize(static_cast<Eigen::Index>(words), places.rows());
  const std::optional<Lattice> lattice = Lattice::over(places);
  out.to_find.resize(places.rows());
  unseen_.to_find(places, lattice, out.to_find);
  // Words of outlines, of as many as are full.
  const auto word_of = [&](std::size_t word) { return word * (particles_.size() / 64) / words; };
  const auto known = [&](std::size_t k) -> const Outline& { return particles_[64 * word_of(k / 64) + k % 64].outline; };
  if (lattice) {
    const bool asked = held_ && held_->lattice() == *lattice;
    const std::optional<LatticeBits> now = asked ? std::nullopt : std::optional(held(*lattice));
    for (std::size_t word = 0; word < words; ++word) {
      (asked ? *held_ : *now).for_each_place(word_of(word), [&](Eigen::Index place, std::uint64_t bits) {
        out.holds(static_cast<Eigen::Index>(word), place) = bits;
      });
    }
  }
  const auto add = [&](std::size_t k, Eigen::Index place) {
    out.holds(static_cast<Eigen::Index>(k / 64), place) |= std::uint64_t{1} << (k % 64);
  };
  const auto add_held = [&](std::size_t k, const auto& piece) {
    for (Eigen::Index i = 0; i < places.rows(); ++i) {
      if (piece.contains(places(i, 0), places(i, 1))) add(k, i);
    }
  };
  if (!lattice) {
    out.holds.setZero();
    for (std::size_t k = 0; k < 64 * words; ++k) add_held(k, known(k));
  }
  Random random(touches_.size(), "sample");
  const LatticeRuns* const runs = lattice ? unseen_.runs(*lattice) : nullptr;
  for (const Unseen::Drawn& drawn : unseen_.draw(64 * words, random)) {
    // What meets nothing that is known is another thing: to_find has it.
    const Outline& outline = known(drawn.draw);
    const Piece& piece = unseen_.piece(drawn.piece);
    const auto meets = [&](const Piece& one) { return meet(one.form, piece.form); };
    if (std::none_of(outline.begin(), outline.end(), meets)) continue;
    if (!runs) {
      add_held(drawn.draw, piece);
      continue;
    }
    runs->for_each(drawn.piece, [&](const Lattice::Run& run) {
      const int row = run.begin / (lattice->columns() + 1);
      for (int at = run.begin - row; at < run.end - row; ++at) add(drawn.draw, at);
    });
  }
}

}  // namespace palpate::footprints
