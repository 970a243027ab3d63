// SPDX-License-Identifier: MIT
// `palpate export`: what other programs read of it, and that a record is never overwritten.
#include "support/support.hpp"
#include "system/shipped.hpp"

#include <assimp/scene.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

namespace palpate {
namespace {

using test::Cells;
using test::csv_rows;
using test::Ended;
using test::only_run;
using test::paper;
using test::TemporaryFolder;
using test::text_of;
using ::testing::HasSubstr;
using ::testing::Not;

namespace fs = std::filesystem;

class Export : public ::testing::Test {
 protected:
  fs::path run(const std::vector<std::string>& words = {}) {
    std::vector<std::string> all{"run", paper(), "--quiet"};
    all.insert(all.end(), words.begin(), words.end());
    EXPECT_EQ(palpate(all).err, "");
    return only_run(folder_.path() / "runs");
  }
  Ended palpate(const std::vector<std::string>& words) const {
    return test::palpate(words, folder_.path(),
                         {"PALPATE_PLUGIN_PATH=" + test::bad_plugin_folder("cannot_go_on").string()});
  }
  Ended exported(const fs::path& directory, const std::string& format,
                 const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{"export", directory.string(), "--format", format};
    all.insert(all.end(), more.begin(), more.end());
    return palpate(all);
  }

  /// The surface that is exported is that of the record, to the last bit.
  void expect_numbers_of_record(const fs::path& directory) const {
    ASSERT_EQ(exported(directory, "csv").status, 0);
    const std::vector<Cells> recorded = csv_rows(text_of(directory / "surface.csv"));
    const std::vector<Cells> surface = csv_rows(text_of(directory / "export" / "surface.csv"));
    ASSERT_EQ(surface.size(), recorded.size());
    for (std::size_t i = 0; i < surface.size(); ++i) {
      for (const auto& [name, column] : {std::pair{"x", "x"},
                                         {"y", "y"},
                                         {"z", "reconstructed_height"},
                                         {"standard_deviation", "height_standard_deviation"},
                                         {"on_surface_probability", "on_surface_probability"},
                                         {"true_height", "true_height"}}) {
        ASSERT_EQ(std::stod(surface[i].at(name)), std::stod(recorded[i].at(column))) << name << " of candidate " << i;
      }
    }
  }

  TemporaryFolder folder_;
};

float single(const std::string& cell) { return static_cast<float>(std::stod(cell)); }

/// The single mesh of a file, as assimp reads it without changing anything.
const aiMesh& only_mesh(Assimp::Importer& importer, const fs::path& file) {
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene == nullptr || scene->mNumMeshes != 1) throw std::runtime_error(importer.GetErrorString());
  return *scene->mMeshes[0];
}

TEST_F(Export, WritesASurfaceThatAssimpReadsVertexByVertex) {
  const fs::path directory = run();
  const Ended ended = exported(directory, "ply");
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  const fs::path file = directory / "export" / "surface.ply";
  EXPECT_EQ(ended.out, file.string() + "\n" + (directory / "export" / "taps.ply").string() + "\n");

  Assimp::Importer importer;
  const aiMesh& mesh = only_mesh(importer, file);
  const std::vector<Cells> surface = csv_rows(text_of(directory / "surface.csv"));
  ASSERT_EQ(mesh.mNumVertices, 47U * 47U);
  ASSERT_EQ(mesh.mNumFaces, 2U * 46U * 46U);
  ASSERT_EQ(surface.size(), 47U * 47U);
  ASSERT_TRUE(mesh.HasNormals());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D& at = mesh.mVertices[i];
    ASSERT_FLOAT_EQ(at.x, single(surface[i].at("x")));
    ASSERT_FLOAT_EQ(at.y, single(surface[i].at("y")));
    ASSERT_NEAR(at.z, single(surface[i].at("reconstructed_height")), 1e-9);
    ASSERT_NEAR(mesh.mNormals[i].Length(), 1.0F, 1e-6F);
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    ASSERT_EQ(face.mNumIndices, 3U);
    const aiVector3D& a = mesh.mVertices[face.mIndices[0]];
    const aiVector3D across = (mesh.mVertices[face.mIndices[1]] - a) ^ (mesh.mVertices[face.mIndices[2]] - a);
    ASSERT_GT(across.z, 0.0F) << "triangles look upward";
    for (unsigned i = 0; i < 3; ++i) ASSERT_GT(mesh.mNormals[face.mIndices[i]].z, 0.0F);
  }
}

TEST_F(Export, WritesTheNumbersOfTheRecordToTheLastBit) { expect_numbers_of_record(run({"surface=two_part"})); }

TEST_F(Export, WritesTheProbabilityOfTheFootprint) {
  const fs::path directory = run({"surface=two_part", "footprint=shape"});
  expect_numbers_of_record(directory);
  EXPECT_THAT(text_of(directory / "summary.json"), HasSubstr("\"mistakes\": ")) << "it is not the weight";
}

TEST_F(Export, WritesContactsAsPointsAndFailedTapsInTheTableAlone) {
  const fs::path directory = run({"scene.effects={missed_contacts: {probability: 0.3}}"});
  ASSERT_EQ(exported(directory, "csv").status, 0);
  ASSERT_EQ(exported(directory, "ply", {"--to", "elsewhere/deep"}).status, 0);
  const std::vector<Cells> recorded = csv_rows(text_of(directory / "taps.csv"));
  const std::vector<Cells> taps = csv_rows(text_of(directory / "export" / "taps.csv"));
  ASSERT_EQ(taps.size(), 17U);
  std::vector<Cells> contacts;
  for (std::size_t i = 0; i < taps.size(); ++i) {
    for (const char* name : {"tap", "source", "x", "y", "outcome", "reason", "on_surface", "force", "robot_seconds"})
      EXPECT_EQ(taps[i].at(name), recorded[i].at(name));
    EXPECT_EQ(taps[i].at("z"), recorded[i].at("height"));
    EXPECT_EQ(taps[i].at("run"), "object_i");
    EXPECT_EQ(taps[i].at("id"), directory.filename());
    if (taps[i].at("outcome") == "contact") contacts.push_back(taps[i]);
  }
  ASSERT_LT(contacts.size(), 17U) << "some taps failed";

  const fs::path file = folder_.path() / "elsewhere" / "deep" / "taps.ply";
  const std::string ply = text_of(file);
  EXPECT_THAT(ply, HasSubstr("element vertex " + std::to_string(contacts.size()) + "\n"));
  std::string points;
  for (const Cells& tap : contacts) {
    points += tap.at("x") + " " + tap.at("y") + " " + tap.at("z") + " " + tap.at("tap") + " " +
              (tap.at("on_surface") == "true" ? "1" : "0") + "\n";
  }
  EXPECT_EQ(ply.substr(ply.find("end_header\n") + 11), points);
  Assimp::Importer importer;
  const aiMesh& mesh = only_mesh(importer, file);
  ASSERT_EQ(mesh.mNumVertices, contacts.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    EXPECT_FLOAT_EQ(mesh.mVertices[i].x, single(contacts[i].at("x")));
    EXPECT_NEAR(mesh.mVertices[i].z, single(contacts[i].at("z")), 1e-9);
  }
}

TEST_F(Export, OfARunWithAnyNameIsReadByPythonAndByAssimp) {
  const fs::path directory =
      run({"name=\"a \\\"quoted\\\" name, with commas\\nelement vertex 3\\nend_header\\n1 2 3\\ttail \\u00f6\""});
  ASSERT_EQ(exported(directory, "csv").status, 0);
  ASSERT_EQ(exported(directory, "ply").status, 0);
  const char* const reader = R"(
import csv, json, sys
taps = [json.loads(line) for line in open(sys.argv[1] + '/taps.jsonl')]
rows = list(csv.DictReader(open(sys.argv[1] + '/export/taps.csv', newline='', encoding='utf-8')))
name = json.load(open(sys.argv[1] + '/summary.json', encoding='utf-8'))['name']
assert len(name.splitlines()) == 4 and len(rows) == len(taps) == 17
for tap, row in zip(taps, rows):
    assert row['run'] == name
    assert int(row['tap']) == tap['tap'] and row['source'] == tap['source']
    for cell, field in (('x', 'x'), ('y', 'y'), ('z', 'height'), ('robot_seconds', 'robot_seconds')):
        assert float(row[cell]) == tap[field], (cell, row, tap)
surface = list(csv.DictReader(open(sys.argv[1] + '/export/surface.csv', newline='')))
for row in surface:
    assert abs(sum(float(row['normal_' + axis]) ** 2 for axis in 'xyz') - 1) < 1e-12
header = open(sys.argv[1] + '/export/surface.ply', 'rb').read().split(b'end_header')[0].decode('ascii').splitlines()
assert [line for line in header if line.startswith('element')] == ['element vertex 2209', 'element face 4232']
print(len(surface), 'candidates')
)";
  const Ended ended = test::run_program({"python3", "-SEc", reader, directory.string()}, folder_.path());
  EXPECT_EQ(ended.out, "2209 candidates\n") << ended.err;
  Assimp::Importer importer;
  EXPECT_EQ(only_mesh(importer, directory / "export" / "surface.ply").mNumVertices, 2209U);
}

TEST_F(Export, OfARunThatIsNotDoneSaysWhatItStandsOn) {
  const fs::path directory = run();
  ASSERT_EQ(exported(directory, "csv").status, 0);
  const std::string whole = text_of(directory / "export" / "surface.csv");
  const std::string record = text_of(directory / "taps.jsonl");
  std::string cut = record;
  for (int i = 0; i < 6; ++i) cut = cut.substr(0, cut.rfind('\n', cut.size() - 2) + 1);
  std::ofstream(directory / "taps.jsonl") << cut;
  fs::remove(directory / "summary.json");
  const Ended ended = exported(directory, "csv");
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err, "this run is unfinished; what is written is what its first 11 taps tell\n");
  EXPECT_EQ(csv_rows(text_of(directory / "export" / "taps.csv")).size(), 11U);
  EXPECT_TRUE(text_of(directory / "export" / "surface.csv") != whole);
}

TEST_F(Export, OfARunThatFailedSaysSoAndLeavesOutATruthThatNobodyKnows) {
  ASSERT_EQ(palpate({"run", paper(), "backend.type=cannot_go_on", "--quiet"}).status, 1);
  const fs::path directory = only_run(folder_.path() / "runs");
  const Ended ended = exported(directory, "ply");
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err,
            "this run failed: backend/cannot_go_on: the e-stop is pressed; what is written is what its "
            "first 5 taps tell\n");
  EXPECT_THAT(text_of(directory / "export" / "surface.ply").substr(0, 600), Not(HasSubstr("true_height")));
  EXPECT_EQ(exported(directory, "csv").status, 0);
  EXPECT_EQ(csv_rows(text_of(directory / "export" / "surface.csv")).at(0).count("true_height"), 0U);
}

TEST_F(Export, WritesOverItsOwnFilesAndOverNoRecord) {
  const fs::path directory = run();
  ASSERT_EQ(exported(directory, "csv").status, 0);
  const std::string first = text_of(directory / "export" / "taps.csv");
  ASSERT_EQ(exported(directory, "csv").status, 0);
  EXPECT_TRUE(text_of(directory / "export" / "taps.csv") == first);

  const std::string record = text_of(directory / "surface.csv");
  const Ended refused = exported(directory, "csv", {"--to", directory.string()});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("is the directory of a run or a sweep, whose files would be overwritten"));
  EXPECT_TRUE(text_of(directory / "surface.csv") == record);
  EXPECT_EQ(palpate({"replay", directory.string()}).status, 0);
  EXPECT_THAT(palpate({"status", directory.string()}).out, HasSubstr("done after 17 of 17 taps"));
}

TEST_F(Export, RefusesInOneLineWhatItCannotExport) {
  const fs::path directory = run();
  const auto refused = [&](const fs::path& from, const std::string& format, const std::vector<std::string>& more = {}) {
    const Ended ended = exported(from, format, more);
    EXPECT_NE(ended.status, 0);
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(test::lines(ended.err), 1) << ended.err;
    return ended.err;
  };
  EXPECT_THAT(refused(directory, "obj"), HasSubstr("obj not in {ply,csv}"));
  EXPECT_THAT(refused("nowhere", "ply"), HasSubstr("nowhere: is not a run directory"));
  EXPECT_FALSE(fs::exists(folder_.path() / "nowhere"));
  EXPECT_THAT(refused(directory, "ply", {"--to", (directory / "summary.json").string()}), HasSubstr("cannot be made"));
  ASSERT_EQ(palpate({"sweep", paper(), "seed=1,2", "taps=4", "--runs", "many", "--quiet"}).status, 0);
  const fs::path sweep = only_run(folder_.path() / "many");
  EXPECT_THAT(refused(sweep, "csv"),
              HasSubstr("is a sweep of many runs, give one of them: " + (sweep / "jobs" / "<id>").string()));
}

}  // namespace
}  // namespace palpate
