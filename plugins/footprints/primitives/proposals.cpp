// SPDX-License-Identifier: MIT
#include "proposals.hpp"

#include "steps.hpp"

#include <palpate/math.hpp>

#include <cmath>
#include <cstdint>
#include <cstring>

namespace palpate::footprints {
namespace {

// Greatest steps.
constexpr double kShift = 0.05;   // metres
constexpr double kTurn = 0.6;     // tangent of half an angle
constexpr double kStretch = 0.3;  // see stretch()
constexpr double kShare = 0.2;    // of a form's axes, for a fitted hole

constexpr double kNear = 0.03;  // metres: standard deviation, along x and y, of a new piece from a wrong label

// How much more often a piece at the latest touch is moved than another.
constexpr double kHere = 30.0;

double wish_to_move(const Piece& piece, const Target& here) { return piece.near(here) ? kHere : 1.0; }

/// Which piece is moved.
class Choice {
 public:
  Choice(const Outline& outline, const Target& here, Random& random) {
    if (outline.size() == 1) return;
    std::array<double, Outline::kMost> wishes;
    for (int i = 0; i < outline.size(); ++i)
      sum_ += wishes[static_cast<std::size_t>(i)] = wish_to_move(outline[i], here);
    double left = random.uniform();
    for (; one_ + 1 < outline.size(); ++one_) {
      if ((left -= wishes[static_cast<std::size_t>(one_)] / sum_) < 0.0) break;
    }
    wish_ = wishes[static_cast<std::size_t>(one_)];
  }

  int one() const { return one_; }
  /// How much more probable this choice is where that piece has become another.
  double correction(const Piece& other, const Target& here) const {
    if (!(sum_ > 0.0)) return 1.0;
    const double wish = wish_to_move(other, here);
    return (wish / (sum_ - wish_ + wish)) / (wish_ / sum_);
  }

 private:
  int one_ = 0;
  double sum_ = 0.0;  ///< of the wishes: whole numbers
  double wish_ = 0.0;
};

// Both without a function of the library, and as probable as the way back, which has the other sign.
void turn(Form& form, double tangent) {
  const double square = tangent * tangent;
  form.turn_by((1.0 - square) / (1.0 + square), 2.0 * tangent / (1.0 + square));
}
double stretch(double step) { return (1.0 + step) / (1.0 - step); }

/// Moves a side and leaves the one across from it; the axes are to be put in order. Returns the correction: even steps
/// in the length of a half axis are uneven ones in its logarithm.
double move_side(Form& form, const Steps& steps) {
  const bool along = steps.heads;
  double& half = along ? form.a : form.b;
  const double before = half;
  const double change = 0.5 * kShift * steps.one;
  half += change;
  if (half <= 0.0) return 0.0;
  const double side = steps.also_heads ? change : -change;
  form.x += side * (along ? form.cosine : -form.sine);
  form.y += side * (along ? form.sine : form.cosine);
  return before / half;
}

void change_family(Form& form) {
  constexpr double kSameExtent = 1.1283791670955126;  // an ellipse as large as a box is longer by this
  const bool box = form.family == Form::Family::box;
  form.family = box ? Form::Family::ellipse : Form::Family::box;
  form.a *= box ? kSameExtent : 1.0 / kSameExtent;
  form.b *= box ? kSameExtent : 1.0 / kSameExtent;
}

/// Anywhere in a form.
Target somewhere_in(const Form& form, Random& random) {
  double u, v;
  do {
    u = 2.0 * random.uniform() - 1.0;
    v = 2.0 * random.uniform() - 1.0;
  } while (form.family == Form::Family::ellipse && u * u + v * v > 1.0);
  return {form.x + form.cosine * u * form.a - form.sine * v * form.b,
          form.y + form.sine * u * form.a + form.cosine * v * form.b};
}

/// The density of a centre that is drawn about one of these places.
double density_near(const std::vector<Target>& near, const Form& form) {
  double sum = 0.0;
  for (const Target& place : near) {
    const double dx = (form.x - place.x) / kNear;
    const double dy = (form.y - place.y) / kNear;
    sum += math::exp(-0.5 * (dx * dx + dy * dy));
  }
  return sum / (2.0 * kPi * kNear * kNear * static_cast<double>(near.size()));
}

/// How much more often the prior has the centre than it is proposed.
double correction_near(double by_prior, const std::vector<Target>& near, const Form& form) {
  if (near.empty()) return 1.0;
  return by_prior / (0.5 * by_prior + 0.5 * density_near(near, form));
}

void draw_near(Form& form, const std::vector<Target>& near, Random& random) {
  if (near.empty() || random.uniform() < 0.5) return;
  const Target& place = near[random.index(near.size())];
  form.x = place.x + kNear * normal(random);
  form.y = place.y + kNear * normal(random);
}

/// Which touches a form contains, by bytes of all bits.
const LabelModel::Step* held_by(const Form& form, const Seen& seen, Proposal& out) {
  out.held.resize(static_cast<std::size_t>(seen.places.length()));
  seen.places.contained(form, out.held.data());
  return out.held.data();
}

std::uint64_t word_of(const LabelModel::Step* row, int from) {
  std::uint64_t out;
  std::memcpy(&out, row + from, sizeof(out));
  return out;
}

/// How many bytes of a word have all bits, where the others have none.
int count_of(std::uint64_t word) {
  constexpr std::uint64_t kOnes = 0x0101010101010101;
  return static_cast<int>((word & kOnes) * kOnes >> 56U);
}

/// The density of a centre so that a touch of an object, any of them, lies anywhere in the form: per square metre.
double density_about_touches(const Seen& seen, const Form& form, Proposal& out) {
  const LabelModel::Step* const row = held_by(form, seen, out);
  int held = 0;
  for (int from = 0; from < seen.places.length(); from += Places::kWord)
    held += count_of(word_of(row, from) & word_of(seen.objects, from));
  return held / (seen.of_objects * form.extent());
}

/// How much more often the prior has the centre of a form than it is drawn about a touch.
double correction_about(const Seen& seen, const OutlinePrior& prior, const Form& form, Proposal& out) {
  const double drawn = density_about_touches(seen, form, out);
  return drawn > 0.0 ? prior.centre_density(form) / drawn : 0.0;
}

/// A piece without a hole about a touch of an object; false where there is none.
bool draw_about(Piece& out, const Seen& seen, const OutlinePrior& prior, Random& random) {
  if (seen.of_objects == 0) return false;
  auto before = static_cast<int>(random.index(static_cast<std::size_t>(seen.of_objects)));
  int number = 0;
  for (int count; before >= (count = count_of(word_of(seen.objects, number))); number += Places::kWord) before -= count;
  while (seen.objects[number] == 0 || before-- > 0) ++number;
  out = prior.draw_piece(random);
  const Target place = seen.places[number];
  Form about = out.form;
  about.x = place.x;
  about.y = place.y;
  const Target centre = somewhere_in(about, random);
  out.form.x = centre.x;
  out.form.y = centre.y;
  out.density = prior.density(out);
  return out.density > 0.0;
}

/// Touches of the desk within a form.
const std::vector<Target>& wrongly_held(const Seen& seen, const Form& form, Proposal& out) {
  const LabelModel::Step* const row = held_by(form, seen, out);
  out.near.clear();
  for (int from = 0; from < seen.places.length(); from += Places::kWord) {
    for (std::uint64_t left = word_of(row, from) & ~word_of(seen.objects, from); left != 0;) {
      const int byte = __builtin_ctzll(left) / 8;
      left &= ~(std::uint64_t{0xFF} << (8 * byte));
      out.near.push_back(seen.places[from + byte]);
    }
  }
  return out.near;
}

void add_piece(Proposal& out, const OutlinePrior& prior, const Seen& seen, Random& random) {
  const int pieces = out.outline.size();
  if (pieces >= prior.settings().most) return;
  Piece piece;
  if (!draw_about(piece, seen, prior, random)) return;
  // Pieces with a hole come by way of a piece without.
  out.correction = prior.settings().expected / (pieces + 1) * prior.whole(piece.form) *
                   correction_about(seen, prior, piece.form, out);
  out.add(piece);
}

void remove_piece(Proposal& out, const OutlinePrior& prior, const Seen& seen, Random& random) {
  const int pieces = out.outline.size();
  if (pieces == 0) return;
  const int one = static_cast<int>(random.index(static_cast<std::size_t>(pieces)));
  const Piece piece = out.outline[one];
  if (piece.hollow) return;
  const double way_back = prior.whole(piece.form) * correction_about(seen, prior, piece.form, out);
  if (!(way_back > 0.0)) return;
  out.correction = pieces / (prior.settings().expected * way_back);
  out.remove(one);
}

void change_hole(Proposal& out, bool adds, const OutlinePrior& prior, const Seen& seen, Random& random) {
  const int pieces = out.outline.size();
  if (pieces == 0) return;
  const int one = static_cast<int>(random.index(static_cast<std::size_t>(pieces)));
  Piece& piece = out.outline[one];
  if (piece.hollow == adds || piece.form.a < prior.settings().smallest) return;
  const std::vector<Target>& near = wrongly_held(seen, piece.form, out);
  out.changes(one);
  if (adds) {
    prior.draw_hole(piece, random);
    if (piece.fit == Piece::Fit::free) draw_near(piece.hole, near, random);
  }
  double correction = prior.settings().hollow / (1.0 - prior.settings().hollow);
  if (piece.fit == Piece::Fit::free) {
    const double by_prior = prior.hole_centre_density(piece.form, piece.hole);
    if (!(by_prior > 0.0)) return;
    correction *= correction_near(by_prior, near, piece.hole);
  }
  out.correction = adds ? correction : 1.0 / correction;
  piece.hollow = adds;
  piece.density = prior.density(piece);
}

/// Stretches a form; an ellipse one time in two so that a round one stays round.
void stretch(Form& form, const Steps& steps) {
  const double one = stretch(kStretch * steps.one);
  form.a *= one;
  form.b *= form.family == Form::Family::ellipse && steps.heads ? one : stretch(kStretch * steps.other);
}

/// A fitted hole takes more or less, or may be at another corner.
void move_fitted(Piece& piece, double which, const Steps& steps) {
  constexpr double kOtherCorner = 0.05;
  piece.along += kShare * steps.one;
  if (piece.fit != Piece::Fit::corner) return;
  piece.across += kShare * steps.other;
  if (which < kOtherCorner) (steps.heads ? piece.side_a : piece.side_b) *= -1;
}

/// Moves the form of a piece, or its hole, or both. Returns the correction, but for the prior.
double move_part(Piece& piece, bool of_form, bool both, double which, const Steps& steps) {
  Form& form = of_form ? piece.form : piece.hole;
  double correction = 1.0;
  if (which < 0.38) {
    const double dx = kShift * steps.one;
    const double dy = kShift * steps.other;
    form.x += dx;
    form.y += dy;
    if (both) {
      piece.form.x += dx;
      piece.form.y += dy;
    }
  } else if (which < 0.59) {
    turn(form, kTurn * steps.one);
  } else if (which < 0.78) {
    stretch(form, steps);
  } else if (which < 0.965) {
    correction = move_side(form, steps);
  } else {
    change_family(form);
  }
  if (of_form) {
    piece.order_axes();
  } else {
    form.order_axes();
  }
  return correction;
}

/// Moves a form, or the hole in it, or both.
void change_form(Proposal& out, const OutlinePrior& prior, const Target& here, double which, Random& random) {
  if (out.outline.size() == 0) return;
  const Choice choice(out.outline, here, random);
  Piece& piece = out.outline[choice.one()];
  const double before = piece.density;
  out.changes(choice.one());
  const double target = piece.hollow ? random.uniform() : 0.0;
  const Steps steps(random);
  if (piece.fitted() && target > 0.6) {
    move_fitted(piece, which, steps);
    out.correction = 1.0;
  } else {
    out.correction = move_part(piece, piece.fitted() || target<0.5, target> 0.8, which, steps);
  }
  piece.fit_hole();
  piece.density = out.correction > 0.0 ? prior.density(piece) : 0.0;
  out.correction *= piece.density / before * choice.correction(piece, here);
}

/// Takes a new piece for one of them.
void replace(Proposal& out, const OutlinePrior& prior, const Seen& seen, Random& random) {
  const int pieces = out.outline.size();
  if (pieces == 0) return;
  const int one = static_cast<int>(random.index(static_cast<std::size_t>(pieces)));
  Piece& piece = out.outline[one];
  if (piece.hollow) return;
  const double before = prior.whole(piece.form) * correction_about(seen, prior, piece.form, out);
  out.changes(one);
  if (!(before > 0.0) || !draw_about(piece, seen, prior, random)) return;
  out.correction = prior.whole(piece.form) * correction_about(seen, prior, piece.form, out) / before;
}

// Shares of the moves that are not of a form. What leads there is proposed as often as what leads back.
constexpr double kAddOrRemove = 0.03;  // each
constexpr double kHoleOrFill = 0.04;
constexpr double kSplitOrMerge = 0.005;
constexpr double kReplace = 0.01;
constexpr double kOthers = 2.0 * (kAddOrRemove + kHoleOrFill + kSplitOrMerge) + kReplace;  // in sum

}  // namespace

void propose(Proposal& out, const OutlinePrior& prior, const Seen& seen, double which, Random& random) {
  using Kind = Proposal::Kind;
  if (which >= kOthers) {
    out.kind = Kind::change_form;
    const int touches = seen.places.size();
    const Target here = touches == 0 ? Target{} : seen.places[touches - 1];
    return change_form(out, prior, here, (which - kOthers) / (1.0 - kOthers), random);
  }
  const auto falls = [&](Kind kind, double share) {
    out.kind = kind;
    return (which -= share) < 0.0;
  };
  if (falls(Kind::replace, kReplace)) return replace(out, prior, seen, random);
  if (falls(Kind::add, kAddOrRemove)) return add_piece(out, prior, seen, random);
  if (falls(Kind::remove, kAddOrRemove)) return remove_piece(out, prior, seen, random);
  if (falls(Kind::make_hole, kHoleOrFill)) return change_hole(out, true, prior, seen, random);
  if (falls(Kind::fill_hole, kHoleOrFill)) return change_hole(out, false, prior, seen, random);
  if (falls(Kind::split, kSplitOrMerge)) return propose_split(out, prior, random);
  out.kind = Kind::merge;
  propose_merge(out, prior, random);
}

}  // namespace palpate::footprints
