// SPDX-License-Identifier: MIT
#include "solids/primitive.hpp"

#include <Eigen/Geometry>

#include <palpate/math.hpp>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Vector3d;

/// Assumes lengths far from the limits of double, so it needs no scaling.
double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

/// Clips `chord` to the interval between two distances.
void keep(double begin, double begin_cosine, double end, double end_cosine, Chord& chord) {
  if (begin > chord.begin) chord.begin = begin, chord.begin_cosine = begin_cosine;
  if (end < chord.end) chord.end = end, chord.end_cosine = end_cosine;
}

/// Clips `chord` to the distances x with low <= origin + slope * x <= high.
void clip(double origin, double slope, double low, double high, Chord& chord) {
  if (slope == 0.0) {
    if (origin < low || origin > high) chord = {};
    return;
  }
  const double one = (low - origin) / slope;
  const double other = (high - origin) / slope;
  keep(std::min(one, other), std::abs(slope), std::max(one, other), std::abs(slope), chord);
}

/// Clips `chord` to the distances x at which the norm of (`from` + x * `along`) / `half` is at most 1. `along` is the
/// part of a unit direction in these dimensions, not normalised.
template <class Vector>
void clip_round(const Vector& from, const Vector& along, const Vector& half, Chord& chord) {
  const Vector p = from.cwiseQuotient(half);
  const Vector u = along.cwiseQuotient(half);
  const double a = u.squaredNorm();
  const double c = p.squaredNorm() - 1.0;
  if (a < 1e-12) {
    if (c > 0.0) chord = {};
    return;
  }
  const double b = p.dot(u);
  const double discriminant = b * b - a * c;
  if (discriminant < 0.0) {
    chord = {};
    return;
  }
  const double root = std::sqrt(discriminant);
  const auto cosine = [&](double x) {
    const Vector normal = (p + x * u).cwiseQuotient(half);
    return std::abs(normal.dot(along)) / normal.norm();
  };
  const double begin = (-b - root) / a;
  const double end = (-b + root) / a;
  keep(begin, begin > chord.begin ? cosine(begin) : 1.0, end, end < chord.end ? cosine(end) : 1.0, chord);
}

/// Returns the part of a line, in the frame of a form with these half extents, that lies within the form and between
/// two heights.
Chord within(Primitive::Form form, const Vector3d& half, const Vector3d& from, const Vector3d& along, double low,
             double top) {
  Chord out{-kNoHit, kNoHit};
  clip(from.z(), along.z(), low, top, out);
  switch (form) {
    case Primitive::Form::box:
      clip(from.x(), along.x(), -half.x(), half.x(), out);
      clip(from.y(), along.y(), -half.y(), half.y(), out);
      break;
    case Primitive::Form::cylinder:
      clip_round<Eigen::Vector2d>(from.head<2>(), along.head<2>(), half.head<2>(), out);
      break;
    case Primitive::Form::ellipsoid:
      clip_round<Vector3d>(from, along, half, out);
      break;
  }
  return out;
}

/// Returns the distance to the Cartesian product of two convex sets, from the distances to each.
double of_both(double one, double other) {
  const double outside = length_of(std::max(one, 0.0), std::max(other, 0.0));
  return outside + std::min(0.0, std::max(one, other));
}

double to_ellipsoid(const Vector3d& at, const Vector3d& half) {
  const double k = at.cwiseQuotient(half).norm();
  const double slope = at.cwiseQuotient(half.cwiseProduct(half)).norm();
  return slope < 1e-9 ? -half.minCoeff() : k * (k - 1.0) / slope;
}

double to_ellipse(const Eigen::Vector2d& at, const Eigen::Vector2d& half) {
  if (half.x() == half.y()) return at.norm() - half.x();
  const double k = at.cwiseQuotient(half).norm();
  const double slope = at.cwiseQuotient(half.cwiseProduct(half)).norm();
  return slope < 1e-9 ? -half.minCoeff() : k * (k - 1.0) / slope;
}

/// Returns the distance to a form, cut at two heights of its own frame.
double to_form(Primitive::Form form, const Vector3d& half, const Vector3d& at, double low, double top) {
  const double upright = std::max(low - at.z(), at.z() - top);
  switch (form) {
    case Primitive::Form::box: {
      const Vector3d beyond(std::abs(at.x()) - half.x(), std::abs(at.y()) - half.y(), upright);
      return beyond.cwiseMax(0.0).norm() + std::min(0.0, beyond.maxCoeff());
    }
    case Primitive::Form::cylinder:
      return of_both(to_ellipse(at.head<2>(), half.head<2>()), upright);
    case Primitive::Form::ellipsoid:
      return std::max(to_ellipsoid(at, half), upright);
  }
  return kNoHit;
}

/// An angle by its cosine and sine.
struct PlaneRotation {
  double cosine = 1.0, sine = 0.0;
};

PlaneRotation turned_by(double angle) { return {math::cos(angle), math::sin(angle)}; }

/// Returns aside() of a round primitive. The line is given in the primitive's frame: a point `from` and the unit
/// direction `along`. Searches for the direction with the smallest sideways shift: evaluates twelve directions, then
/// refines the best one between its neighbours. It adds angles with known cosines, because this search dominates the
/// run time of runs from any side.
double search_aside(const Primitive& primitive, const Vector3d& from, const Vector3d& along, double most) {
  static const std::array<PlaneRotation, 12> directions = [] {
    std::array<PlaneRotation, 12> out;
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = turned_by(kHalfTurn / 6.0 * static_cast<double>(k));
    return out;
  }();
  static const std::array<PlaneRotation, 5> steps = [] {
    std::array<PlaneRotation, 5> out;
    double step = kHalfTurn / 12.0;
    for (PlaneRotation& one : out) one = turned_by(step), step /= 2.0;
    return out;
  }();
  const Vector3d one = along.unitOrthogonal();
  const Vector3d other = along.cross(one);
  const double towards_one = one.dot(from);
  const double towards_other = other.dot(from);
  double least = kNoHit;
  PlaneRotation best;
  const auto attempt = [&](const PlaneRotation& turned) {
    const double room = primitive.reach(turned.cosine * one + turned.sine * other) - turned.cosine * towards_one -
                        turned.sine * towards_other;
    if (!(room < least)) return;
    least = room;
    best = turned;
  };
  for (const PlaneRotation& direction : directions) attempt(direction);
  // Between two of these directions, the shift may be smaller. The difference is at most sin 15 degrees times the
  // extent (for thin solids), plus (1 - cos 15 degrees) times the distance between line and centre.
  if (least - 0.3 * primitive.half.norm() > most) return most;
  for (const PlaneRotation& step : steps) {
    const PlaneRotation middle = best;
    attempt(
        {middle.cosine * step.cosine + middle.sine * step.sine, middle.sine * step.cosine - middle.cosine * step.sine});
    attempt(
        {middle.cosine * step.cosine - middle.sine * step.sine, middle.sine * step.cosine + middle.cosine * step.sine});
  }
  return std::min(least, most);
}

}  // namespace

double Primitive::volume() const {
  const double box = 8.0 * half.prod();
  if (form == Form::box) return box;
  if (form == Form::cylinder) return box * kHalfTurn / 4.0;
  return box * kHalfTurn / (hollow() ? 12.0 : 6.0);
}

std::array<Chord, 2> Primitive::inside(const Line& line) const {
  const Vector3d from = turn.transpose() * (line.origin - centre);
  const Vector3d along = turn.transpose() * line.direction;
  const bool bowl = form == Form::ellipsoid && hollow();
  const double top = bowl ? 0.0 : half.z();
  const Chord outer = within(form, half, from, along, -half.z(), top);
  if (!hollow() || outer.empty()) return {outer, {}};
  const Vector3d inner = (half.array() - wall).max(1e-4).matrix();
  Chord hollow;
  if (bowl) {
    hollow = within(form, inner, from, along, -kNoHit, kNoHit);
  } else {
    hollow = within(form, inner, from, along, wall - half.z(), kNoHit);
  }
  if (hollow.empty() || hollow.end <= outer.begin || hollow.begin >= outer.end) return {outer, {}};
  std::array<Chord, 2> out;
  std::size_t count = 0;
  if (hollow.begin > outer.begin) out[count++] = {outer.begin, hollow.begin, outer.begin_cosine, hollow.begin_cosine};
  if (hollow.end < outer.end) out[count] = {hollow.end, outer.end, hollow.end_cosine, outer.end_cosine};
  return out;
}

double Primitive::first_intersection(const Line& line) const {
  const Chord first = inside(line)[0];
  if (first.empty()) return kNoHit;
  return first.begin;
}

double Primitive::reach(const Vector3d& own) const {
  switch (form) {
    case Form::box:
      return half.dot(own.cwiseAbs());
    case Form::cylinder:
      return length_of(half.x() * own.x(), half.y() * own.y()) + half.z() * std::abs(own.z());
    case Form::ellipsoid:
      return hollow() && own.z() > 0.0 ? length_of(half.x() * own.x(), half.y() * own.y())
                                       : half.cwiseProduct(own).norm();
  }
  return 0.0;
}

double Primitive::aside(const Line& line, double most) const {
  const Vector3d from = turn.transpose() * (line.origin - centre);
  const Vector3d along = turn.transpose() * line.direction;
  if (form != Form::box) return search_aside(*this, from, along, most);
  double least = most;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3d across = along.cross(Vector3d::Unit(i));
    const double length = across.norm();
    if (length > 1e-9) least = std::min(least, (half.dot(across.cwiseAbs()) - std::abs(across.dot(from))) / length);
  }
  return least;
}

double Primitive::distance(const Vector3d& point) const {
  const Vector3d at = turn.transpose() * (point - centre);
  const bool bowl = form == Form::ellipsoid && hollow();
  const double outer = to_form(form, half, at, -half.z(), bowl ? 0.0 : half.z());
  if (!hollow()) return outer;
  const Vector3d inner = (half.array() - wall).max(1e-4).matrix();
  const double hollow = bowl ? to_ellipsoid(at, inner) : to_form(form, inner, at, wall - half.z(), kNoHit);
  return std::max(outer, -hollow);
}

}  // namespace palpate
