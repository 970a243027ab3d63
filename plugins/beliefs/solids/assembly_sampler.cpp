// SPDX-License-Identifier: MIT
#include "solids/assembly_sampler.hpp"

#include "scene/rotation.hpp"

#include <Eigen/Geometry>

#include <palpate/math.hpp>

#include <algorithm>
#include <numeric>

namespace palpate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d normal3(Random& random) {
  Vector3d out;
  for (double& one : out) one = random.normal();
  return out;
}

double between(double low, double high, Random& random) { return low + (high - low) * random.uniform(); }

/// Returns how much the free path of a tool, which came from far outside, contradicts a primitive. Either of two shifts
/// removes the contradiction: the surface moves backwards, or the path moves sideways. Returns the smaller shift,
/// metres; 0 without a contradiction.
double depth_of(const Primitive& primitive, const SurfaceTouch& touch) {
  const Vector3d to = primitive.centre - touch.line.origin;
  if ((to - to.dot(touch.line.direction) * touch.line.direction).squaredNorm() > primitive.half.squaredNorm())
    return 0.0;
  const Chord first = primitive.inside(touch.line)[0];
  if (first.empty() || first.begin >= touch.length) return 0.0;
  const double back = (touch.length - first.begin) * first.begin_cosine;
  return back < 1e-4 ? back : primitive.aside(touch.line, back);
}

/// Returns a random rotation: upright, lying or in between.
Matrix3d stance(Random& random) {
  Matrix3d turned = rotation_about(Vector3d::UnitZ(), between(0.0, 2.0 * kHalfTurn, random));
  const double how = random.uniform();
  if (how < 0.65) return turned;
  if (how < 0.85) return turned * rotation_about(Vector3d::UnitY(), kHalfTurn / 2);
  return turned * rotation_about(Vector3d::UnitY(), between(0.0, kHalfTurn / 2, random));
}

/// Draws a primitive of any size that contains a given point, or has it on its surface.
Primitive draw(const Vector3d& near, Random& random) {
  Primitive out;
  const double form = random.uniform();
  out.form = form < 0.4 ? Primitive::Form::box : form < 0.8 ? Primitive::Form::cylinder : Primitive::Form::ellipsoid;
  out.turn = stance(random);
  for (Eigen::Index i = 0; i < 3; ++i) out.half(i) = math::exp(between(math::log(0.004), math::log(0.12), random));
  if (out.form == Primitive::Form::cylinder || random.uniform() < 0.3) out.half.y() = out.half.x();
  if (random.uniform() < 0.3) out.wall = between(0.002, 0.007, random);
  Vector3d within;
  for (Eigen::Index i = 0; i < 3; ++i) within(i) = out.half(i) * between(-1.0, 1.0, random);
  out.centre = near - out.turn * within;
  if (random.uniform() < 0.5) {  // placed on the desk
    const Vector3d up = out.turn.transpose() * Vector3d::UnitZ();
    out.centre.z() = out.half.dot(up.cwiseAbs());
  }
  return out;
}

/// Moves one of the two faces across an axis by a Gaussian step with standard deviation `size`, metres; the opposite
/// face stays. A cylinder usually keeps a circular section.
void move_face(Primitive& primitive, Eigen::Index axis, double size, Random& random) {
  const double by = size * random.normal();
  Vector3d grown = Vector3d::Zero();
  grown(axis) = by / 2;
  primitive.half += grown;
  primitive.centre += primitive.turn * (random.uniform() < 0.5 ? Vector3d(-grown) : grown);
  if (primitive.form == Primitive::Form::cylinder && axis < 2 && random.uniform() < 0.8)
    primitive.half(1 - axis) = primitive.half(axis);
}

/// Rotates a primitive about the vertical, and often about a horizontal axis, too, if it neither stands nor lies.
void rotate(Primitive& primitive, Random& random) {
  double angle = math::exp(between(math::log(0.01), math::log(1.0), random));
  angle *= random.normal();
  const double tilt = std::abs(primitive.turn(2, 2));
  if (tilt < 1.0 - 1e-9 && tilt > 1e-9 && random.uniform() < 0.7) {
    Vector3d level = normal3(random);
    level.z() = 0.0;
    primitive.turn = rotation_about(level.normalized(), 0.3 * angle) * primitive.turn;
  }
  primitive.turn = rotation_about(Vector3d::UnitZ(), angle) * primitive.turn;
}

}  // namespace

double Assembly::first_intersection(const Line& line) const {
  double first = kNoHit;
  for (const Part& part : parts) first = std::min(first, part.primitive.first_intersection(line));
  return first;
}

Vector3d Assembly::normal(const Vector3d& point) const {
  constexpr double kStep = 1e-5;
  Vector3d out;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Vector3d step = kStep * Vector3d::Unit(i);
    out(i) = distance(point + step) - distance(point - step);
  }
  const double length = out.norm();
  return length > 0.0 ? Vector3d(out / length) : Vector3d::UnitZ();
}

double Assembly::distance(const Vector3d& point) const {
  double least = kNoHit;
  for (const Part& part : parts) least = std::min(least, part.primitive.distance(point));
  return least;
}

AssemblySampler::AssemblySampler(const Area& area, const AssemblySamplerSettings& settings, Random random)
    : settings_(settings), random_(random) {
  const double middle = std::min(area.width, area.depth);
  for (int i = 0; i < settings.count; ++i) {
    Assembly one;
    Vector3d near = Vector3d(area.width / 2, area.depth / 2, 0.0) + 0.1 * middle * normal3(random_);
    near.z() = between(0.0, 0.1, random_);
    Assembly::Part part{draw(near, random_), {}, {}, 0.0};
    while (!(prior_of(part.primitive) > -kNoHit)) part.primitive = draw(near, random_);
    part.prior = one.prior = prior_of(part.primitive);
    one.parts.push_back(part);
    all_.push_back(one);
  }
}

double AssemblySampler::prior_of(const Primitive& primitive) const {
  double out = -settings_.primitives;
  const Vector3d up = primitive.turn * Vector3d::UnitZ();
  const double tilt = std::abs(up.z());
  out += tilt > 1.0 - 1e-9 ? math::log(0.65) : tilt < 1e-9 ? math::log(0.2) : math::log(0.15);
  out += primitive.hollow() ? math::log(0.3) : math::log(0.7);
  if (primitive.half.minCoeff() < settings_.smallest || primitive.half.maxCoeff() > settings_.largest) return -kNoHit;
  if (primitive.hollow() && (primitive.wall < 0.002 || primitive.wall > 0.8 * primitive.half.minCoeff()))
    return -kNoHit;
  const Vector3d own = primitive.turn.transpose() * Vector3d::UnitZ();
  const double lowest = primitive.centre.z() - primitive.half.dot(own.cwiseAbs());
  // Penalises primitives that reach into the desk, and primitives that float above it without a support.
  if (lowest < 0.0) out -= 0.5 * math::pow(lowest / 0.003, 2);
  if (lowest > 0.003) out -= 1.0;
  // Prefers the smaller of two primitives that explain the same touches.
  out -= 0.3 * math::log(1.0 + primitive.volume() / 1e-5);
  return out;
}

void AssemblySampler::look(Assembly::Part& part, std::size_t from) const {
  part.reach.resize(touches_.size());
  part.depth.resize(touches_.size());
  for (std::size_t i = from; i < touches_.size(); ++i) {
    part.reach[i] =
        touches_[i].contact && !touches_[i].desk ? std::abs(part.primitive.distance(touches_[i].end())) : 0.0;
    part.depth[i] = depth_of(part.primitive, touches_[i]);
  }
}

const Assembly& AssemblySampler::best() const {
  return *std::max_element(all_.begin(), all_.end(), [](const Assembly& one, const Assembly& other) {
    return one.posterior() < other.posterior();
  });
}

Eigen::VectorXd AssemblySampler::offsets(const Vector3d& at) const {
  constexpr double kFarthest = 0.02;
  const double here = best().distance(at);
  Eigen::VectorXd out(static_cast<Eigen::Index>(all_.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i)
    out(i) = std::clamp(here - all_[static_cast<std::size_t>(i)].distance(at), -kFarthest, kFarthest);
  return out;
}

std::vector<Primitive> AssemblySampler::undiscovered(const Assembly& one, int draws, Random& random) const {
  constexpr double kClear = 0.001;
  // Largest cost of a draw beyond settings_.primitives, nats. It covers stance, size and wall of any primitive above
  // the desk. Primitives that reach into the desk cost more.
  constexpr double kUnlikely = 6.0;
  std::vector<Primitive> out;
  for (int i = 0; i < draws && !one.parts.empty(); ++i) {
    const Primitive& held = one.parts[random.index(one.parts.size())].primitive;
    Vector3d at;
    for (Eigen::Index k = 0; k < 3; ++k) at(k) = held.half(k) * between(-1.0, 1.0, random);
    const auto side = static_cast<Eigen::Index>(random.index(3));
    at(side) = std::copysign(held.half(side), at(side));
    const Primitive primitive = draw(held.centre + held.turn * at, random);
    if (!(prior_of(primitive) > -settings_.primitives - kUnlikely)) continue;
    const bool clear = std::all_of(touches_.begin(), touches_.end(),
                                   [&](const SurfaceTouch& touch) { return depth_of(primitive, touch) < kClear; });
    if (clear) out.push_back(primitive);
  }
  return out;
}

void AssemblySampler::add(const std::vector<SurfaceTouch>& touches) {
  take_in(touches);
  move_all();
}

void AssemblySampler::look(const std::vector<SurfaceTouch>& view) {
  constexpr int kRounds = 15;
  constexpr int kCooling = 10;
  constexpr double kFlat = 0.05;
  last_power_ = kFlat;
  take_in(view);
  seen_ = touches_.size();
  for (int i = 0; i < kRounds; ++i) {
    last_power_ = std::min(1.0, math::pow(kFlat, 1.0 - static_cast<double>(i) / kCooling));
    move_all();
  }
}

void AssemblySampler::take_in(const std::vector<SurfaceTouch>& touches) {
  const std::size_t before = touches_.size();
  touches_.insert(touches_.end(), touches.begin(), touches.end());
  weigh(before);
}

void AssemblySampler::read_again(const std::vector<SurfaceTouch>& touches, double misfit, double most) {
  touches_ = touches;
  settings_.misfit = misfit;
  settings_.most = most;
  weigh(0);
}

void AssemblySampler::weigh(std::size_t from) {
  order_.resize(touches_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::vector<double> weights;
  for (Assembly& one : all_) {
    const double was = one.likelihood;
    for (Assembly::Part& part : one.parts) look(part, from);
    one.likelihood = likelihood_with(one, one.parts.size(), nullptr, -kNoHit);
    weights.push_back(last_power_ * (one.likelihood - was));
  }
  resample(weights);
}

void AssemblySampler::move_all() {
  for (Assembly& one : all_) move(one);
}

double AssemblySampler::least_likelihood(const Assembly& one, double prior_gained) {
  return one.likelihood + (math::log(1.0 - random_.uniform()) - prior_gained) / power_;
}

void AssemblySampler::resample(const std::vector<double>& weights) {
  const double most = *std::max_element(weights.begin(), weights.end());
  std::vector<double> shares;
  double total = 0.0;
  double squares = 0.0;
  for (const double w : weights) {
    shares.push_back(math::exp(w - most));
    total += shares.back();
    squares += shares.back() * shares.back();
  }
  // All assemblies may be impossible; then none is preferred.
  if (!std::isfinite(total) || total * total / squares > 0.5 * static_cast<double>(shares.size())) return;
  std::vector<Assembly> drawn;
  const double step = total / static_cast<double>(shares.size());
  double at = step * random_.uniform();
  double sum = 0.0;
  for (std::size_t i = 0; i < shares.size(); ++i) {
    sum += shares[i];
    for (; at < sum && drawn.size() < shares.size(); at += step) drawn.push_back(all_[i]);
  }
  while (drawn.size() < shares.size()) drawn.push_back(drawn.back());
  all_ = std::move(drawn);
}

/// Uses Student's t distribution with three degrees of freedom, because the simple solids only approximate the objects.
double AssemblySampler::likelihood_with(const Assembly& one, std::size_t which, const Primitive* primitive,
                                        double least) {
  constexpr double kTails = 3.0;
  constexpr double kFarthest = 0.3;
  constexpr std::size_t kAtOnce = 8;  // number of factors per logarithm
  const double scale = 1.0 / (kTails * settings_.misfit * settings_.misfit);
  const double most = math::exp(std::min(700.0, -2.0 * least / (kTails + 1.0)));
  const double of_a_lie = math::exp(2.0 * settings_.most / (kTails + 1.0));
  scratch_.reach.resize(touches_.size());
  scratch_.depth.resize(touches_.size());
  double out = 0.0;
  double product = 1.0;
  for (std::size_t k = 0; k < touches_.size(); ++k) {
    const std::size_t i = order_[k];
    const SurfaceTouch& touch = touches_[i];
    const bool object = touch.contact && !touch.desk;
    double reach = object ? kFarthest : 0.0;
    double depth = 0.0;
    for (std::size_t p = 0; p < one.parts.size(); ++p) {
      if (p == which) continue;
      reach = std::min(reach, one.parts[p].reach[i]);
      depth = std::max(depth, one.parts[p].depth[i]);
    }
    if (primitive != nullptr) {
      scratch_.depth[i] = depth_of(*primitive, touch);
      scratch_.reach[i] = object ? std::abs(primitive->distance(touch.end())) : 0.0;
      reach = std::min(reach, scratch_.reach[i]);
      depth = std::max(depth, scratch_.depth[i]);
    }
    product *= std::min(of_a_lie, 1.0 + scale * (reach * reach + depth * depth));
    if (k % kAtOnce == kAtOnce - 1) out += math::log(product), product = 1.0;
    if (-0.5 * (kTails + 1.0) * out < least || product > most) {
      // The touch that rejected this proposal is evaluated first for the next proposal.
      std::rotate(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(k),
                  order_.begin() + static_cast<std::ptrdiff_t>(k) + 1);
      return -kNoHit;
    }
  }
  const double sum = -0.5 * (kTails + 1.0) * (out + math::log(product));
  return sum < least ? -kNoHit : sum;
}

void AssemblySampler::move(Assembly& one) {
  constexpr double kBirths = 0.1;
  order_.resize(touches_.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::reverse(order_.begin(), order_.end());
  // The number of moves falls as 1/n after the 40th touch, so later touches cost no more time than the 40th.
  constexpr double kFullSweeps = 40.0;
  const auto single = static_cast<double>(touches_.size() - seen_);
  const int moves = static_cast<int>(settings_.moves * std::min(1.0, kFullSweeps / std::max(1.0, single)));
  constexpr double kFlat = 0.3;
  constexpr double kCooling = 0.6;
  for (int i = 0; i < moves; ++i) {
    power_ = last_power_ * std::min(1.0, math::pow(kFlat, 1.0 - i / (kCooling * moves)));
    const double kind = random_.uniform();
    if (kind < kBirths || one.parts.empty()) {
      give_birth(one);
      continue;
    }
    if (kind < 2.0 * kBirths) {
      take_away(one);
      continue;
    }
    const std::size_t which = random_.index(one.parts.size());
    Assembly::Part& part = one.parts[which];
    Primitive primitive = part.primitive;
    if (!change(primitive)) continue;
    const double prior = prior_of(primitive);
    if (!(prior > -kNoHit)) continue;
    const double least = least_likelihood(one, prior - part.prior);
    const double likelihood = likelihood_with(one, which, &primitive, least);
    if (!(likelihood > -kNoHit)) continue;
    part.primitive = primitive;
    part.reach.swap(scratch_.reach);
    part.depth.swap(scratch_.depth);
    one.prior += prior - part.prior;
    part.prior = prior;
    one.likelihood = likelihood;
  }
}

/// Adds a primitive at one of the touches that are explained worst.
void AssemblySampler::give_birth(Assembly& one) {
  constexpr std::size_t kMost = 7;
  if (one.parts.size() >= kMost || touches_.empty()) return;
  const auto reach = [&](std::size_t i) {
    if (!touches_[i].contact || touches_[i].desk) return -1.0;
    double least = kNoHit;
    for (const Assembly::Part& part : one.parts) least = std::min(least, part.reach[i]);
    return least;
  };
  std::size_t worst = random_.index(touches_.size());
  for (int k = 0; k < 6; ++k) {
    const std::size_t other = random_.index(touches_.size());
    if (reach(other) > reach(worst)) worst = other;
  }
  if (reach(worst) < 0.0) return;
  Primitive primitive = draw(touches_[worst].end(), random_);
  fit_to_contact(primitive);
  const double prior = prior_of(primitive);
  if (!(prior > -kNoHit)) return;
  const double least = least_likelihood(one, prior);
  const double likelihood = likelihood_with(one, one.parts.size(), &primitive, least);
  if (!(likelihood > -kNoHit)) return;
  one.parts.push_back({primitive, scratch_.reach, scratch_.depth, prior});
  one.likelihood = likelihood;
  one.prior += prior;
}

void AssemblySampler::take_away(Assembly& one) {
  if (one.parts.size() < 2) return;
  const std::size_t which = random_.index(one.parts.size());
  const double least = least_likelihood(one, -one.parts[which].prior);
  const double likelihood = likelihood_with(one, which, nullptr, least);
  if (!(likelihood > -kNoHit)) return;
  one.likelihood = likelihood;
  one.prior -= one.parts[which].prior;
  std::swap(one.parts[which], one.parts.back());
  one.parts.pop_back();
}

/// Moves the face nearest to a random contact towards it; the opposite face stays.
bool AssemblySampler::fit_to_contact(Primitive& primitive) {
  const SurfaceTouch& touch = touches_[random_.index(touches_.size())];
  if (!touch.contact || touch.desk) return false;
  const Vector3d at = primitive.turn.transpose() * (touch.end() - primitive.centre);
  if (primitive.form != Primitive::Form::box && random_.uniform() < 0.7) {
    const double away = at.head<2>().norm();
    if (away < 1e-6) return false;
    const double by =
        away - std::min(primitive.half.x(), primitive.half.y()) + 0.5 * settings_.misfit * random_.normal();
    const double how = random_.uniform();
    const double grow = how < 0.4 ? 0.5 : how < 0.7 ? 0.0 : 1.0;
    primitive.half.x() += grow * by;
    primitive.half.y() += grow * by;
    const double shift = grow == 1.0 ? 0.0 : grow == 0.0 ? by : by / 2;
    primitive.centre += primitive.turn * Vector3d(shift * at.x() / away, shift * at.y() / away, 0.0);
    return true;
  }
  auto axis = static_cast<Eigen::Index>(random_.index(3));
  if (random_.uniform() < 0.7) (at.cwiseAbs() - primitive.half).cwiseAbs().minCoeff(&axis);
  double by = std::abs(at(axis)) - primitive.half(axis) + 0.5 * settings_.misfit * random_.normal();
  if (primitive.hollow() && random_.uniform() < 0.3) by += primitive.wall;
  primitive.half(axis) += by / 2;
  Vector3d shift = Vector3d::Zero();
  shift(axis) = std::copysign(by / 2, at(axis));
  primitive.centre += primitive.turn * shift;
  return true;
}

/// Changes a primitive at random. Returns false if the change is impossible.
bool AssemblySampler::change(Primitive& primitive) {
  const double kind = random_.uniform();
  const double size = math::exp(between(math::log(0.0005), math::log(0.03), random_));
  const auto axis = static_cast<Eigen::Index>(random_.index(3));
  if (kind < 0.3) return fit_to_contact(primitive);
  if (kind < 0.4) {
    primitive.centre += size * normal3(random_);
  } else if (kind < 0.6) {
    move_face(primitive, axis, size, random_);
  } else if (kind < 0.7) {  // scales one axis, or both horizontal axes
    const double factor = math::exp(10.0 * size * random_.normal());
    if (random_.uniform() < 0.5 || primitive.form != Primitive::Form::box) {
      primitive.half.head<2>() *= factor;
    } else {
      primitive.half(axis) *= factor;
    }
  } else if (kind < 0.82) {
    rotate(primitive, random_);
  } else if (kind < 0.88) {
    const auto form = static_cast<Primitive::Form>(random_.index(3));
    if (form == primitive.form) return false;
    primitive.form = form;
    if (form == Primitive::Form::cylinder) primitive.half.y() = primitive.half.x();
  } else if (kind < 0.94) {
    if (primitive.hollow() && random_.uniform() < 0.5) {
      primitive.wall *= math::exp(0.3 * random_.normal());
    } else {
      primitive.wall = primitive.hollow() ? 0.0 : between(0.002, 0.007, random_);
    }
  } else {
    const Vector3d lowest = primitive.centre;
    primitive.turn = random_.uniform() < 0.5
                         ? stance(random_)
                         : Matrix3d(primitive.turn * rotation_about(Vector3d::Unit(axis), kHalfTurn / 2));
    if (random_.uniform() < 0.5)
      primitive.centre.z() = primitive.half.dot(primitive.turn.row(2).cwiseAbs().transpose());
    if (random_.uniform() < 0.3) primitive.centre = lowest;
  }
  return true;
}

}  // namespace palpate
