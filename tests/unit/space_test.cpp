// SPDX-License-Identifier: MIT
// The room of surfaces in space: solids against their definition as sets of points, clouds against all pairs, the skin
// against its formula written out in long double.
#include "space/cloud.hpp"
#include "space/from_any_side.hpp"
#include "space/piece.hpp"
#include "space/skin.hpp"
#include "space/solids.hpp"
#include "space/view.hpp"
#include "space/volume.hpp"
#include "support/runs.hpp"
#include "support/shape_laws.hpp"
#include "support/support.hpp"
#include "support/testing.hpp"

#include <Eigen/Geometry>

#include <gmock/gmock.h>

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

TEST(Piece, IsAsFarAsideUpToALimitAsWithoutOne) {
  Random random(14, "test/piece");
  int limited = 0;
  for (int i = 0; i < 3000; ++i) {
    Piece piece = random_piece(random);
    for (double& half : piece.half) half = 0.004 * std::pow(30.0, random.uniform());
    const Line line{piece.centre + 0.02 * random_direction(random) - 0.4 * piece.turn.col(2), piece.turn.col(2)};
    const double aside = piece.aside(line);
    const double most = 0.02 * random.uniform();
    EXPECT_EQ(piece.aside(line, most), std::min(aside, most));
    limited += aside > most ? 1 : 0;
  }
  EXPECT_GT(limited, 500);
  EXPECT_LT(limited, 2900);
}

TEST(Cloud, FindsTheNearestAmongAllPointsAndNoneFartherThanTenCentimetres) {
  Random random(5, "test/cloud");
  Cloud from, to;
  for (int i = 0; i < 300; ++i) {
    from.push_back(0.2 * random.uniform() * random_direction(random));
    to.push_back(Vector3d(0.05, 0.0, 0.0) + 0.1 * random.uniform() * random_direction(random));
  }
  const std::vector<double> found = nearest_distances(from, to);
  int far = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    double least = kNoHit;
    for (const Vector3d& point : to) least = std::min(least, (point - from[i]).norm());
    EXPECT_DOUBLE_EQ(found[i], least <= 0.1 ? least : kNoHit);
    far += least > 0.1 ? 1 : 0;
  }
  EXPECT_GT(far, 30);
  EXPECT_LT(far, 200);
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

/// What a camera would see of a piece on the desk, as touches.
std::vector<SurfaceTouch> seen(const Piece& piece) {
  std::vector<SurfaceTouch> out;
  const Vector3d eye(0.6, 0.13, 0.4);
  for (int i = 0; i < 13; ++i) {
    for (int j = 0; j < 13; ++j) {
      const Vector3d at(0.13, 0.13 + 0.02 * (i - 6), 0.03 + 0.015 * (j - 6));
      const Line line{eye, (at - eye).normalized()};
      const double desk = line.direction.z() < 0 ? -eye.z() / line.direction.z() : kNoHit;
      const double hit = piece.first_hit(line);
      out.push_back({line, std::min({hit, desk, 1.0}), std::min(hit, desk) < 1.0, desk <= hit});
    }
  }
  return out;
}

TEST(Solids, KnowABowlThatWasSeenFromOneSideWhateverModeCameFirst) {
  const Piece bowl{Piece::Form::ellipsoid, {0.13, 0.13, 0.07}, Eigen::Matrix3d::Identity(), {0.08, 0.08, 0.07}, 0.004};
  SolidsSettings settings;
  settings.count = 8;
  int hollow = 0;
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    Solids solids({0.26, 0.26}, settings, Random(seed, "solids"));
    solids.look(seen(bowl));
    const Composition& best = solids.best();
    hollow += std::abs(best.distance({0.13, 0.13, 0.002})) < 0.008 && best.distance({0.13, 0.13, 0.05}) > 0.02 ? 1 : 0;
  }
  EXPECT_GE(hollow, 3) << "the rest may have stayed in a mode that is wrong";
}

TEST(Solids, HaveNothingUnseenWhereATouchHasBeen) {
  const Piece box{Piece::Form::box, {0.13, 0.13, 0.03}, Eigen::Matrix3d::Identity(), {0.05, 0.03, 0.03}, 0.0};
  SolidsSettings settings;
  settings.count = 4;
  settings.moves = 100;
  Solids solids({0.26, 0.26}, settings, Random(9, "solids"));
  Random random(9, "test/unseen");
  std::vector<SurfaceTouch> touches;
  std::size_t before = 300;
  for (int i = 0; i < 40; ++i) {
    Vector3d direction = random_direction(random);
    direction.z() = -std::abs(direction.z());
    const Line line{box.centre + 0.08 * random.uniform() * random_direction(random) - 0.3 * direction, direction};
    const double desk = -line.origin.z() / direction.z();
    touches.push_back({line, std::min(box.first_hit(line), desk), true, desk <= box.first_hit(line)});
    solids.add({touches.back()});
    if (i % 13 != 12) continue;
    const std::vector<Piece> unseen = solids.unseen(solids.best(), 300, random);
    EXPECT_LT(unseen.size(), before) << "the more was touched, the less is left";
    before = unseen.size();
    EXPECT_GT(before, 0U);
    for (const Piece& piece : unseen) {
      for (const SurfaceTouch& touch : touches) {
        const Chord first = piece.inside(touch.line)[0];
        if (first.empty() || first.begin >= touch.length) continue;
        EXPECT_LT(std::min((touch.length - first.begin) * first.begin_cosine, piece.aside(touch.line)), 0.001);
      }
    }
  }
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

/// A cup: 8 cm wide, 6 cm deep, its wall 1 cm, its bottom open, in the middle of an area of 26 cm.
std::vector<std::string> cup() {
  return {"scene.touch=any", "scene.area={width: 26 cm, depth: 26 cm}", "scene.desk=2 cm",
          "scene.objects=[{type: ring, outer: 8 cm, inner: 6 cm, height: 6 cm, at: [13 cm, 13 cm]}]"};
}
const Vector3d kMiddle(0.13, 0.13, 0.08);

std::unique_ptr<const Scene> scene_of_cup() {
  return build_scene(shipped_config("any_side.yaml", cup()).options.scene, 1, shared_host());
}

TEST(SideView, IsFreeUpToWhereTheSceneIsFirstMetAndKnowsObjectFromDesk) {
  const auto scene = scene_of_cup();
  SideViewOptions options;
  options.azimuth = 0.5;
  const std::vector<SurfaceTouch> view = side_view(options, *scene, kMiddle, 0.12, Random(1, "view"));
  ASSERT_EQ(view.size(), 400U);
  EXPECT_TRUE(shows_object(view));
  int on = 0, desk = 0, nothing = 0;
  for (const SurfaceTouch& ray : view) {
    EXPECT_NEAR((ray.line.origin - kMiddle).norm(), 0.6, 1e-12);
    EXPECT_NEAR((ray.line.origin - kMiddle).z(), 0.6 * std::sin(options.elevation), 1e-12);
    const double hit = scene->first_hit({ray.line.origin + Vector3d(0, 0, 0.02), ray.line.direction});
    if (ray.contact && !ray.desk) {
      ++on;
      EXPECT_EQ(ray.length, hit);
    } else {
      EXPECT_LT(ray.length, hit);
      ++(ray.desk ? desk : nothing);
      EXPECT_NEAR(ray.desk ? ray.end().z() : 0.0, 0.0, 1e-12);
    }
  }
  EXPECT_GT(on, 20);
  EXPECT_GT(desk, 100);
  // From level some rays meet nothing.
  options.elevation = 0.0;
  for (const SurfaceTouch& ray : side_view(options, *scene, kMiddle, 0.12, Random(1, "view")))
    nothing += ray.contact ? 0 : 1;
  EXPECT_GT(nothing, 50);
}

TEST(SideView, IsFromWhereTheSeedSaysUnlessTheConfigDoes) {
  const auto scene = scene_of_cup();
  SideViewOptions options;
  const auto eye = [&](std::uint64_t seed) {
    return side_view(options, *scene, kMiddle, 0.12, Random(seed, "view")).front().line.origin;
  };
  EXPECT_EQ(eye(1), eye(1));
  EXPECT_GT((eye(1) - eye(2)).norm(), 1e-3);
  options.azimuth = 1.0;
  EXPECT_EQ(eye(1), eye(2));
  options.elevation = kHalfTurn / 2;  // from above, too
  EXPECT_NEAR((eye(1) - kMiddle - Vector3d(0, 0, 0.6)).norm(), 0.0, 1e-12);
}

TEST(SideView, IsThinnedToRaysOfEachKindOfWhichThoseOnTheObjectLieApart) {
  const auto scene = scene_of_cup();
  SideViewOptions options;
  options.azimuth = 0.5;
  options.rays = 3600;
  const std::vector<SurfaceTouch> view = side_view(options, *scene, kMiddle, 0.12, Random(1, "view"));
  const std::vector<SurfaceTouch> few = thinned_view(view, 160);
  EXPECT_LE(few.size(), 160U);
  EXPECT_GT(few.size(), 120U);
  Cloud ends;
  int others = 0;
  for (const SurfaceTouch& ray : few) {
    EXPECT_TRUE(std::any_of(view.begin(), view.end(), [&](const SurfaceTouch& one) {
      return one.line.direction == ray.line.direction && one.length == ray.length && one.desk == ray.desk;
    }));
    if (ray.contact && !ray.desk) ends.push_back(ray.end());
    others += ray.desk || !ray.contact ? 1 : 0;
  }
  EXPECT_GT(ends.size(), 60U);
  EXPECT_LE(ends.size(), 96U);
  EXPECT_GT(others, 40);
  EXPECT_GT(thinned(ends, 0.006).size(), ends.size() * 9 / 10) << "the cubes may be a little larger";
  // Where all that is seen is desk, some of that is kept.
  std::vector<SurfaceTouch> desk = view;
  for (SurfaceTouch& ray : desk) ray.desk = true;
  EXPECT_EQ(thinned_view(desk, 160).size(), 160U);
}

TEST(SideView, IsRefusedWhereAnotherWorldIsTappedThanTheScene) {
  class Elsewhere final : public Backend {
   public:
    Contact tap(const TapRequest&) override { return {}; }
    bool repeatable() const override { return true; }
    bool reaches(const Approach&) const override { return true; }
    bool scene_is_truth() const override { return false; }
  };
  std::vector<std::string> words = cup();
  words.emplace_back("space.view={}");
  const ResolvedConfig config = shipped_config("any_side.yaml", words);
  try {
    FromAnySide(config.options, shared_host(), nullptr, std::make_shared<Elsewhere>());
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("space.view: is made of the scene of the config"));
  }
}

TEST(Cubes, HoldWhatIsSolidAndNotWhatItEncloses) {
  const auto scene = scene_of_cup();
  const Cubes cubes(kMiddle, 0.18, 0.004);
  const Cubes::Held truth = cubes.of(*scene);
  const auto volume = [](const Cubes::Held& held) {
    return 0.004 * 0.004 * 0.004 * static_cast<double>(std::count(held.begin(), held.end(), true));
  };
  EXPECT_NEAR(volume(truth), kHalfTurn * (0.04 * 0.04 - 0.03 * 0.03) * 0.06, 9e-6)
      << "of 132 cubic centimetres, to what cubes of 4 mm make of it";
  EXPECT_EQ(intersection_over_union(truth, truth), 1.0);
  EXPECT_EQ(intersection_over_union(truth, Cubes::Held(truth.size())), 0.0);
  EXPECT_EQ(intersection_over_union(Cubes::Held(truth.size()), Cubes::Held(truth.size())), 1.0);
}

TEST(Cubes, OfACompositionAreThoseWhoseCentresThePiecesHold) {
  Random random(9, "test/cubes");
  const Skin nothing(make<Kernel>(shared_host(), "matern32", "{length_scale: 4 cm}"), {0.006, 0.0005});
  const Cubes cubes({0.0, 0.0, 0.1}, 0.12, 0.006);
  for (int i = 0; i < 10; ++i) {
    Composition one;
    for (int k = 0; k < 2; ++k) {
      Piece piece = random_piece(random);
      piece.centre.z() += 0.1;
      one.parts.push_back({piece, {}, {}, 0.0});
    }
    const Cubes::Held held = cubes.of(one, nothing);
    std::size_t index = 0;
    int count = 0;
    for (int x = 0; x < 40; ++x) {
      for (int y = 0; y < 40; ++y) {
        for (int z = 0; z < 37; ++z, ++index) {
          const Vector3d at(-0.117 + 0.006 * x, -0.117 + 0.006 * y, 0.003 + 0.006 * z);
          const bool within = holds(one.parts[0].piece, at) || holds(one.parts[1].piece, at);
          count += held[index] == within ? 0 : 1;
        }
      }
    }
    ASSERT_EQ(index, held.size());
    EXPECT_EQ(count, 0);
  }
}

TEST(Cubes, AreFewerOrMoreByWhatTheSkinAdds) {
  Composition ball;
  ball.parts.push_back(
      {{Piece::Form::ellipsoid, {0, 0, 0.1}, Eigen::Matrix3d::Identity(), {0.05, 0.05, 0.05}, 0.0}, {}, {}, 0.0});
  Skin skin(make<Kernel>(shared_host(), "matern32", "{length_scale: 8 cm}"), {0.006, 0.0005});
  std::vector<SurfaceTouch> touches;  // 4 mm outside all around
  Random random(10, "test/cubes");
  for (int i = 0; i < 150; ++i) {
    const Vector3d out = random_direction(random);
    touches.push_back({{Vector3d(0, 0, 0.1) + 0.154 * out, -out}, 0.1, true, false});
  }
  skin.fit(ball, touches);
  const Cubes::Held held = Cubes({0, 0, 0.1}, 0.12, 0.003).of(ball, skin);
  const double volume = 2.7e-8 * static_cast<double>(std::count(held.begin(), held.end(), true));
  EXPECT_NEAR(std::cbrt(volume * 3 / (4 * kHalfTurn)), 0.054, 5e-4);
}

TEST(Cubes, OfPiecesSideBySideHaveWhatTheSkinAddsToEach) {
  // Two plates that face y, from -4.5 to 0.5 mm and from 7 to 9 mm. The first is 2.5 mm farther out in front.
  Composition plates;
  for (const auto& [middle, half] : {std::pair(-0.002, 0.0025), {0.008, 0.001}}) {
    const Piece plate{Piece::Form::box, {0, middle, 0.06}, Eigen::Matrix3d::Identity(), {0.048, half, 0.048}, 0.0};
    plates.parts.push_back({plate, {}, {}, 0.0});
  }
  std::vector<SurfaceTouch> touches;
  for (int x = -4; x <= 4; ++x) {
    for (int z = 2; z <= 10; ++z) {
      touches.push_back({{{0.01 * x, 0.0065, 0.01 * z}, {0, -1, 0}}, 0.0035, true, false});
      touches.push_back({{{0.01 * x, 0.2, 0.01 * z}, {0, -1, 0}}, 0.191, true, false});
    }
  }
  Skin skin(make<Kernel>(shared_host(), "matern32", "{length_scale: 1 cm}"), {0.006, 0.0001});
  skin.fit(plates, touches);
  const Cubes::Held held = Cubes({0, 0, 0.06}, 0.08, 0.004).of(plates, skin);
  // Centres at y = -2 and 2 mm, 24 across and 24 up, but for some at the corners, far from contacts. Those at 10 mm,
  // half as many, would be solid with what is added to the other.
  EXPECT_NEAR(static_cast<double>(std::count(held.begin(), held.end(), true)), 2 * 24 * 24, 24);
}

TEST(Scene, TellsWhichPartsOfALineLieInItsObjectsAlsoWhereTheyOverlap) {
  const auto scene = scene_of_cup();
  const std::vector<Stretch> across = scene->stretches({{0.0, 0.13, 0.05}, {1.0, 0.0, 0.0}});
  ASSERT_EQ(across.size(), 2U);
  EXPECT_NEAR(across[0].begin, 0.09, 1e-12);
  EXPECT_NEAR(across[0].end, 0.10, 1e-12);
  EXPECT_NEAR(across[1].begin, 0.16, 1e-12);
  EXPECT_NEAR(across[1].end, 0.17, 1e-12);
  EXPECT_TRUE(scene->stretches({{0.0, 0.13, 0.09}, {1.0, 0.0, 0.0}}).empty());
  const std::vector<Stretch> all = joined({{0.3, 0.4}, {0.0, 0.1}, {0.05, 0.2}, {0.1, 0.12}});
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0].end, 0.2);
  EXPECT_EQ(all[1].begin, 0.3);
}

/// Contacts with a box from all sides but below, as they would be without noise.
std::vector<SurfaceTouch> touches_of(const Piece& box, int count) {
  Random random(7, "test/solids");
  std::vector<SurfaceTouch> out;
  while (static_cast<int>(out.size()) < count) {
    Vector3d direction = random_direction(random);
    direction.z() = -std::abs(direction.z());
    const Line line{box.centre + 0.06 * random.uniform() * random_direction(random) - 0.3 * direction, direction};
    const double desk = -line.origin.z() / direction.z();
    out.push_back({line, std::min(box.first_hit(line), desk), true, desk <= box.first_hit(line)});
  }
  return out;
}

TEST(Solids, GoOnWhereNoCompositionIsPossibleAtAll) {
  const Piece box{Piece::Form::box, {0.13, 0.13, 0.03}, Eigen::Matrix3d::Identity(), {0.05, 0.03, 0.03}, 0.0};
  SolidsSettings settings;
  settings.count = 4;
  settings.moves = 20;
  settings.misfit = 1e-200;
  Solids solids({0.26, 0.26}, settings, Random(7, "solids"));
  for (const SurfaceTouch& touch : touches_of(box, 5)) solids.add({touch});
  EXPECT_EQ(solids.compositions().size(), 4U);
  EXPECT_THROW(shipped_config("any_side.yaml", {"space.misfit=1e-200m"}), Error);
}

TEST(Solids, MakeNoPieceOfOneContactInTheAirWhereATouchMayBeALie) {
  const Piece box{Piece::Form::box, {0.13, 0.13, 0.03}, Eigen::Matrix3d::Identity(), {0.05, 0.03, 0.03}, 0.0};
  const Vector3d air(0.15, 0.14, 0.16);
  int made = 0, made_of_lies = 0;
  for (const double most : {kNoHit, 5.5}) {
    for (const std::uint64_t seed : {1, 2, 3, 4}) {
      SolidsSettings settings;
      settings.count = 8;
      settings.moves = 300;
      settings.most = most;
      Solids solids({0.26, 0.26}, settings, Random(seed, "solids"));
      std::vector<SurfaceTouch> touches = touches_of(box, 30);
      touches.insert(touches.begin() + 15, {{air + Vector3d(0, 0, 0.1), -Vector3d::UnitZ()}, 0.1, true, false});
      for (const SurfaceTouch& touch : touches) solids.add({touch});
      (most < kNoHit ? made : made_of_lies) += solids.best().distance(air) < 0.01 ? 1 : 0;
    }
  }
  EXPECT_GE(made_of_lies, 3) << "a contact that is no lie is of something";
  EXPECT_LE(made, 1);
}

TEST(Solids, AreWeighedByTouchesAsTheyAreReadNow) {
  const Piece box{Piece::Form::box, {0.13, 0.13, 0.03}, Eigen::Matrix3d::Identity(), {0.05, 0.03, 0.03}, 0.0};
  SolidsSettings settings;
  settings.count = 6;
  settings.moves = 100;
  Solids solids({0.26, 0.26}, settings, Random(7, "solids"));
  std::vector<SurfaceTouch> touches = touches_of(box, 12);
  for (const SurfaceTouch& touch : touches) solids.add({touch});
  for (SurfaceTouch& touch : touches) touch.length -= 0.004;
  solids.read_again(touches, 0.003, kNoHit);
  for (const Composition& one : solids.compositions()) {
    double likelihood = 0.0;
    for (const SurfaceTouch& touch : touches) {
      double reach = touch.desk ? 0.0 : 0.3;
      if (!touch.desk) reach = std::min(reach, std::abs(one.distance(touch.end())));
      double depth = 0.0;
      for (const Composition::Part& part : one.parts)
        depth = std::max(depth, part.depth[static_cast<std::size_t>(&touch - touches.data())]);
      likelihood -= 2.0 * std::log1p((reach * reach + depth * depth) / (3.0 * 0.003 * 0.003));
    }
    EXPECT_NEAR(one.likelihood, likelihood, 1e-9);
  }
}

}  // namespace
}  // namespace palpate::test
