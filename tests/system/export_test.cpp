// SPDX-License-Identifier: MIT
// `palpate export`: what other programs read of it.
#include "system/shell.hpp"

#include <assimp/scene.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

namespace palpate {
namespace {

class Export : public Shell {
 protected:
  Ended exported(const fs::path& directory, const Words& more = {}) const {
    return palpate(Words{"export", directory} + more);
  }

  /// The surface that is exported is that of the record: to the last bit, where it is not in single precision.
  void expect_numbers_of_record(const fs::path& directory) const {
    ASSERT_EQ(exported(directory).status, 0);
    const std::vector<Cells> recorded = csv_rows(text_of(directory / "surface.csv"));
    std::istringstream vertices(below_header(directory / "export" / "surface.ply"));
    for (std::size_t i = 0; i < recorded.size(); ++i) {
      double x, y, z, normal;
      float deviation, probability, truth;
      vertices >> x >> y >> z >> normal >> normal >> normal >> deviation >> probability >> truth;
      const auto of = [&](const char* column) { return std::stod(recorded[i].at(column)); };
      ASSERT_TRUE(x == of("x") && y == of("y") && z == of("reconstructed_height")) << "candidate " << i;
      ASSERT_EQ(deviation, static_cast<float>(of("height_standard_deviation"))) << "candidate " << i;
      ASSERT_EQ(probability, static_cast<float>(of("object_probability"))) << "candidate " << i;
      ASSERT_EQ(truth, static_cast<float>(of("true_height"))) << "candidate " << i;
    }
  }

  static std::string below_header(const fs::path& file) {
    const std::string ply = text_of(file);
    return ply.substr(ply.find("end_header\n") + 11);
  }
};

float single(const std::string& cell) { return static_cast<float>(std::stod(cell)); }

/// The single mesh of a file, as assimp reads it without changing anything.
const aiMesh& only_mesh(Assimp::Importer& importer, const fs::path& file) {
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene == nullptr || scene->mNumMeshes != 1) throw std::runtime_error(importer.GetErrorString());
  return *scene->mMeshes[0];
}

TEST_F(Export, WritesASurfaceThatAssimpReadsVertexByVertex) {
  const fs::path directory = ran();
  const Ended ended = exported(directory);
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

TEST_F(Export, WritesTheProbabilityOfTheFootprint) {
  const fs::path directory = ran({"belief.surface=two_part", "belief.footprint=primitives"});
  expect_numbers_of_record(directory);
  EXPECT_THAT(text_of(directory / "summary.json"), HasSubstr("\"label_errors\": ")) << "it is not the weight";
}

TEST_F(Export, WritesContactsAsPointsAndNoFailedTaps) {
  const fs::path directory =
      ran({"scene.effects={missed_contacts: {probability: 0.3}}", "name=\"a\\nend_header\\n1\""});
  ASSERT_EQ(exported(directory, "--format ply --to elsewhere/deep").status, 0);
  std::vector<Cells> contacts = csv_rows(text_of(directory / "taps.csv"));
  ASSERT_EQ(contacts.size(), 17U);
  contacts.erase(
      std::remove_if(contacts.begin(), contacts.end(), [](const Cells& tap) { return tap.at("outcome") != "contact"; }),
      contacts.end());
  ASSERT_LT(contacts.size(), 17U) << "some taps failed";

  const fs::path file = here() / "elsewhere" / "deep" / "taps.ply";
  EXPECT_THAT(text_of(file), HasSubstr("element vertex " + std::to_string(contacts.size()) + "\n"));
  std::string points;
  for (const Cells& tap : contacts) {
    points += tap.at("x") + " " + tap.at("y") + " " + tap.at("height") + " " + tap.at("tap") + " " +
              (tap.at("on_object") == "true" ? "1" : "0") + "\n";
  }
  EXPECT_EQ(below_header(file), points);
  Assimp::Importer importer;
  const aiMesh& mesh = only_mesh(importer, file);
  ASSERT_EQ(mesh.mNumVertices, contacts.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    EXPECT_FLOAT_EQ(mesh.mVertices[i].x, single(contacts[i].at("x")));
    EXPECT_NEAR(mesh.mVertices[i].z, single(contacts[i].at("height")), 1e-9);
  }
}

TEST_F(Export, OfARunThatIsNotDoneSaysWhatItStandsOn) {
  const fs::path directory = ran();
  ASSERT_EQ(exported(directory).status, 0);
  const std::string whole = text_of(directory / "export" / "surface.ply");
  write(directory / "record.jsonl", test::record_until(text_of(directory / "record.jsonl"), 11));
  fs::remove(directory / "summary.json");
  const Ended ended = exported(directory);
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err, "this run is unfinished; the export uses its first 11 taps\n");
  EXPECT_THAT(text_of(directory / "export" / "taps.ply"), HasSubstr("element vertex 11\n"));
  EXPECT_TRUE(text_of(directory / "export" / "surface.ply") != whole);
}

TEST_F(Export, OfTablesHasThePartsOfARecordAndNeedsNoTap) {
  const fs::path directory = ran("taps=5");
  break_off(directory);
  ASSERT_EQ(resume(directory).status, 0);
  const Words words{"export", directory, "--format", "csv"};
  const Ended ended = palpate(words);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(lines(ended.out), 4);
  const fs::path tables = directory / "export";
  EXPECT_EQ(text_of(tables / "taps.csv"), text_of(directory / "taps.csv"));
  const auto times = csv_rows(text_of(tables / "timings.csv"));
  const std::vector<Row> recorded = rows_of(directory, "timing");
  ASSERT_EQ(times.size(), recorded.size());
  EXPECT_THAT(text_of(tables / "timings.csv"), StartsWith("tap,robot,fit,infer,acquire,log\n"));
  for (std::size_t i = 0; i < times.size(); ++i)
    EXPECT_EQ(std::stod(times[i].at("infer")), recorded[i].number("infer"));
  EXPECT_THAT(text_of(tables / "objects.csv"), StartsWith("object,type,cells,"));
  const auto attempts = csv_rows(text_of(tables / "attempts.csv"));
  ASSERT_EQ(attempts.size(), 2U);
  EXPECT_EQ(attempts[0].at("end"), "") << "it was killed";
  EXPECT_EQ(attempts[1].at("end"), "done");
  EXPECT_NE(attempts[1].at("after_tap"), "0");

  write(directory / "record.jsonl", test::record_until(text_of(directory / "record.jsonl"), 0));
  EXPECT_EQ(palpate(words + Words{"--to", "empty"}).status, 0);
  EXPECT_EQ(csv_rows(text_of(here() / "empty" / "attempts.csv")).size(), 1U);
}

TEST_F(Export, OfARunThatFailedSaysSoAndLeavesOutATruthThatNobodyKnows) {
  environment_ = {test::with_plugin("cannot_go_on")};
  ASSERT_EQ(run("backend.type=cannot_go_on --quiet").status, 1);
  const Ended ended = exported(directory());
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(ended.err,
            "this run failed: backend/cannot_go_on: the e-stop is pressed; the export uses its first 5 taps\n");
  EXPECT_THAT(text_of(directory() / "export" / "surface.ply").substr(0, 600), Not(HasSubstr("true_height")));
}

TEST_F(Export, WritesOverItsOwnFilesAndOverNoRecord) {
  const fs::path directory = ran();
  ASSERT_EQ(exported(directory).status, 0);
  const std::string first = text_of(directory / "export" / "taps.ply");
  ASSERT_EQ(exported(directory).status, 0);
  EXPECT_TRUE(text_of(directory / "export" / "taps.ply") == first);
  for (const char* format : {"csv", "ply"}) {
    const Ended ended = exported(directory, {"--to", directory, "--format", format});
    EXPECT_EQ(ended.status, 2) << format;
    EXPECT_THAT(ended.err, HasSubstr("is the folder of the record, whose files are never overwritten, choose another"));
  }
  EXPECT_EQ(palpate({"replay", directory}).status, 0);
  EXPECT_THAT(status_of(directory).out, HasSubstr("done after 17 of 17 taps"));
}

TEST_F(Export, RefusesInOneLineWhatItCannotExport) {
  const fs::path directory = ran();
  const Words words{"export", directory};
  EXPECT_THAT(refused(words + "--format obj"), HasSubstr("--format: obj not in {ply,csv}"));
  EXPECT_THAT(refused("export nowhere"),
              HasSubstr("nowhere: is not a folder, and runs contains no run or sweep of that name"));
  EXPECT_FALSE(fs::exists(here() / "nowhere"));
  EXPECT_THAT(refused(words + Words{"--to", directory / "summary.json"}, 1), HasSubstr("cannot be made"));
  const fs::path sweep = swept("seed=1,2 taps=4");
  EXPECT_THAT(refused({"export", sweep}),
              HasSubstr("is a sweep of many runs, name one run: " + (sweep / "jobs" / "<id>").string()));
}

}  // namespace
}  // namespace palpate
