// SPDX-License-Identifier: MIT
// Every kind of broken mesh file is refused in one line that names the file, the reason and, where there is one, the
// remedy.
#include "support/sanitizers.hpp"
#include "support/tessellate.hpp"
#include "support/testing.hpp"

#include <palpate/shape.hpp>

#include <cstdint>
#include <cstring>
#include <tuple>

namespace palpate::test {
namespace {

using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

/// A block of 80 by 50 by 30 mm: 12 triangles.
Surface block() {
  return raised(
      {-0.04, 0.04}, {-0.025, 0.025}, [](double, double) { return true; }, 0.03);
}

class MeshFile : public InFolder {
 protected:
  /// What is said of a file with this content; "accepted" if nothing is.
  std::string refusal(const std::string& name, const std::string& content, const std::string& more = "unit: 1 mm") {
    return refusal_of(folder_.write(name, content), more);
  }

  std::string refusal_of(const fs::path& file, const std::string& more = "unit: 1 mm") {
    const std::string line =
        error_of([&] { make<Shape>(shared_host(), "mesh", "{file: '" + file.string() + "', " + more + "}"); });
    EXPECT_EQ(line.find('\n'), std::string::npos);
    EXPECT_THAT(line, testing::AnyOf("accepted", HasSubstr(file.string() + ": ")));
    return line;
  }
};

TEST_F(MeshFile, IsAcceptedInEachFormatWhenItIsWhole) {
  EXPECT_EQ(refusal("a.stl", stl_binary(block())), "accepted");
  EXPECT_EQ(refusal("b.STL", stl_text(block())), "accepted") << "whatever the case of its ending";
  EXPECT_EQ(refusal("c.obj", obj(block())), "accepted") << "without the file of its materials";
  EXPECT_EQ(refusal("d.ply", ply(block())), "accepted");
}

TEST_F(MeshFile, IsAcceptedWithFacesOfManyCorners) {
  EXPECT_EQ(refusal("a.obj",
                    "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nv 0 0 9\nv 9 0 9\nv 9 9 9\nv 0 9 9\n"
                    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"),
            "accepted");
}

TEST_F(MeshFile, IsReadAsOtherProgramsWriteItToo) {
  const std::string mark = "\xef\xbb\xbf";
  std::string capitals = stl_text(block());
  std::transform(capitals.begin(), capitals.end(), capitals.begin(), [](unsigned char c) { return std::toupper(c); });
  EXPECT_EQ(refusal("a.stl", capitals), "accepted");
  EXPECT_EQ(refusal("b.stl", mark + stl_text(block())), "accepted");
  EXPECT_EQ(refusal("c.stl", stl_binary(block()) + std::string("made by x\0", 10)), "accepted");
  EXPECT_EQ(refusal("d.obj", mark + obj(block())), "accepted");
  const std::string whole = ply(block());
  EXPECT_EQ(refusal("e.ply", mark + whole), "accepted");
  std::string blanks = whole;
  const std::size_t body = whole.find("end_header");
  for (std::size_t at = body + 10; at != std::string::npos;
       at = at == 0 ? std::string::npos : blanks.rfind('\n', at - 1))
    blanks.insert(at, " \t");
  EXPECT_EQ(refusal("f.ply", blanks), "accepted");
  std::string first = whole;
  const std::size_t vertices = first.find("element vertex");
  const std::size_t header = first.find("end_header\n") + 11;
  first.insert(header, "0.5 3 1 2 3\n0.25 0\n");
  first.insert(vertices, "element camera 2\nproperty float focus\nproperty list uchar int lens\n");
  EXPECT_EQ(refusal("g.ply", first), "accepted");
}

TEST_F(MeshFile, ThatIsMissingSaysWhereRelativePathsStart) {
  EXPECT_THAT(refusal_of("not_there.stl"),
              AllOf(HasSubstr("no such file, a relative path starts in the current folder, "),
                    EndsWith(fs::current_path().string())));
  EXPECT_THAT(refusal_of("/not_there.stl"), EndsWith("/not_there.stl: no such file"));
}

TEST_F(MeshFile, ThatIsNoFileIsRefused) {
  fs::create_directory(folder_.path() / "a.stl");
  EXPECT_THAT(refusal_of(folder_.path() / "a.stl"), HasSubstr("not a regular file"));
}

TEST_F(MeshFile, OfNothingGarbageAnotherFormatOrNoTrianglesIsRefused) {
  std::string garbage;
  for (int i = 0; i < 3000; ++i) garbage += static_cast<char>(i * 7919 % 251);
  const std::tuple<const char*, std::string, const char*> cases[] = {
      {"a.3mf", "PK", "the format '.3mf' is not supported, export it as .stl, .obj or .ply"},
      {"a", "solid", "has no file extension"},
      {"a.stl", "", "is empty, export"},
      {"a.obj", "", "is empty, export"},
      {"a.ply", "", "is empty, export"},
      {"a.stl", garbage, "is not an STL file, neither text nor binary, or is cut short"},
      {"a.ply", garbage, "is not a PLY file or is cut short: the line 'end_header' is missing"},
      {"b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n", "has no triangles"},
      {"a.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nelement face 2\n"
       "property list uchar int vertex_indices\nend_header\nabcdef",
       "cannot be read as ply: assimp crashed while reading it, export it again"}};
  for (const auto& [name, content, words] : cases) EXPECT_THAT(refusal(name, content), HasSubstr(words));
  EXPECT_NE(refusal("a.obj", garbage), "accepted");
  EXPECT_NE(refusal("a.stl", "solid nothing\nendsolid nothing\n"), "accepted");
  EXPECT_NE(refusal("b.stl", std::string(84, '\0')), "accepted");
  EXPECT_NE(refusal("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "accepted");
}

TEST_F(MeshFile, CutShortAnywhereIsRefused) {
  // A cut within the last line break or word may leave all that counts.
  const std::string binary = stl_binary(block());
  for (std::size_t n = 1; n < binary.size(); n += 13) EXPECT_NE(refusal("a.stl", binary.substr(0, n)), "accepted") << n;
  const std::string text = stl_text(block());
  for (std::size_t n = 1; n + 14 < text.size(); n += 29)
    EXPECT_NE(refusal("b.stl", text.substr(0, n)), "accepted") << n;
  for (const auto& [name, whole] : {std::pair("c.obj", obj(block())), std::pair("d.ply", ply(block()))}) {
    for (std::size_t n = 1; n + 3 < whole.size(); n += 11)
      EXPECT_NE(refusal(name, whole.substr(0, n)), "accepted") << n;
  }
}

TEST_F(MeshFile, OfAnyLineEndMeansTheSame) {
  const std::string whole = ply(block());
  for (const char* end : {"\r", "\r\n"}) {
    std::string other;
    for (const char c : whole) other += c == '\n' ? end : std::string(1, c);
    const std::string header = other.substr(0, other.find("end_header"));
    EXPECT_THAT(refusal("a.ply", header + "end_header" + end + "0 0 0" + end),
                HasSubstr("is cut short: its header announces more rows than there are"));
    EXPECT_THAT(refusal("a.ply", header + "\nend_header\n0 0 0\n"), HasSubstr("is cut short: its header announces"));
    EXPECT_EQ(refusal("a.ply", other), "accepted");
  }
}

TEST_F(MeshFile, WhoseHeaderCountsNoRowsIsRefused) {
  const std::string whole = ply(block());
  const std::size_t at = whole.find("element vertex ") + 15;
  for (const char* count : {"-5", "4e9", "9999999999", ""}) {
    std::string other = whole;
    other.replace(at, other.find('\n', at) - at, count);
    EXPECT_THAT(refusal("a.ply", other), HasSubstr("its header does not give the number of rows of 'vertex'"));
  }
}

TEST_F(MeshFile, ThatTakesFarMoreMemoryThanItsSizeIsRefused) {
  if (kSanitized) GTEST_SKIP() << "memory cannot be limited there";
  // One face of as many corners: 12 bytes for each.
  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nelement face 1\n"
      "property list uint uint vertex_indices\nend_header\n";
  const std::uint32_t corners = 400'000'000;
  bytes.append(4, '\0');
  bytes.append(reinterpret_cast<const char*>(&corners), sizeof corners);
  bytes.append(16, '\0');
  EXPECT_THAT(refusal("a.ply", bytes), HasSubstr("needs more memory than any valid file of its size, export it again"));
}

TEST_F(MeshFile, WithATriangleTwiceIsRefused) {
  Surface surface = block();
  const auto [a, b, c] = surface.triangles[0];
  surface.triangles.push_back({b, a, c});
  EXPECT_THAT(refusal("a.stl", stl_binary(surface)), HasSubstr("a triangle occurs twice, at ("));
}

TEST_F(MeshFile, WithACoordinateThatIsNotFiniteIsRefused) {
  std::string binary = stl_binary(block());
  const float bad = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(&binary[84 + 2 * 50 + 12], &bad, sizeof bad);
  EXPECT_THAT(refusal("a.stl", binary), HasSubstr("triangle 3 has a coordinate that is not a finite number"));
}

TEST_F(MeshFile, WithTrianglesWithoutAreaIsRefused) {
  Surface surface = block();
  surface.triangles.push_back({0, 1, 1});
  surface.points.push_back((surface.points[0] + surface.points[1]) / 2);
  surface.triangles.push_back({0, 1, surface.points.size() - 1});
  EXPECT_THAT(refusal("a.stl", stl_binary(surface)),
              AllOf(HasSubstr("2 of 14 triangles have no area, the first is triangle 13 at ("),
                    EndsWith("remove degenerate triangles in the program that made the mesh")));
}

TEST_F(MeshFile, WithAHoleIsRefusedUnlessItIsAllowed) {
  Surface surface = block();
  surface.triangles.erase(surface.triangles.begin());
  EXPECT_THAT(refusal("a.ply", ply(surface)),
              AllOf(HasSubstr("has holes: 3 edges belong to one triangle only, one from ("),
                    EndsWith("close them in the program that made the mesh, or write `holes: allow`")));
  EXPECT_EQ(refusal("a.ply", ply(surface), "unit: 1 mm, holes: allow"), "accepted");
}

TEST_F(MeshFile, OfAnUnlikelySizeAsksForTheUnit) {
  EXPECT_THAT(refusal("a.stl", stl_binary(block()), "unit: 1 m"),
              HasSubstr("is 80 m large, at most 2 m are allowed, is the unit of 1 m right?"));
  EXPECT_THAT(refusal("a.stl", stl_binary(block()), "unit: 1 um"),
              HasSubstr("is 8e-05 m large, at least 1 mm is needed, is the unit of 1e-06 m right?"));
}

TEST_F(MeshFile, FarFromItsOriginIsRefused) {
  Surface surface = block();
  for (Eigen::Vector3d& point : surface.points) point.x() += 100.0;
  EXPECT_THAT(refusal("a.ply", ply(surface)),
              HasSubstr("lies 100 m from its origin, where single precision has errors"));
}

TEST_F(MeshFile, WithTooManyTrianglesOrBytesIsRefusedBeforeItIsRead) {
  std::string header(80, ' ');
  const std::uint32_t count = 5'000'001;
  header.append(reinterpret_cast<const char*>(&count), sizeof count);
  const fs::path many = folder_.write("a.stl", header);
  fs::resize_file(many, 84 + std::uintmax_t{50} * count);
  EXPECT_THAT(refusal_of(many), HasSubstr("has 5000001 triangles, at most 5000000 are read, reduce their number"));
  fs::resize_file(many, 600'000'000);
  EXPECT_THAT(refusal_of(many), HasSubstr("is larger than 500 MB, reduce its content"));
}

TEST_F(MeshFile, IsKnownAgainByItsChecksum) {
  const fs::path file = folder_.write("a.ply", ply(block()));
  const auto choice = [&](const std::string& more) {
    return choose(shared_host(), "shape", "mesh", "{file: '" + file.string() + "', unit: 1 mm" + more + "}");
  };
  const PluginChoice before = choice("");
  const std::string checksum = before.options->find("checksum")->text;
  EXPECT_EQ(checksum.size(), 32U);
  EXPECT_EQ(choice(", checksum: '" + checksum + "'").options->find("checksum")->text, checksum);
  folder_.write("a.ply", ply(block()) + "\n");
  EXPECT_NE(choice("").options->find("checksum")->text, checksum);
  // Whether it was another when the config was resolved, or only since.
  const auto refusal_to_build = [&](const PluginChoice& one) {
    return error_of([&] { context_of(shared_host()).create<Shape>(one); });
  };
  const std::string other = "shape/mesh: checksum: does not match " + file.string();
  EXPECT_THAT(refusal_to_build(choice(", checksum: '" + checksum + "'")),
              AllOf(StartsWith("options.yaml:1:"), HasSubstr(other)));
  EXPECT_THAT(refusal_to_build(before), StartsWith(other));
  fs::remove(file);
  EXPECT_THAT(error_of([&] { choice(""); }),
              AllOf(StartsWith("options.yaml:1:"), HasSubstr("plugin.file: " + file.string() + ": no such file")));
  EXPECT_THAT(refusal_to_build(choice(", checksum: '" + checksum + "'")),
              AllOf(StartsWith("options.yaml:1:"), HasSubstr("shape/mesh: file: " + file.string() + ": no such file")));
}

TEST_F(MeshFile, MustHaveItsUnitGiven) {
  const fs::path file = folder_.write("a.ply", ply(block()));
  EXPECT_EQ(error_of([&] { choose(shared_host(), "shape", "mesh", "{file: '" + file.string() + "'}"); }),
            "options.yaml:1:1: 'plugin.unit' is missing, set it: length of one unit of the file, for example 1 mm");
}

}  // namespace
}  // namespace palpate::test
