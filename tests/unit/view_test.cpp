// SPDX-License-Identifier: MIT
// What a camera saw before the first tap: its file, what is made of it, and what it is worth.
#include "belief/camera_view.hpp"

#include "support/runs.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>

namespace palpate::test {
namespace {

using testing::HasSubstr;

constexpr double kPi = 3.14159265358979323846;

/// A PLY of these points: floats, with colours, which nobody reads, between them.
std::string ply(const PointCloud& points, const std::string& format) {
  std::string out = fmt::format(
      "ply\nformat {} 1.0\ncomment a view\nelement vertex {}\nproperty float x\nproperty uchar red\n"
      "property float y\nproperty double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n",
      format, points.cols());
  const auto put = [&](const auto& value) {
    const char* const bytes = reinterpret_cast<const char*>(&value);
    std::string some(bytes, sizeof value);
    if (format == "binary_big_endian") std::reverse(some.begin(), some.end());
    out += some;
  };
  for (const auto& point : points.colwise()) {
    if (format == "ascii") {
      out += fmt::format("{} 255 {} {}\n", static_cast<float>(point.x()), static_cast<float>(point.y()), point.z());
    } else {
      put(static_cast<float>(point.x()));
      put(std::uint8_t{255});
      put(static_cast<float>(point.y()));
      put(point.z());
    }
  }
  return out + (format == "ascii" ? "3 0 0 0\n" : std::string("\3\0\0\0\0\0\0\0\0\0\0\0\0", 13));
}

TEST(PointFile, ReadsAsciiAndBothByteOrdersAlike) {
  PointCloud points(3, 3);
  points << 0.125, -1.5, 2.0, 0.5, 0.25, -8.0, 0.0625, 1e-3, 3.0;
  for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    EXPECT_TRUE(read_points(ply(points, format), "view.ply").isApprox(points, 1e-15)) << format;
  }
}

TEST(PointFile, LeavesOutWhatACameraDidNotSee) {
  PointCloud points(3, 3);
  points << 0.1, std::nan(""), 0.3, 0.1, 0.2, 0.3, 0.1, 0.2, HUGE_VAL;
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const PointCloud read = read_points(ply(points, format), "view.ply");
    ASSERT_EQ(read.cols(), 1) << format;
    EXPECT_NEAR(read(0, 0), 0.1, 1e-7);
  }
}

TEST(PointFile, IsReadWhateverElementsStandBesideItsVertices) {
  PointCloud points(3, 2);
  points << 0.1, 0.4, 0.2, 0.5, 0.3, 0.6;
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    std::string file = ply(points, format);
    // Two rows: a short, and a list of 2 and of 0 bytes.
    const std::string rows = format == "ascii"               ? "7 2 1 2\n8 0\n"
                             : format == "binary_big_endian" ? std::string("\0\7\0\2\1\2\0\10\0\0", 10)
                                                             : std::string("\7\0\2\0\1\2\10\0\0\0", 10);
    file.insert(file.find("end_header\n") + 11, rows);
    file.insert(file.find("element vertex"), "element camera 2\nproperty short a\nproperty list ushort uchar b\n");
    const PointCloud read = read_points("\xef\xbb\xbf" + file, "view.ply");
    ASSERT_EQ(read.cols(), 2) << format;
    EXPECT_LT((read - points).norm(), 1e-6) << format;
  }
}

TEST(PointFile, SaysWhatIsWrongWithIt) {
  const PointCloud one = PointCloud::Constant(3, 1, 0.5);
  const auto said = [](const std::string& bytes) { return error_of([&] { read_points(bytes, "view.ply"); }); };
  EXPECT_THAT(said(""), HasSubstr("view.ply: is not a PLY file or is cut short"));
  EXPECT_THAT(said("solid\nend_header\n"), HasSubstr("does not begin with the line 'ply'"));
  EXPECT_THAT(said("ply\nformat ascii 1.0\nend_header\n"), HasSubstr("has no vertices"));
  EXPECT_THAT(said("ply\nformat ascii 1.0\nelement face 2\nproperty int a\nend_header\n1\n2\n"),
              HasSubstr("has no vertices"));
  EXPECT_THAT(said("ply\nformat ascii 1.0\nelement face 2\nproperty int a\nend_header\n1\n"),
              HasSubstr("does not begin with its vertices"))
      << "cut short";
  EXPECT_THAT(said("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n1 2\n"),
              HasSubstr("without x, y and z"));
  EXPECT_THAT(said("ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n"),
              HasSubstr("a property of type 'list'"));
  EXPECT_THAT(said("ply\nformat bits 1.0\nelement vertex 1\nend_header\n"), HasSubstr("the format 'bits'"));
  EXPECT_THAT(said("ply\nelement vertex many\nend_header\n"), HasSubstr("number of vertices"));
  EXPECT_THAT(said("ply\nelement vertex 99999999999\nend_header\n"), HasSubstr("at most 20000000 are read"));
  for (const char* format : {"ascii", "binary_little_endian"}) {
    const std::string whole = ply(one, format);
    const std::size_t body = whole.find("end_header\n") + 11;
    for (std::size_t length = 0; length < body + 10; ++length)
      EXPECT_NE(said(whole.substr(0, length)), "") << format << ", " << length << " bytes";
  }
  EXPECT_THAT(said("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                   "end_header\n1 two 3\n"),
              HasSubstr("a value that is not a number in vertex 1"));
  EXPECT_THAT(said(ply(PointCloud::Constant(3, 2, std::nan("")), "binary_little_endian")),
              HasSubstr("no finite point"));
}

/// What a camera above the scene sees of all places for which `sees` holds: a point every 2 mm, with normal noise, all
/// of them too high by `offset`.
template <class Sees>
PointCloud seen(const Scene& scene, double noise, double offset, const Sees& sees) {
  std::mt19937 engine(7);
  std::normal_distribution<double> normal;
  std::vector<Eigen::Vector3d> points;
  constexpr double kStep = 0.002;
  for (double y = 0.5 * kStep; y < scene.area().depth; y += kStep) {
    for (double x = 0.5 * kStep; x < scene.area().width; x += kStep) {
      if (sees(x, y)) points.emplace_back(x, y, scene.height(x, y) + offset + noise * normal(engine));
    }
  }
  PointCloud out(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) out.col(static_cast<Eigen::Index>(i)) = points[i];
  return out;
}

bool everywhere(double /*x*/, double /*y*/) { return true; }
bool near_half(double /*x*/, double y) { return y < 0.115; }

std::unique_ptr<const Scene> object_i() {
  return build_scene(shipped_config("default.yaml").options.scene, 1, shared_host());
}

TEST(View, TellsHeightsAndLabelsSquareBySquareAndTakesItsOffsetFromTheDesk) {
  const auto scene = object_i();
  PriorOptions options;
  options.bias = 0.01;
  const std::vector<ViewedSquare> squares =
      viewed_squares(seen(*scene, options.noise, 0.008, everywhere), options, *scene);
  int on = 0;
  for (const ViewedSquare& one : squares) {
    const Target& place = one.touch.place;
    const double truth = scene->height(place.x, place.y);
    on += one.touch.on ? 1 : 0;
    EXPECT_EQ(one.touch.on, scene->on_object(truth)) << place.x << ", " << place.y;
    EXPECT_NEAR(one.touch.height, truth - scene->desk(), 3.0 * one.deviation) << place.x << ", " << place.y;
  }
  EXPECT_GE(on, 10);
  EXPECT_GE(squares.size(), 140U) << "of 196 squares: edges are left out";
}

TEST(View, LeavesOutSquaresThatShowNeitherDeskNorObjectClearly) {
  const auto scene = object_i();
  const PriorOptions options;
  const auto all = viewed_squares(seen(*scene, options.noise, 0.0, everywhere), options, *scene);
  EXPECT_LT(all.size(), static_cast<std::size_t>(kSquaresAcross * kSquaresAcross)) << "an outline passes through some";
  const auto half = viewed_squares(seen(*scene, options.noise, 0.0, near_half), options, *scene);
  EXPECT_GE(half.size(), 60U);
  for (const ViewedSquare& one : half) EXPECT_LT(one.touch.place.y, 0.115);
}

TEST(View, IsTurnedAndMovedIntoTheFrameOfTheArea) {
  const auto scene = object_i();
  const PointCloud points = seen(*scene, 0.0, 0.0, everywhere);
  PriorOptions options;
  options.unit = 0.001;
  options.pose.emplace();
  options.pose->x = 0.3;
  options.pose->y = -0.1;
  options.pose->z = 0.9;
  options.pose->roll = kPi;  // a camera that looks down
  options.pose->yaw = 0.4;
  // As the camera has them: the way back, by other means.
  const Eigen::Affine3d camera = Eigen::Translation3d(0.3, -0.1, 0.9) *
                                 Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitZ()) *
                                 Eigen::AngleAxisd(kPi, Eigen::Vector3d::UnitX());
  const PointCloud of_camera = 1000.0 * (camera.inverse() * points);
  EXPECT_TRUE(in_area_frame(of_camera, options).isApprox(points, 1e-12));
}

TEST(View, OfAnotherPlaceIsRefused) {
  const auto scene = object_i();
  const PointCloud far = PointCloud::Constant(3, 5, 9.0);
  EXPECT_THAT(error_of([&] { viewed_squares(far, {}, *scene); }),
              HasSubstr("prior.depth: none of its 5 points is in the area, check unit and pose"));
}

/// Runs of the default on object I whose near half a camera has seen.
class SeenHalf : public testing::Test {
 protected:
  SeenHalf() {
    const auto scene = object_i();
    std::ofstream(file_, std::ios::binary) << ply(seen(*scene, 0.003, 0.004, near_half), "binary_little_endian");
  }
  std::vector<std::string> words(int seed, int taps) const {
    return {"belief.prior={depth: " + file_.string() + "}", fmt::format("seed={}", seed), fmt::format("taps={}", taps)};
  }

  const TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "view.ply";
};

TEST_F(SeenHalf, IsWorthMoreThanTenTaps) {
  if (kSanitized) GTEST_SKIP() << "./check --all makes it in release";
  constexpr int kSeeds = 6;
  double with = 0.0;
  double without = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Finished seeing("default.yaml", words(seed, 10));
    Finished blind("default.yaml", {fmt::format("seed={}", seed), "taps=20"});
    with += *seeing.experiment.result().errors.rmse;
    without += *blind.experiment.result().errors.rmse;
  }
  EXPECT_LE(with, without);
}

TEST_F(SeenHalf, SendsTheTapsWhereTheCameraWasBlind) {
  int far = 0;
  int all = 0;
  for (int seed = 1; seed <= 4; ++seed) {
    const Finished run("default.yaml", words(seed, 6));
    EXPECT_EQ(run.taps.front().request.source, Source::acquisition) << "what the search would look for has been seen";
    for (const TapRecord& tap : run.taps) {
      far += tap.target().y > 0.1 ? 1 : 0;
      ++all;
    }
  }
  EXPECT_GE(far, 3 * all / 4);
}

TEST_F(SeenHalf, IsKnownToEveryModelBeforeTheFirstTap) {
  for (const std::string strategy : {"default", "weighted", "uncertainty", "weighted_two_part"}) {
    Prepared prepared("default.yaml", {"strategy=" + strategy, "backend=simulator", words(1, 5).front(), "taps=5"});
    prepared.read({quantity::kUncertainty, quantity::kObjectProbability, quantity::kHeightMean});
    const HeightMapBelief& belief = prepared.belief();
    double near = 0.0;
    double far = 0.0;
    for (int i = 0; i < prepared.grid().size(); ++i)
      (prepared.grid().target(i).y < 0.1 ? near : far) += belief.values(quantity::kUncertainty)(i);
    EXPECT_LT(near, 0.5 * far) << strategy;
    EXPECT_GT(belief.values(quantity::kObjectProbability).maxCoeff(), 0.8) << strategy;
    EXPECT_TRUE(belief.taps().readings.empty()) << "no tap has been made";
    prepared.run();
    EXPECT_EQ(prepared.taps.size(), 5U) << strategy;
  }
}

TEST_F(SeenHalf, IsKnownToAResumedRunAsToTheUnbrokenOne) {
  Finished whole("default.yaml", words(2, 9));
  Prepared again("default.yaml", words(2, 9));
  again.experiment.resume(whole.past(5));
  again.run();
  ASSERT_EQ(again.taps.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(again.taps[i].candidate, whole.taps[5 + i].candidate);
    EXPECT_EQ(again.taps[i].score, whole.taps[5 + i].score);
  }
}

TEST_F(SeenHalf, EntersTheIdByItsContent) {
  const std::string before = shipped_config("default.yaml", words(1, 5)).id;
  EXPECT_NE(before, shipped_config("default.yaml", {"seed=1", "taps=5"}).id);
  std::ofstream(file_, std::ios::app) << "comment";
  EXPECT_NE(before, shipped_config("default.yaml", words(1, 5)).id);
  EXPECT_THAT(error_of([&] { shipped_config("default.yaml", {"belief.prior={depth: nowhere.ply}"}); }),
              HasSubstr("nowhere.ply: no such file"));
}

}  // namespace
}  // namespace palpate::test
