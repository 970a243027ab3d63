// SPDX-License-Identifier: MIT
#include "proposals.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpate::footprints {
namespace {

// Greatest steps; each is made smaller by a factor down to a thirtieth, for posteriors of all widths.
constexpr double kShift = 0.07;   // metres
constexpr double kTurn = 1.4;     // radians
constexpr double kStretch = 0.9;  // of a logarithm
constexpr int kScales = 16;

/// Factors of the steps, their logarithms evenly spaced: a look-up is quicker than a power.
double some_scale(Random& random) {
  static const std::array<double, kScales> scales = [] {
    std::array<double, kScales> out{};
    for (int i = 0; i < kScales; ++i) out[static_cast<std::size_t>(i)] = std::pow(1.0 / 30.0, i / (kScales - 1.0));
    return out;
  }();
  return scales[static_cast<std::size_t>(random.bits() % kScales)];
}

constexpr double kNear = 0.03;  // metres: standard deviation, along x and y, of a new piece from a wrong label

/// Standard normal (Box and Muller 1958).
double normal(Random& random) {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  return radius * std::cos(2.0 * kPi * random.uniform());
}

/// Its density.
double normal_density(double deviation, double scale) {
  const double x = deviation / scale;
  return std::exp(-0.5 * x * x) / (scale * std::sqrt(2.0 * kPi));
}

/// Uniform in (-1, 1]: as good as a normal step where steps are of all sizes anyway, and quicker.
double either_way(Random& random) { return 1.0 - 2.0 * random.uniform(); }

void changes_about(Proposal& proposal, const Form& form) {
  proposal.circles[static_cast<std::size_t>(proposal.changed++)] = {form.x, form.y, form.radius()};
}

// How much more often a piece at the latest touch is moved than another.
constexpr double kHere = 30.0;

double wish_to_move(const Piece& piece, const Target& here) {
  constexpr double kMargin = 0.03;  // metres
  const double reach = piece.form.radius() + kMargin;
  const double dx = here.x - piece.form.x;
  const double dy = here.y - piece.form.y;
  return dx * dx + dy * dy <= reach * reach ? kHere : 1.0;
}

/// How probable it is that this piece is the one that is moved.
double choice_of(const Outline& outline, int one, const Target& here) {
  if (outline.size() == 1) return 1.0;
  double sum = 0.0;
  for (const Piece& piece : outline) sum += wish_to_move(piece, here);
  return wish_to_move(outline[one], here) / sum;
}

int choose(const Outline& outline, const Target& here, Random& random) {
  if (outline.size() == 1) return 0;
  double left = random.uniform();
  for (int i = 0; i + 1 < outline.size(); ++i) {
    if ((left -= choice_of(outline, i, here)) < 0.0) return i;
  }
  return outline.size() - 1;
}

/// Moves a side and leaves the one across from it. Returns the correction: even steps in the length of a half axis are
/// uneven ones in its logarithm.
double move_side(Form& form, double scale, Random& random) {
  const bool along = random.uniform() < 0.5;
  double& half = along ? form.a : form.b;
  const double before = half;
  const double change = 0.5 * kShift * scale * either_way(random);
  half += change;
  if (half <= 0.0) return 0.0;
  const double side = random.uniform() < 0.5 ? change : -change;
  form.x += side * (along ? form.cosine : -form.sine);
  form.y += side * (along ? form.sine : form.cosine);
  const double correction = before / half;
  form.order_axes();
  return correction;
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
    sum += std::exp(-0.5 * (dx * dx + dy * dy));
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

/// Where a touch is seen by a state.
Target seen_from(const State& state, const std::vector<Touch>& touches, std::size_t touch) {
  const Target& place = touches[touch].place;
  return static_cast<int>(touch) < state.push.before ? state.push.now(place) : place;
}

/// The density of a centre so that a touch of an object, any of them, lies anywhere in the form: per square metre.
double density_about_touches(const State& state, const Seen& seen, const Form& form) {
  int all = 0;
  int held = 0;
  for (std::size_t i = 0; i < seen.touches->size(); ++i) {
    if (!(*seen.touches)[i].on) continue;
    ++all;
    const Target place = seen_from(state, *seen.touches, i);
    held += form.contains(place.x, place.y) ? 1 : 0;
  }
  return held / (all * form.extent());
}

/// How much more often the prior has the centre of a form than it is drawn about a touch.
double correction_about(const State& state, const OutlinePrior& prior, const Seen& seen, const Form& form) {
  const double drawn = density_about_touches(state, seen, form);
  return drawn > 0.0 ? prior.centre_density(form) / drawn : 0.0;
}

/// A piece without a hole about a touch of an object; false where there is none.
bool draw_about(Piece& out, const State& state, const OutlinePrior& prior, const Seen& seen, Random& random) {
  std::size_t all = 0;
  for (const Touch& touch : *seen.touches) all += touch.on ? 1 : 0;
  if (all == 0) return false;
  std::size_t one = random.index(all);
  std::size_t number = 0;
  for (;; ++number) {
    if ((*seen.touches)[number].on && one-- == 0) break;
  }
  out = prior.draw_piece(random);
  const Target place = seen_from(state, *seen.touches, number);
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
std::vector<Target> wrongly_held(const State& state, const Seen& seen, const Form& form) {
  std::vector<Target> out;
  for (std::size_t i = 0; i < seen.touches->size(); ++i) {
    if ((*seen.touches)[i].on) continue;
    const Target place = seen_from(state, *seen.touches, i);
    if (form.contains(place.x, place.y)) out.push_back(place);
  }
  return out;
}

void add_piece(Proposal& out, const OutlinePrior& prior, const Seen& seen, Random& random) {
  const int pieces = out.outline.size();
  if (pieces >= prior.settings().most) return;
  Piece piece;
  if (!draw_about(piece, out, prior, seen, random)) return;
  // Pieces with a hole come by way of a piece without.
  out.correction = prior.settings().expected / (pieces + 1) * prior.whole(piece.form) *
                   correction_about(out, prior, seen, piece.form);
  out.outline.add(piece);
  changes_about(out, piece.form);
}

void remove_piece(Proposal& out, const OutlinePrior& prior, const Seen& seen, Random& random) {
  const int pieces = out.outline.size();
  if (pieces == 0) return;
  const int one = static_cast<int>(random.index(static_cast<std::size_t>(pieces)));
  const Piece piece = out.outline[one];
  if (piece.hollow) return;
  const double way_back = prior.whole(piece.form) * correction_about(out, prior, seen, piece.form);
  if (!(way_back > 0.0)) return;
  out.correction = pieces / (prior.settings().expected * way_back);
  changes_about(out, piece.form);
  if (one != pieces - 1) changes_about(out, out.outline[pieces - 1].form);
  out.outline.remove(one);
}

void change_hole(Proposal& out, bool adds, const OutlinePrior& prior, const Seen& seen, Random& random) {
  const int pieces = out.outline.size();
  if (pieces == 0) return;
  Piece& piece = out.outline[static_cast<int>(random.index(static_cast<std::size_t>(pieces)))];
  if (piece.hollow == adds || piece.form.a < prior.settings().smallest) return;
  const std::vector<Target> near = wrongly_held(out, seen, piece.form);
  if (adds) {
    piece.hole = prior.draw_hole(piece.form, random);
    draw_near(piece.hole, near, random);
  }
  const double odds = prior.settings().hollow / (1.0 - prior.settings().hollow);
  const double by_prior = prior.hole_centre_density(piece.form, piece.hole);
  if (!(by_prior > 0.0)) return;
  const double correction = odds * correction_near(by_prior, near, piece.hole);
  out.correction = adds ? correction : 1.0 / correction;
  changes_about(out, piece.form);
  piece.hollow = adds;
  piece.density = prior.density(piece);
}

/// A form drawn about another, family by the prior.
class About {
 public:
  explicit About(const Form& fit) : fit_(fit), shift_(0.25 * std::sqrt(fit.a * fit.b)) {}

  Form draw(const OutlinePrior& prior, Random& random) const {
    Form out = fit_;
    out.family = random.uniform() < prior.settings().ellipses ? Form::Family::ellipse : Form::Family::box;
    out.x += shift_ * normal(random);
    out.y += shift_ * normal(random);
    out.a *= std::exp(kSize * normal(random));
    out.b *= std::exp(kSize * normal(random));
    out.turn(kAngle * normal(random));
    return out;
  }

  /// In centre, angle and logarithms of the half axes. Those whose half axes are not in order are never taken.
  double density(const OutlinePrior& prior, const Form& form) const {
    const double sine = fit_.cosine * form.sine - fit_.sine * form.cosine;
    const double cosine = fit_.cosine * form.cosine + fit_.sine * form.sine;
    const double angle = std::atan(sine / cosine);  // directions have no sign
    const double family =
        form.family == Form::Family::ellipse ? prior.settings().ellipses : 1.0 - prior.settings().ellipses;
    return family * normal_density(form.x - fit_.x, shift_) * normal_density(form.y - fit_.y, shift_) *
           normal_density(std::log(form.a / fit_.a), kSize) * normal_density(std::log(form.b / fit_.b), kSize) *
           (normal_density(angle, kAngle) + normal_density(std::abs(angle) - kPi, kAngle));
  }

 private:
  static constexpr double kSize = 0.3;
  static constexpr double kAngle = 0.3;  // radians
  Form fit_;
  double shift_;
};

/// The halves, or unequal parts, of a form that is cut across one of its axes; the ways to do so are equally probable.
constexpr int kCuts = 12;
std::pair<Form, Form> cut(const Form& form, int way) {
  constexpr std::array<double, 3> kShares{0.3, 0.5, 0.7};
  const double share = kShares[static_cast<std::size_t>(way % 3)];
  const bool along = (way / 3) % 2 == 0;
  const double sign = way / 6 == 0 ? 1.0 : -1.0;  // so that the two may be named either way round
  std::pair<Form, Form> out(form, form);
  const double half = along ? form.a : form.b;
  const double dx = sign * (along ? form.cosine : -form.sine);
  const double dy = sign * (along ? form.sine : form.cosine);
  const auto part = [&](Form& one, double size, double at) {
    (along ? one.a : one.b) = half * size;
    one.x += dx * half * at;
    one.y += dy * half * at;
    one.order_axes();
  };
  part(out.first, share, -(1.0 - share));
  part(out.second, 1.0 - share, share);
  return out;
}

/// A form with the extent and the moments of two: of two halves the whole.
Form joined(const Form& first, const Form& second) {
  const double of_first = first.extent();
  const double of_second = second.extent();
  const double share = of_first / (of_first + of_second);
  Form out;
  out.x = share * first.x + (1.0 - share) * second.x;
  out.y = share * first.y + (1.0 - share) * second.y;
  double xx = 0.0, xy = 0.0, yy = 0.0;
  const auto add = [&](const Form& form, double weight) {
    const double of = form.family == Form::Family::box ? 1.0 / 3.0 : 0.25;
    const double aa = of * form.a * form.a;
    const double bb = of * form.b * form.b;
    const double dx = form.x - out.x;
    const double dy = form.y - out.y;
    xx += weight * (aa * form.cosine * form.cosine + bb * form.sine * form.sine + dx * dx);
    yy += weight * (aa * form.sine * form.sine + bb * form.cosine * form.cosine + dy * dy);
    xy += weight * ((aa - bb) * form.sine * form.cosine + dx * dy);
  };
  add(first, share);
  add(second, 1.0 - share);
  const double middle = 0.5 * (xx + yy);
  const double spread = std::hypot(0.5 * (xx - yy), xy);
  out.a = std::sqrt(3.0 * (middle + spread));
  out.b = std::sqrt(3.0 * std::max(middle - spread, 0.0));
  out.turn(0.5 * std::atan2(2.0 * xy, xx - yy));
  return out;
}

/// How probable it is that two of the pieces are those that are merged: one of them is any, the other near it.
double choice_of_pair(const Outline& outline, int first, int second) {
  constexpr double kClose = 0.05;  // metres
  const auto wish = [&](int a, int b) {
    return std::exp(-std::hypot(outline[a].form.x - outline[b].form.x, outline[a].form.y - outline[b].form.y) / kClose);
  };
  const auto given = [&](int a, int b) {
    double sum = 0.0;
    for (int i = 0; i < outline.size(); ++i) sum += i == a ? 0.0 : wish(a, i);
    return wish(a, b) / sum;
  };
  return (given(first, second) + given(second, first)) / outline.size();
}

std::pair<int, int> choose_pair(const Outline& outline, Random& random) {
  double left = random.uniform();
  std::pair<int, int> out;
  for (int i = 0; i < outline.size(); ++i) {
    for (int k = 0; k < i; ++k) {
      out = {k, i};
      if ((left -= choice_of_pair(outline, k, i)) < 0.0) return out;
    }
  }
  return out;
}

/// The density of two parts, whichever comes first, as split() draws them.
double density_of_split(const OutlinePrior& prior, const Form& whole, const Form& first, const Form& second) {
  double out = 0.0;
  for (int way = 0; way < kCuts; ++way) {
    const auto [a, b] = cut(whole, way);
    out += About(a).density(prior, first) * About(b).density(prior, second);
  }
  return 2.0 * out / kCuts;
}

/// Of `pieces` forms one more.
double correction_of_split(const OutlinePrior& prior, const Outline& split, std::pair<int, int> parts,
                           const Piece& whole, int pieces) {
  const Piece& first = split[parts.first];
  const Piece& second = split[parts.second];
  const double way_there = density_of_split(prior, whole.form, first.form, second.form) / pieces;
  const double way_back = choice_of_pair(split, parts.first, parts.second) *
                          About(joined(first.form, second.form)).density(prior, whole.form);
  return prior.settings().expected * first.density * second.density / whole.density * way_back / way_there;
}

bool in_order(const Form& form) { return form.b <= form.a; }

void split(Proposal& out, const OutlinePrior& prior, Random& random) {
  const int pieces = out.outline.size();
  if (pieces == 0 || pieces >= prior.settings().most) return;
  const int one = static_cast<int>(random.index(static_cast<std::size_t>(pieces)));
  const Piece whole = out.outline[one];
  if (whole.hollow) return;
  const auto [a, b] = cut(whole.form, static_cast<int>(random.index(kCuts)));
  Piece first, second;
  first.form = About(a).draw(prior, random);
  second.form = About(b).draw(prior, random);
  if (!in_order(first.form) || !in_order(second.form)) return;
  first.density = prior.density(first);
  second.density = prior.density(second);
  if (first.density <= 0.0 || second.density <= 0.0) return;
  out.outline[one] = first;
  out.outline.add(second);
  for (const Form& form : {whole.form, first.form, second.form}) changes_about(out, form);
  out.correction = correction_of_split(prior, out.outline, {one, pieces}, whole, pieces);
}

void merge(Proposal& out, const OutlinePrior& prior, Random& random) {
  const int pieces = out.outline.size();
  if (pieces < 2) return;
  const Outline before = out.outline;
  const std::pair<int, int> parts = choose_pair(before, random);
  const Form& first = before[parts.first].form;
  const Form& second = before[parts.second].form;
  if (before[parts.first].hollow || before[parts.second].hollow) return;
  Piece whole;
  whole.form = About(joined(first, second)).draw(prior, random);
  if (!in_order(whole.form)) return;
  whole.density = prior.density(whole);
  if (whole.density <= 0.0) return;
  for (const Form& form : {whole.form, first, second}) changes_about(out, form);
  if (parts.second != pieces - 1) changes_about(out, before[pieces - 1].form);
  out.outline[parts.first] = whole;
  out.outline.remove(parts.second);
  out.correction = 1.0 / correction_of_split(prior, before, parts, whole, pieces - 1);
}

/// Moves a form, or the hole in it, or both.
void change_form(Proposal& out, const OutlinePrior& prior, const Target& here, double which, Random& random) {
  if (out.outline.size() == 0) return;
  const int one = choose(out.outline, here, random);
  Piece& piece = out.outline[one];
  const double chosen = choice_of(out.outline, one, here);
  const double before = piece.density;
  changes_about(out, piece.form);
  const double target = piece.hollow ? random.uniform() : 0.0;
  Form& form = target < 0.5 ? piece.form : piece.hole;
  const bool both = target > 0.8;
  const double scale = some_scale(random);
  out.correction = 1.0;
  if (which < 0.38) {
    const double dx = kShift * scale * either_way(random);
    const double dy = kShift * scale * either_way(random);
    form.x += dx;
    form.y += dy;
    if (both) {
      piece.form.x += dx;
      piece.form.y += dy;
    }
  } else if (which < 0.59) {
    form.turn(kTurn * scale * either_way(random));
  } else if (which < 0.78) {
    form.a *= std::exp(kStretch * scale * either_way(random));
    form.b *= std::exp(kStretch * scale * either_way(random));
    form.order_axes();
  } else if (which < 0.965) {
    out.correction = move_side(form, scale, random);
  } else {
    change_family(form);
  }
  changes_about(out, piece.form);
  piece.density = out.correction > 0.0 ? prior.density(piece) : 0.0;
  out.correction *= piece.density / before * choice_of(out.outline, one, here) / chosen;
}

/// Takes a new piece for one of them.
void replace(Proposal& out, const OutlinePrior& prior, const Seen& seen, Random& random) {
  const int pieces = out.outline.size();
  if (pieces == 0) return;
  Piece& piece = out.outline[static_cast<int>(random.index(static_cast<std::size_t>(pieces)))];
  if (piece.hollow) return;
  const double before = prior.whole(piece.form) * correction_about(out, prior, seen, piece.form);
  changes_about(out, piece.form);
  if (!(before > 0.0) || !draw_about(piece, out, prior, seen, random)) return;
  changes_about(out, piece.form);
  out.correction = prior.whole(piece.form) * correction_about(out, prior, seen, piece.form) / before;
}

// How far a push goes: standard deviations along x and y, metres, and of the turn, radians.
constexpr double kPushed = 0.012;
constexpr double kTurned = 0.1;

/// Of a push, up to a factor.
double density(const Push& push) {
  const double angle = push.angle() / kTurned;
  return std::exp(-0.5 * ((push.dx * push.dx + push.dy * push.dy) / (kPushed * kPushed) + angle * angle));
}

Push some_push(const Area& area, Random& random) {
  Push out;
  out.origin_x = 0.5 * area.width;
  out.origin_y = 0.5 * area.depth;
  out.dx = kPushed * normal(random);
  out.dy = kPushed * normal(random);
  const double angle = kTurned * normal(random);
  out.cosine = std::cos(angle);
  out.sine = std::sin(angle);
  return out;
}

// Shares of the moves that are not of a form. What leads there is proposed as often as what leads back.
constexpr double kAddOrRemove = 0.06;  // each
constexpr double kHoleOrFill = 0.04;
constexpr double kSplitOrMerge = 0.02;
constexpr double kReplace = 0.02;
constexpr double kForm = 1.0 - 2.0 * (kAddOrRemove + kHoleOrFill + kSplitOrMerge) - kReplace;

}  // namespace

void propose(Proposal& out, const OutlinePrior& prior, const Seen& seen, Random& random) {
  using Kind = Proposal::Kind;
  double which = random.uniform();
  const auto falls = [&](Kind kind, double share) {
    out.kind = kind;
    return (which -= share) < 0.0;
  };
  if (falls(Kind::replace, kReplace)) return replace(out, prior, seen, random);
  if (falls(Kind::add, kAddOrRemove)) return add_piece(out, prior, seen, random);
  if (falls(Kind::remove, kAddOrRemove)) return remove_piece(out, prior, seen, random);
  if (falls(Kind::make_hole, kHoleOrFill)) return change_hole(out, true, prior, seen, random);
  if (falls(Kind::fill_hole, kHoleOrFill)) return change_hole(out, false, prior, seen, random);
  if (falls(Kind::split, kSplitOrMerge)) return split(out, prior, random);
  if (falls(Kind::merge, kSplitOrMerge)) return merge(out, prior, random);
  out.kind = Kind::change_form;
  const Target here = seen.touches->empty() ? Target{} : seen.touches->back().place;
  change_form(out, prior, here, which / kForm, random);
}

void propose_push(Proposal& out, const OutlinePrior& prior, int touches, double rate, Random& random) {
  const State from = out;
  out.kind = Proposal::Kind::push;
  out.everywhere = true;
  const bool stays_before = random.uniform() < 0.5;
  if (random.uniform() < 0.5) {
    // A push that was found out late has been fitted over by then: one time in two it is looked for among the latest.
    constexpr int kLately = 6;
    const int lately = std::min(kLately, touches - 1);
    const auto odds = [&](int before) {
      return rate / (0.5 / (touches - 1) + (before >= touches - lately ? 0.5 / lately : 0.0));
    };
    if (from.push) {
      if (stays_before) out.outline = from.push.then(from.outline);
      out.push = Push();
      out.correction = 1.0 / odds(from.push.before);
    } else {
      out.push = some_push(prior.settings().area, random);
      const int among = random.uniform() < 0.5 ? lately : touches - 1;
      out.push.before = touches - 1 - static_cast<int>(random.index(static_cast<std::size_t>(among)));
      if (stays_before) out.outline = out.push.now(from.outline);
      out.correction = odds(out.push.before);
    }
  } else {
    if (!from.push) return;
    if (random.uniform() < 0.25) {
      constexpr int kFar = 3;
      out.push.before += static_cast<int>(random.index(2 * kFar + 1)) - kFar;
      if (out.push.before < 1 || out.push.before >= touches) return;
    } else {
      const double scale = some_scale(random);
      out.push.dx += 2.0 * kPushed * scale * either_way(random);
      out.push.dy += 2.0 * kPushed * scale * either_way(random);
      const double angle = from.push.angle() + 2.0 * kTurned * scale * either_way(random);
      out.push.cosine = std::cos(angle);
      out.push.sine = std::sin(angle);
      if (stays_before) out.outline = out.push.now(from.push.then(from.outline));
    }
    out.correction = density(out.push) / density(from.push);
  }
  for (int i = 0; i < out.outline.size(); ++i) {
    Piece& piece = out.outline[i];
    piece.density = prior.density(piece);
    out.correction *= piece.density / from.outline[i].density;
  }
}

}  // namespace palpate::footprints
