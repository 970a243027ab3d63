// SPDX-License-Identifier: MIT
// PLY as other programs read it.
#include "report/mesh_export.hpp"
#include "support/grids.hpp"
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

namespace palpate {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

ReconstructedSurface two_by_two(bool with_truth) {
  const CandidateGrid candidates = test::product_grid(Eigen::Vector2d(0.1, 0.3), Eigen::Vector2d(0.2, 0.7));
  ReconstructedSurface out{
      surface_mesh(candidates, Eigen::Vector4d(0.0, 1.0 / 3.0, -0.0625, 1e-17), Eigen::Vector4d(0.5, 0.25, 1e-5, 0.0)),
      Eigen::Vector4d(-0.125, 0.5, 1.5, 0.0), std::nullopt};
  if (with_truth) out.true_height = Eigen::Vector4d(0.0, 0.0, 0.5, 0.0);
  return out;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

TEST(SurfacePly, DeclaresWhatItHoldsAndHoldsWhatItDeclares) {
  const std::vector<std::string> lines = lines_of(surface_ply(two_by_two(true), "run of\na test"));
  ASSERT_EQ(lines.size(), 17U + 4U + 2U);
  EXPECT_THAT(std::vector<std::string>(lines.begin(), lines.begin() + 17),
              ElementsAre("ply", "format ascii 1.0", "comment palpate, run of?a test",
                          "comment lengths in metres; quality: standard deviation of the height", "element vertex 4",
                          "property double x", "property double y", "property double z", "property double nx",
                          "property double ny", "property double nz", "property float quality",
                          "property float object_probability", "property float true_height", "element face 2",
                          "property list uchar int vertex_indices", "end_header"));
  std::istringstream second(lines[18]);
  double x, y, z, nx, ny, nz, quality, probability, truth;
  second >> x >> y >> z >> nx >> ny >> nz >> quality >> probability >> truth;
  EXPECT_TRUE(second && second.eof()) << lines[18];
  EXPECT_EQ(x, 0.3);
  EXPECT_EQ(y, 0.2);
  EXPECT_EQ(z, 1.0 / 3.0);
  EXPECT_EQ(quality, 0.25);
  EXPECT_EQ(probability, 0.5);
  EXPECT_EQ(truth, 0.0);
  EXPECT_EQ(lines[21], "3 0 1 3");
  EXPECT_EQ(lines[22], "3 0 3 2");
}

TEST(SurfacePly, LeavesOutTruthThatIsNotKnownAndFacesThatAreNotThere) {
  EXPECT_THAT(surface_ply(two_by_two(false), "run"), Not(HasSubstr("true_height")));
  const CandidateGrid one = test::product_grid(Eigen::VectorXd::Constant(1, 0.1), Eigen::VectorXd::Constant(1, 0.2));
  const Eigen::VectorXd value = Eigen::VectorXd::Constant(1, 0.5);
  const std::string ply = surface_ply({surface_mesh(one, value, value), value, std::nullopt}, "run");
  EXPECT_THAT(ply, Not(HasSubstr("element face")));
  EXPECT_THAT(ply, HasSubstr("end_header\n0.1 0.2 0.5 0 0 1 0.5 0.5\n"));
}

TEST(HeaderText, IsOneLineThatEndsNoHeader) {
  EXPECT_EQ(header_text("plain name-1.2"), "plain name-1.2");
  EXPECT_EQ(header_text("a\nelement vertex 7\r\tb\x7f"), "a?element vertex 7??b?");
  EXPECT_EQ(header_text("gr\xc3\xb6\xc3\x9f"
                        "e"),
            "gr????e")
      << "headers are ASCII";
  EXPECT_EQ(header_text("an end_header, end_headerend_header"), "an end header, end headerend header");
  EXPECT_EQ(header_text(std::string(5000, 'n')), std::string(200, 'n'));
}

}  // namespace
}  // namespace palpate
