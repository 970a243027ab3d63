// SPDX-License-Identifier: MIT
#include "exchange.hpp"

#include <algorithm>
#include <array>

namespace palpate::footprints {
namespace {

/// Pieces that are not farther from each other are weighed together.
constexpr double kTogether = 0.01;  // metres

bool come_near(const Form& one, const Form& other) {
  Form wide = one;
  wide.a += kTogether;
  wide.b += kTogether;
  return meet(wide, other);
}

/// The pieces of two outlines that a touch may tell of.
class Told {
 public:
  Told(const std::array<const Particle*, 2>& of, const Target& here, const LabelModel::Step* objects)
      : of_(of), objects_(objects) {
    for (std::size_t side = 0; side < 2; ++side) {
      const Outline& outline = of_[side]->outline;
      for (int i = 0; i < outline.size(); ++i) {
        if (outline[i].near(here)) add({side, i});
      }
    }
    // And, of each that is added, those that go together with it.
    for (int done = 0; done < count_; ++done) {
      const One one = list_[static_cast<std::size_t>(done)];
      for (std::size_t side = 0; side < 2; ++side) {
        for (int i = 0; i < of_[side]->outline.size(); ++i) {
          if (!has(side, i) && together(one, {side, i})) add({side, i});
        }
      }
    }
  }

  bool has(std::size_t side, int piece) const { return has_[side][static_cast<std::size_t>(piece)]; }
  int count(std::size_t side) const { return static_cast<int>(std::count(has_[side].begin(), has_[side].end(), true)); }

 private:
  struct One {
    std::size_t side;
    int piece;
  };
  void add(const One& one) {
    has_[one.side][static_cast<std::size_t>(one.piece)] = true;
    list_[static_cast<std::size_t>(count_++)] = one;
  }
  const Form& form(const One& one) const { return of_[one.side]->outline[one.piece].form; }
  const LabelModel::Step* row(const One& one) const { return of_[one.side]->depths.row(one.piece); }
  bool together(const One& one, const One& other) const {
    return come_near(form(one), form(other)) || hold_the_same(row(one), row(other), objects_, of_[0]->depths.length());
  }

  std::array<const Particle*, 2> of_;
  const LabelModel::Step* objects_;
  std::array<std::array<bool, Outline::kMost>, 2> has_{};
  std::array<One, std::size_t{2} * Outline::kMost> list_;
  int count_ = 0;
};

/// A piece with its depths takes the place of another, or comes behind the last.
void put(const Particle& from, int piece, Particle& to, int at) {
  if (at == to.outline.size()) to.outline.resize(at + 1);
  to.outline[at] = from.outline[piece];
  std::copy_n(from.depths.row(piece), from.depths.length(), to.depths.row(at));
}

}  // namespace

bool take_over(const Particle& from, const Target& here, const LabelModel::Step* objects, int most, Particle& to) {
  if (from.push || to.push || from.blurred != to.blurred) return false;
  const Told told({&from, &to}, here, objects);
  const int stay = to.outline.size() - told.count(1);
  if (stay == 0 || stay + told.count(0) > most) return false;
  int at = 0;
  for (int i = 0; i < to.outline.size(); ++i) {
    if (told.has(1, i)) continue;
    if (at != i) put(to, i, to, at);
    ++at;
  }
  to.outline.resize(at);
  for (int i = 0; i < from.outline.size(); ++i) {
    if (told.has(0, i)) put(from, i, to, at++);
  }
  deepest_of(to.depths.rows().data(), at, to.depths.length(), to.depths.deepest());
  return true;
}

}  // namespace palpate::footprints
