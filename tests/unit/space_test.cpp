// SPDX-License-Identifier: MIT
// The room of surfaces in space: solids against their definition as sets of points, clouds against all pairs, the skin
// against its formula written out in long double.
#include "space/cloud.hpp"
#include "space/piece.hpp"
#include "space/skin.hpp"
#include "space/solids.hpp"
#include "support/shape_laws.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <Eigen/Geometry>

#include <vector>

namespace palpate::test {
namespace {

using Eigen::Vector3d;

Piece random_piece(Random& random) {
  Piece out;
  out.form = static_cast<Piece::Form>(random.index(3));
  out.centre = 0.05 * random_direction(random);
  out.turn = Eigen::AngleAxisd(3.0 * random.uniform(), random_direction(random)).toRotationMatrix();
  for (Eigen::Index i = 0; i < 3; ++i) out.half(i) = 0.02 + 0.05 * random.uniform();
  if (random.uniform() < 0.5) out.wall = 0.004 + 0.01 * random.uniform();
  return out;
}

/// By the words of Piece: within the form, and not in its hollow.
bool holds(const Piece& piece, const Vector3d& point) {
  const Vector3d at = piece.turn.transpose() * (point - piece.centre);
  const auto within = [&](const Vector3d& half, double low, double top) {
    if (at.z() < low || at.z() > top) return false;
    const double x = std::abs(at.x()) / half.x();
    const double y = std::abs(at.y()) / half.y();
    if (piece.form == Piece::Form::box) return x <= 1 && y <= 1;
    const double z = piece.form == Piece::Form::ellipsoid ? at.z() / half.z() : 0.0;
    return x * x + y * y + z * z <= 1;
  };
  const double up = piece.half.z();
  const bool bowl = piece.hollow() && piece.form == Piece::Form::ellipsoid;
  if (!within(piece.half, -up, bowl ? 0.0 : up)) return false;
  if (!piece.hollow()) return true;
  const Vector3d inner = piece.half.array() - piece.wall;
  return bowl ? !within(inner, -inner.z(), 1.0) : !within(inner, piece.wall - up, 1.0);
}

Line through(const Piece& piece, Random& random) {
  const Vector3d direction = random_direction(random);
  return {piece.centre + 0.04 * random_direction(random) - 0.4 * direction, direction};
}

TEST(Piece, IsWithinALineExactlyWhereItHoldsThePointsOfTheLine) {
  Random random(1, "test/piece");
  int met = 0;
  for (int i = 0; i < 300; ++i) {
    const Piece piece = random_piece(random);
    const Line line = through(piece, random);
    const auto chords = piece.inside(line);
    met += chords[0].empty() ? 0 : 1;
    EXPECT_EQ(piece.first_hit(line), chords[0].empty() ? kNoHit : chords[0].begin);
    for (int k = 0; k < 400; ++k) {
      const double x = 0.8 * (k + random.uniform()) / 400;
      const auto margin = [&](const Chord& chord) {
        return std::min(std::abs(x - chord.begin), std::abs(x - chord.end));
      };
      if (std::min(margin(chords[0]), margin(chords[1])) < 1e-9) continue;
      const bool inside = (x > chords[0].begin && x < chords[0].end) || (x > chords[1].begin && x < chords[1].end);
      ASSERT_EQ(inside, holds(piece, line.origin + x * line.direction)) << i << " at " << x;
    }
  }
  EXPECT_GT(met, 150);
}

TEST(Piece, TellsTheSideOfItsSurfaceByTheSignOfTheDistanceWhichIsNoneOnIt) {
  Random random(2, "test/piece");
  for (int i = 0; i < 300; ++i) {
    const Piece piece = random_piece(random);
    for (int k = 0; k < 50; ++k) {
      const Vector3d point = piece.centre + 0.1 * random.uniform() * random_direction(random);
      const double distance = piece.distance(point);
      if (std::abs(distance) > 1e-9) {
        EXPECT_EQ(distance < 0.0, holds(piece, point));
      }
    }
    const Line line = through(piece, random);
    const double hit = piece.first_hit(line);
    if (hit < kNoHit) {
      EXPECT_NEAR(piece.distance(line.origin + hit * line.direction), 0.0, 1e-9);
    }
  }
}

TEST(Piece, SaysWhatAngleALineMeetsItAt) {
  Random random(3, "test/piece");
  for (int i = 0; i < 300; ++i) {
    const Piece piece = random_piece(random);
    const Line line = through(piece, random);
    const Chord chord = piece.inside(line)[0];
    if (chord.empty()) continue;
    const Vector3d at = line.origin + chord.begin * line.direction;
    Vector3d slope;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const Vector3d step = 1e-7 * Vector3d::Unit(k);
      slope(k) = piece.distance(at + step) - piece.distance(at - step);
    }
    EXPECT_NEAR(chord.begin_cosine, std::abs(slope.normalized().dot(line.direction)), 1e-4);
  }
}

TEST(Piece, IsPassedByALineThatIsMovedAsFarAsideAsItSays) {
  Random random(4, "test/piece");
  for (int i = 0; i < 200; ++i) {
    Piece piece = random_piece(random);
    piece.wall = 0.0;
    const Line line = through(piece, random);
    if (piece.first_hit(line) == kNoHit) continue;
    // Over all directions across the line: by some it gets clear within that way, and by none in much less.
    const Vector3d one = line.direction.unitOrthogonal();
    const Vector3d other = line.direction.cross(one);
    const double aside = piece.aside(line);
    bool clear = false;
    for (int k = 0; k < 360; ++k) {
      const double angle = 3.14159265358979323846 * k / 180;
      const Vector3d across = std::cos(angle) * one + std::sin(angle) * other;
      clear = clear || piece.first_hit({line.origin + (1.01 * aside + 5e-4) * across, line.direction}) == kNoHit;
      EXPECT_LT(piece.first_hit({line.origin + 0.95 * aside * across, line.direction}), kNoHit);
    }
    EXPECT_TRUE(clear);
  }
}

TEST(Cloud, FindsTheNearestAmongAllPoints) {
  Random random(5, "test/cloud");
  Cloud from, to;
  for (int i = 0; i < 300; ++i) {
    from.push_back(0.2 * random.uniform() * random_direction(random));
    to.push_back(Vector3d(0.05, 0.0, 0.0) + 0.1 * random.uniform() * random_direction(random));
  }
  const std::vector<double> found = nearest_distances(from, to);
  for (std::size_t i = 0; i < from.size(); ++i) {
    double least = kNoHit;
    for (const Vector3d& point : to) least = std::min(least, (point - from[i]).norm());
    EXPECT_DOUBLE_EQ(found[i], least);
  }
}

TEST(Cloud, HasNoErrorAgainstItselfAndTheKnownOneAgainstAShiftedCopy) {
  Cloud one, other;
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 20; ++k) {
      one.emplace_back(0.01 * i, 0.01 * k, 0.0);
      other.emplace_back(0.01 * i, 0.01 * k, 0.003);
    }
  }
  const CloudErrors none = compare_clouds(one, one);
  EXPECT_EQ(none.mean, 0.0);
  EXPECT_EQ(none.f_score, 1.0);
  const CloudErrors shifted = compare_clouds(one, other);
  EXPECT_NEAR(shifted.mean, 0.003, 1e-12);
  EXPECT_NEAR(shifted.rms, 0.003, 1e-12);
  EXPECT_EQ(shifted.f_score, 1.0);
  other.resize(200);  // half of it is missing, none is too much
  const CloudErrors half = compare_clouds(other, one);
  EXPECT_NEAR(half.of_belief, 0.003, 1e-12);
  EXPECT_GT(half.of_truth, 0.02);
  EXPECT_NEAR(half.f_score, 2.0 * 0.5 / 1.5, 1e-12);
  EXPECT_EQ(compare_clouds({}, one).f_score, 0.0);
}

TEST(Bundle, HasLinesFromAllSidesThatBeginOutsideAndAboveTheDesk) {
  const Bundle bundle({0.1, 0.1, 0.05}, 0.15, 100, 0.02);
  Vector3d least = Vector3d::Ones();
  Vector3d most = -Vector3d::Ones();
  for (const Line& line : bundle.lines) {
    EXPECT_NEAR(line.direction.norm(), 1.0, 1e-12);
    EXPECT_GT(line.origin.z(), 0.0);
    EXPECT_NEAR((line.origin - Vector3d(0.1, 0.1, 0.05)).norm(), 0.15, 1e-12);
    least = least.cwiseMin(line.direction);
    most = most.cwiseMax(line.direction);
  }
  EXPECT_LT(least.maxCoeff(), -0.9);
  EXPECT_GT(most.x(), 0.9);
  EXPECT_GT(most.y(), 0.9);
  EXPECT_GT(most.z(), 0.4);
  EXPECT_LE(most.z(), 0.5);
}

TEST(Skin, IsTheGaussianProcessOfItsFormula) {
  Composition ball;
  ball.parts.push_back(
      {{Piece::Form::ellipsoid, {0, 0, 0.05}, Eigen::Matrix3d::Identity(), {0.05, 0.05, 0.05}, 0.0}, {}, {}, 0.0});
  Random random(6, "test/skin");
  std::vector<SurfaceTouch> touches;
  for (int i = 0; i < 12; ++i) {
    const Vector3d out = random_direction(random);
    const Vector3d at = Vector3d(0, 0, 0.05) + (0.05 + 0.003 * random.uniform()) * out;
    touches.push_back({{at + 0.1 * out, -out}, 0.1, true, false});
  }
  const std::shared_ptr<Kernel> kernel = make<Kernel>(shared_host(), "matern32", "{length_scale: 4 cm}");
  const SkinSettings settings{0.006, 0.0005};
  Skin skin(kernel, settings);
  skin.fit(ball, touches);

  using Real = long double;
  const auto normal = [](const Vector3d& at) { return Vector3d((at - Vector3d(0, 0, 0.05)).normalized()); };
  const Real signal = skin.signal();
  const auto covariance = [&](const Vector3d& a, const Vector3d& b) {
    const Real r = std::sqrt(Real(3)) * Real((a - b).norm()) / Real(0.04);
    return signal * signal * (1 + r) * std::exp(-r) * (1 + Real(normal(a).dot(normal(b)))) / 2;
  };
  const auto n = static_cast<Eigen::Index>(touches.size());
  Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic> k(n, n);
  Eigen::Matrix<Real, Eigen::Dynamic, 1> off(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3d at = touches[static_cast<std::size_t>(i)].end();
    off(i) = Real((at - Vector3d(0, 0, 0.05)).norm()) - Real(0.05);
    for (Eigen::Index j = 0; j < n; ++j) k(i, j) = covariance(at, touches[static_cast<std::size_t>(j)].end());
    k(i, i) += Real(0.0005) * Real(0.0005);
  }
  for (int i = 0; i < 50; ++i) {
    const Vector3d out = random_direction(random);
    const Vector3d at = Vector3d(0, 0, 0.05) + 0.05 * out;
    Eigen::Matrix<Real, Eigen::Dynamic, 1> with(n);
    for (Eigen::Index j = 0; j < n; ++j) with(j) = covariance(at, touches[static_cast<std::size_t>(j)].end());
    const Eigen::Matrix<Real, Eigen::Dynamic, 1> solved = k.ldlt().solve(with);
    EXPECT_NEAR(skin.mean({at, out}), static_cast<double>(solved.dot(off)), 1e-9);
    EXPECT_NEAR(skin.variance({at, out}), static_cast<double>(signal * signal - solved.dot(with)), 1e-12);
  }
}

TEST(Skin, KeepsWhatIsLearntOfOneSideOfAWallFromTheOther) {
  Composition plate;
  plate.parts.push_back(
      {{Piece::Form::box, {0, 0, 0.1}, Eigen::Matrix3d::Identity(), {0.1, 0.002, 0.1}, 0.0}, {}, {}, 0.0});
  Skin skin(make<Kernel>(shared_host(), "matern32", "{length_scale: 4 cm}"), {0.006, 0.0005});
  skin.fit(plate, {{{{0, 0.2, 0.1}, {0, -1, 0}}, 0.195, true, false}});  // 3 mm in front of it
  EXPECT_NEAR(skin.mean({{0, 0.002, 0.1}, {0, 1, 0}}), 0.003, 2e-4);
  EXPECT_NEAR(skin.mean({{0, -0.002, 0.1}, {0, -1, 0}}), 0.0, 1e-12);
  EXPECT_NEAR(skin.variance({{0, -0.002, 0.1}, {0, -1, 0}}), skin.signal() * skin.signal(), 1e-12);
}

TEST(Solids, FindABoxFromTouchesOfIt) {
  const Piece box{Piece::Form::box, {0.13, 0.13, 0.03}, Eigen::Matrix3d::Identity(), {0.05, 0.03, 0.03}, 0.0};
  Random random(7, "test/solids");
  SolidsSettings settings;
  settings.count = 12;
  settings.moves = 200;
  Solids solids({0.26, 0.26}, settings, Random(7, "solids"));
  for (int i = 0; i < 60; ++i) {
    Vector3d direction = random_direction(random);
    direction.z() = -std::abs(direction.z());
    const Vector3d through = box.centre + 0.06 * random.uniform() * random_direction(random);
    const Line line{through - 0.3 * direction, direction};
    const double desk = -line.origin.z() / direction.z();
    const double hit = std::min(box.first_hit(line), desk);
    solids.add({{line, hit, true, hit == desk}});
  }
  const Composition& best = solids.best();
  EXPECT_TRUE(std::isfinite(best.posterior()));
  const Bundle bundle(box.centre, 0.12, 60, 0.01);
  Cloud truth, believed;
  for (const Line& line : bundle.lines) {
    const double desk = line.direction.z() < 0 ? -line.origin.z() / line.direction.z() : kNoHit;
    if (box.first_hit(line) < desk) truth.push_back(line.origin + box.first_hit(line) * line.direction);
    if (best.first_hit(line) < desk) believed.push_back(line.origin + best.first_hit(line) * line.direction);
  }
  EXPECT_GT(compare_clouds(thinned(believed, 0.003), thinned(truth, 0.003)).f_score, 0.95);
}

TEST(Solids, KeepWhatTheySumUpTrueThroughAllMoves) {
  Random random(8, "test/solids");
  SolidsSettings settings;
  settings.count = 6;
  settings.moves = 200;
  Solids solids({0.26, 0.26}, settings, Random(8, "solids"));
  std::vector<SurfaceTouch> touches;
  for (int i = 0; i < 15; ++i) {
    const Vector3d out = random_direction(random);
    touches.push_back(
        {{Vector3d(0.13, 0.13, 0.1) + 0.2 * out, -out}, 0.1 + 0.05 * random.uniform(), i % 5 != 0, false});
    solids.add({touches.back()});
  }
  // A copy that takes in nothing new computes all of it again.
  for (const Composition& one : solids.compositions()) {
    EXPECT_TRUE(std::isfinite(one.posterior()));
    double prior = 0.0;
    for (const Composition::Part& part : one.parts) {
      prior += part.prior;
      for (std::size_t i = 0; i < touches.size(); ++i)
        EXPECT_EQ(part.reach[i], touches[i].contact ? std::abs(part.piece.distance(touches[i].end())) : 0.0);
    }
    EXPECT_NEAR(one.prior, prior, 1e-9);
    double likelihood = 0.0;
    for (std::size_t i = 0; i < touches.size(); ++i) {
      double reach = touches[i].contact ? 0.3 : 0.0;
      double depth = 0.0;
      for (const Composition::Part& part : one.parts) {
        reach = std::min(reach, part.reach[i]);
        depth = std::max(depth, part.depth[i]);
      }
      likelihood -= 2.0 * std::log1p((reach * reach + depth * depth) / (3.0 * settings.misfit * settings.misfit));
    }
    EXPECT_NEAR(one.likelihood, likelihood, 1e-9);
  }
}

}  // namespace
}  // namespace palpate::test
