// SPDX-License-Identifier: MIT
// Runs from any side as their users see them: what they leave, that they go on and are played again as they were, and
// what is refused.
#include "record/json.hpp"
#include "support/programs.hpp"
#include "support/sanitizers.hpp"
#include "system/shell.hpp"
#include "system/watching.hpp"

#include <assimp/scene.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <assimp/Importer.hpp>

#include <map>

#include <string>

namespace palpate {
namespace {

class AnySide : public Shell {
 protected:
  /// The meshes of the scenes are in the folder that they name.
  void SetUp() override { fs::create_directory_symlink(test::source_folder() / "configs", here() / "configs"); }
  static std::string config() { return (test::source_folder() / "configs/any_side.yaml").string(); }
  /// Where the tool started, tap by tap.
  static std::vector<double> starts_of(const fs::path& run) {
    std::vector<double> out;
    for (const Row& row : rows_of(run, "tap")) out.push_back(row.number("x").value());
    return out;
  }
  fs::path touched(const Words& more) const {
    return ran(set_by({"scene=any_bowl", "candidates.count=200", "belief.moves=100"}, more), config());
  }
};

TEST_F(AnySide, ARunTellsOfEachTapWhereItBeganInWhichDirectionAndHowFarItWent) {
  const fs::path run = touched("taps=12 seed=2");
  const std::vector<Row> rows = rows_of(run, "tap");
  ASSERT_EQ(rows.size(), 12U);
  int on = 0;
  for (const Row& row : rows) {
    const auto number = [&](const char* name) { return row.number(name).value(); };
    const Eigen::Vector3d direction(number("direction.x"), number("direction.y"), number("direction.z"));
    EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
    EXPECT_GT(number("z"), 0.0);
    EXPECT_LE(number("along"), number("length"));
    if (row.text("outcome") != "contact") continue;
    EXPECT_NEAR(number("height"), number("z") + number("along") * direction.z(), 1e-12);
    on += row.flag("on_object").value() ? 1 : 0;
    EXPECT_EQ(row.flag("on_object"), row.flag("true_on_object"));
  }
  EXPECT_GT(on, 4);
  const Row summary = parse_json_row(text_of(run / "summary.json")).value();
  EXPECT_LT(summary.number("surface_distance_m").value(), 0.05);
  EXPECT_GE(summary.number("rms_surface_distance_m").value(), summary.number("surface_distance_m").value());
  EXPECT_EQ(summary.number("rmse_m"), std::nullopt);
  EXPECT_GT(summary.number("f_score").value(), 0.0);
  EXPECT_GT(summary.number("volume_iou").value(), 0.0);
  EXPECT_LE(summary.number("volume_iou").value(), 1.0);
  EXPECT_GT(summary.number("surface_coverage_95").value(), 0.3);
  EXPECT_LE(summary.number("surface_coverage_95").value(), 1.0);
}

TEST_F(AnySide, ARunLeavesItsSurfaceAsAMeshThatAnythingReads) {
  const fs::path run = touched("taps=12");
  EXPECT_THAT(text_of(run / "surface.ply").substr(0, 400),
              testing::AllOf(testing::StartsWith("ply\nformat binary_little_endian 1.0\n"),
                             testing::HasSubstr("property float standard_deviation\n")));
  const Ended ended = palpate({"export", run});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out, (run / "export/surface.ply").string() + "\n" + (run / "export/taps.ply").string() + "\n");
  EXPECT_THAT(text_of(run / "export/surface.ply").substr(0, 400), testing::HasSubstr("property float quality\n"));
  for (const fs::path& file : {run / "surface.ply", run / "export/surface.ply"}) {
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFile(file.string(), 0);
    ASSERT_TRUE(scene != nullptr) << importer.GetErrorString();
    ASSERT_EQ(scene->mNumMeshes, 1U);
    const aiMesh& mesh = *scene->mMeshes[0];
    ASSERT_TRUE(mesh.HasNormals());
    EXPECT_GT(mesh.mNumVertices, 1000U);
    EXPECT_GT(mesh.mNumFaces, 2 * mesh.mNumVertices - 200);
  }
  // From where the tool came to where it stopped.
  std::istringstream points(text_of(run / "export/taps.ply"));
  for (std::string line; line != "end_header";) std::getline(points, line);
  int contacts = 0;
  for (const Row& row : rows_of(run, "tap")) {
    if (row.text("outcome") != "contact") continue;
    double x = 0, y = 0, z = 0, nx = 0, ny = 0, nz = 0;
    int tap = 0, on = 0;
    points >> x >> y >> z >> nx >> ny >> nz >> tap >> on;
    const double along = row.number("along").value();
    EXPECT_NEAR(x + along * nx, row.number("x").value(), 1e-12);
    EXPECT_NEAR(z, row.number("height").value(), 1e-12);
    EXPECT_EQ(tap, row.number("tap"));
    EXPECT_EQ(on == 1, row.flag("on_object"));
    ++contacts;
  }
  EXPECT_GT(contacts, 5);
  EXPECT_THAT(
      refused({"run", config(), "--dry-run", "belief.prior={depth: " + (run / "export/taps.ply").string() + "}"}),
      testing::HasSubstr("unknown option 'prior' of belief/solids"));
  EXPECT_THAT(refused({"export", run, "--to", run}), testing::HasSubstr("files are never overwritten"));
}

TEST_F(AnySide, ATapIsExplainedByWhatWasBelievedBeforeIt) {
  const fs::path run = touched(test::kSanitized ? "taps=7" : "taps=12");
  const std::vector<Row> rows = rows_of(run, "tap");
  int places = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Ended ended = palpate({"explain", run, std::to_string(i + 1)});
    EXPECT_EQ(ended.status, 0) << ended.err;
    std::string text = ended.out;
    for (auto at = text.find("\n    "); at != std::string::npos; at = text.find("\n    ")) text.replace(at, 5, " ");
    const auto says = [&](const std::string& words) { EXPECT_THAT(text, testing::HasSubstr(words)) << i + 1; };
    says(fmt::format("from x {:.2f} cm, y {:.2f} cm, z {:.2f} cm, ", 100 * rows[i].number("x").value(),
                     100 * rows[i].number("y").value(), 100 * rows[i].number("z").value()));
    says(fmt::format("The belief after {} tap", i));
    says("24 particles of ");
    says("Expected, by the most probable particle: ");
    says("Error of the surface: on the object ");
    says("to the nearest point (RMS) ");
    if (rows[i].text("outcome") == "no_contact") says("Found: nothing in 35.88 cm; the whole path is free.");
    if (rows[i].text("source") == "initial") {
      says("through the region");
      continue;
    }
    says("The acquisition chose it: discovery");
    says("Of one further solid that no contact contradicts, this line is expected to find ");
    says(fmt::format("Its score is {:.4g}, the best of 200 approaches", rows[i].number("score").value()));
    says("Runner-up: from x ");
    says(fmt::format("with a score of {:.4g}, ", rows[i].number("runner_up.score").value()));
    const bool met = text.find("by the most probable particle: an object after") != std::string::npos;
    says(met ? "the standard deviation along the surface normal is "
             : "According to the most probable particle, no object is there.");
    places += met ? 1 : 0;
  }
  EXPECT_GT(places, 0);
}

TEST_F(AnySide, ARunWhoseApproachesAreLimitedByTheToolOrTheArmIsPlayedAgainAndExplainedAsItWas) {
  const Words few = "taps=6 belief.moves=20 name=limited";
  const std::vector<double> free = starts_of(touched(set_by(few, "name=free")));
  std::vector<const char*> limits{"{tip_radius: {radius: 2 cm}}", "{shaft: {radius: 2 cm, length: 3 cm}}",
                                  "{reach: {base: [-55 cm, 13 cm], radius: 75 cm}}"};
  if (test::kSanitized) limits.resize(1);
  for (const char* const effects : limits) {
    const fs::path run = touched(few + Words{std::string("scene.effects=") + effects});
    EXPECT_NE(starts_of(run), free) << effects;
    const Ended ended = palpate({"replay", run});
    EXPECT_EQ(ended.status, 0) << effects << ended.err;
    EXPECT_THAT(ended.out, testing::HasSubstr("all equal"));
    EXPECT_THAT(palpate({"explain", run, "6"}).out, testing::Not(testing::HasSubstr("elsewhere")));
    fs::remove_all(here() / "runs");
  }
}

TEST_F(AnySide, ARunEndsAtItsStandardDeviationAsOneFromAboveDoes) {
  const fs::path run = touched("taps=30 seed=2 stop.max_standard_deviation=1m");
  const Row summary = parse_json_row(text_of(run / "summary.json")).value();
  EXPECT_EQ(summary.text("stop_reason"), "max_standard_deviation");
  EXPECT_LT(summary.number("taps").value(), 30.0) << "1 m is more than any surface deviates";
  EXPECT_THAT(palpate({"replay", run}).out, testing::EndsWith("all equal\n"));
}

TEST_F(AnySide, TheFallbackChoosesWhereNoLineScoresAndIsRecordedWithItsReason) {
  // The one line goes anywhere, not along the normal, so that no uncertainty is above 0.
  const Words alike = "taps=12 seed=2 acquisition=uncertainty candidates.count=1";
  const auto chosen_by_fallback = [&](const Words& more) {
    int count = 0;
    for (const Row& row : rows_of(touched(alike + more), "tap")) {
      const bool is_fallback = row.text("source") == "fallback";
      EXPECT_EQ(row.text("why").empty(), !is_fallback);
      count += is_fallback ? 1 : 0;
    }
    return count;
  };
  EXPECT_GT(chosen_by_fallback("name=with"), 0);
  EXPECT_EQ(chosen_by_fallback("name=without choice.fallback=none"), 0);
}

TEST_F(AnySide, ARunThatFailedByItsArmIsPlayedAgainToItsEnd) {
  // On every tap the arm takes longer than it may.
  const Ended failed = palpate({"run", config(), "--quiet", "scene=any_bowl", "candidates.count=50", "belief.moves=20",
                                "taps=9", "motion.timeout=100ms", "stop.failed_in_a_row=3"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err, testing::HasSubstr("3 taps in a row failed"));
  const Ended ended = palpate({"replay", directory()});
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, testing::HasSubstr("all equal"));
}

TEST_F(AnySide, OnAHighDeskAndOverAnAreaThatIsNoSquareEverythingIsWhereItIs) {
  const fs::path flat = touched("taps=12");
  const fs::path run = touched("taps=12 scene.desk=70cm name=high");
  const std::vector<Row> low = rows_of(flat, "tap");
  const std::vector<Row> high = rows_of(run, "tap");
  ASSERT_EQ(high.size(), low.size());
  for (std::size_t i = 0; i < high.size(); ++i) {
    EXPECT_EQ(high[i].text("outcome"), low[i].text("outcome")) << i;
    EXPECT_EQ(high[i].flag("on_object"), low[i].flag("on_object"));
    EXPECT_EQ(high[i].flag("true_on_object"), low[i].flag("true_on_object"));
    // Rounding at 70 cm, and what the belief makes of it.
    EXPECT_NEAR(high[i].number("z").value(), low[i].number("z").value() + 0.7, 1e-6);
    EXPECT_EQ(high[i].number("height").has_value(), low[i].number("height").has_value());
    EXPECT_NEAR(high[i].number("height").value_or(0.7), low[i].number("height").value_or(0.0) + 0.7, 1e-6);
  }
  const auto nearest = [&](const fs::path& one) {
    return parse_json_row(text_of(one / "summary.json")).value().number("surface_distance_m").value();
  };
  EXPECT_NEAR(nearest(run), nearest(flat), 1e-6);
  EXPECT_THAT(palpate({"replay", run}).out, testing::HasSubstr("all equal"));

  const fs::path wide = touched("taps=24 scene.area.width=40cm name=wide");
  int on = 0;
  for (const Row& row : rows_of(wide, "tap")) {
    if (row.text("outcome") != "contact") continue;
    EXPECT_EQ(row.flag("on_object"), row.flag("true_on_object"));
    on += *row.flag("on_object") ? 1 : 0;
  }
  EXPECT_GT(on, 2);
  EXPECT_LT(nearest(wide), 0.05);
}

TEST_F(AnySide, ARunThatMetNothingLeavesNoSurfaceAndEveryPageAndFileOfIt) {
  const fs::path run = touched("taps=5 scene.objects=[]");
  const Row summary = parse_json_row(text_of(run / "summary.json")).value();
  EXPECT_EQ(summary.number("taps"), 5);
  EXPECT_EQ(summary.number("object_taps"), 0);
  EXPECT_EQ(summary.number("failed_taps"), 0);
  EXPECT_EQ(*summary.number("desk_taps") + *summary.number("no_contact_taps"), 5);
  EXPECT_THAT(text_of(run / "surface.ply"), testing::HasSubstr("element vertex 0\n"));
  EXPECT_EQ(status_of(run).status, 0);
  for (const char* const command : {"replay", "report", "export"}) {
    const Ended ended = palpate({command, run});
    EXPECT_EQ(ended.status, 0) << command << ended.err;
  }
  EXPECT_EQ(palpate({"explain", run, "5"}).status, 0);
  EXPECT_THAT(text_of(run / "export/surface.ply"), testing::HasSubstr("element vertex 0\n"));
}

TEST_F(AnySide, AfterAViewFromOneSideTheRuleChoosesFromTheFirstTapOnAndAResumedRunAndAReplayHaveTheSameView) {
  const Words seen{"taps=4", "belief.view={}", "belief.moves=20"};
  const fs::path whole = touched(seen + "name=whole");
  for (const Row& row : rows_of(whole, "tap")) EXPECT_EQ(row.text("source"), "acquisition");
  const fs::path broken = touched(seen + "name=broken");
  break_off(broken);
  ASSERT_EQ(resume(broken).status, 0);
  for (const char* name : {"taps.csv", "surface.ply"}) EXPECT_EQ(text_of(broken / name), text_of(whole / name));
  if (test::kSanitized) return;  // what follows makes the same of other numbers
  const Ended replayed = palpate({"replay", whole});
  EXPECT_EQ(replayed.status, 0) << replayed.err;
  EXPECT_THAT(replayed.out, testing::HasSubstr("all equal"));
  // From another side another first tap; without a view the first one is drawn.
  const fs::path other = touched(
      Words{"taps=4", "belief.view={azimuth: 10 deg, elevation: 50 deg, rays: 225}", "belief.moves=20", "name=other"});
  EXPECT_NE(rows_of(other, "tap")[0].number("x"), rows_of(whole, "tap")[0].number("x"));
  EXPECT_EQ(rows_of(touched("taps=1 belief.moves=20 name=none initial.count=1"), "tap")[0].text("source"), "initial");
}

TEST_F(AnySide, TheNinePublishedObjectsBecomeScenesAndASweepFromAFolderOfMeshes) {
  if (test::kSanitized) GTEST_SKIP() << "a program in Python over the one that is tested elsewhere";
  const fs::path solids = test::source_folder() / "configs/scene/solids";
  const fs::path folder = here() / "downloaded/asus_scanner_models";
  for (const auto& [name, mesh] : std::map<std::string, std::string>{{"jug", "mug.stl"}, {"mugD", "jug.stl"}}) {
    fs::create_directories(folder / name);
    fs::copy_file(solids / mesh, folder / name / (name + ".stl"));
  }
  const auto published = [&](const std::string& objects) {
    return test::run_program(
        {"python3", "-B", (test::source_folder() / "tests/benchmark/published_objects.py").string(),
         (here() / "downloaded").string(), "--palpate", test::program_file().string(), "--objects", objects, "taps=3",
         "seed=1", "acquisition=uncertainty", "candidates.count=50", "belief.moves=10"},
        here());
  };
  const Ended ended = published("jug,mugD");
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, testing::HasSubstr("published_jug"));
  EXPECT_THAT(ended.out, testing::HasSubstr("published_mugD"));
  EXPECT_EQ(lines(text_of(here() / "published_objects.sha256")), 2);

  const auto refusal = [&](const std::string& objects) {
    const Ended refused = published(objects);
    EXPECT_EQ(refused.status, 2);
    return refused.err;
  };
  EXPECT_THAT(refusal("bowlA"), testing::HasSubstr("no file bowlA.stl, .ply or .obj below"));
  write("downloaded/pot/pot_cloud.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
        "z\nend_header\n0 0 0\n");
  EXPECT_THAT(refusal("pot"), testing::HasSubstr("pot_cloud.ply is a cloud of points, and a scene needs a mesh"));
  EXPECT_THAT(refusal("spoon"), testing::HasSubstr("spoon is none of"));
  fs::copy_file(solids / "jug.stl", folder / "jug/jug.stl", fs::copy_options::overwrite_existing);
  EXPECT_THAT(refusal("jug"), testing::HasSubstr("at first use it was"));
}

TEST_F(AnySide, ASweepIsComparedAfterFewerTapsAsIfItsRunsHadEndedThere) {
  const fs::path sweep =
      swept({"acquisition=random,discovery", "scene=any_bowl", "candidates.count=200", "belief.moves=50", "taps=8"},
            config());
  const Ended ended = palpate(
      {"compare", sweep, "--by", "acquisition", "--metric", "surface_distance_m", "--at", "5", "--format", "markdown"});
  EXPECT_EQ(ended.status, 0) << ended.err;
  const fs::path alone =
      ran({"scene=any_bowl", "candidates.count=200", "belief.moves=50", "taps=5", "acquisition=random"}, config());
  const Row whole = parse_json_row(text_of(alone / "summary.json")).value();
  int compared = 0;
  for (const Cells& row : csv_rows(text_of(sweep / "results_at_5.csv"))) {
    if (row.at("acquisition") != "random") continue;
    for (const char* const name : {"surface_distance_m", "f_score", "volume_iou", "surface_coverage_95"})
      EXPECT_EQ(row.at(name), whole.cell(name)) << name;
    ++compared;
  }
  EXPECT_EQ(compared, 1);
  EXPECT_NE(starts_of(job_of(sweep, 0)), starts_of(job_of(sweep, 1))) << "each rule has taps of its own";
  // The one error that tables and curves show is that from any side, beside taps from above a root mean square of
  // either.
  EXPECT_THAT(palpate("list").out, HasSubstr("rms_surface_distance_m [mm]"));
  EXPECT_THAT(palpate({"resume", sweep}).out, HasSubstr("Groups with the least rms_surface_distance_m come first."));
  EXPECT_THAT(palpate({"curves", sweep, "--by", "acquisition"}).err,
              HasSubstr("curves_acquisition_rms_surface_distance_m_taps.csv"));
  ran("taps=3 initial.count=2", paper());
  const std::string both = palpate("list").out;
  EXPECT_THAT(both, HasSubstr("RMS error [mm]"));
  EXPECT_THAT(both, Not(HasSubstr("rms_surface_distance_m")));
}

TEST_F(AnySide, ARecordIsReadByAllThatReadOneWithoutItsBackendBeingBuilt) {
  const std::string built = (here() / "built").string();
  environment_ = {test::with_plugin("connects"), "PALPATE_BUILT=" + built};
  const fs::path run = ran({"backend.type=connects", "scene=any_bowl", "candidates.count=200", "belief.moves=50",
                            "taps=6", "acquisition=discovery"},
                           config());
  ASSERT_TRUE(fs::exists(built)) << "else this tests nothing";
  for (const Row& row : rows_of(run, "tap")) {
    EXPECT_THAT(row.text("unreached"), testing::MatchesRegex("[0-9a-f]*[1-9a-f]"));
    EXPECT_GT(row.number("direction.x"), -0.2);
  }
  fs::remove(built);
  const Ended replayed = palpate({"replay", run});
  EXPECT_THAT(replayed.out, testing::EndsWith("all equal\n")) << "and among the same lines: " << replayed.out;
  for (const Words& command :
       {Words{"report", run}, Words{"explain", run, "3"}, Words{"export", run}, Words{"status", run}, Words{"list"}})
    EXPECT_EQ(palpate(command).status, 0) << command[0];
  {
    const auto server = begin(Words{"watch", run});
    ASSERT_TRUE(test::eventually([&] { return lines(server->out()) > 0; })) << server->err();
    const test::Address address(server->out());
    EXPECT_TRUE(test::eventually(
        [&] { return address.get("news?at=1.6.0&now").body.find("\"moments\"") != std::string::npos; }));
    server->signal(SIGTERM);
    server->wait();
  }
  EXPECT_FALSE(fs::exists(built)) << "somebody has built the backend of a record";

  // Carried on, it chooses among the lines that were drawn then.
  const std::string taps = part_of(run, "tap");
  break_off(run);
  ASSERT_EQ(resume(run).status, 0);
  EXPECT_EQ(part_of(run, "tap"), taps);
}

TEST_F(AnySide, WhatOnlyKnowsTapsFromAboveIsRefusedInOneLine) {
  EXPECT_THAT(refused({"run", config(), "acquisition=weighted"}),
              testing::HasSubstr(
                  "weighted reads label_mean, which the belief solids does not offer, choose another acquisition"));
  EXPECT_THAT(refused({"run", paper(), "acquisition=discovery"}),
              testing::HasSubstr("discovery reads expected_discovery, which the belief height_map does not offer"));
  EXPECT_THAT(refused({"run", config(), "kernel={type: rbf, length_scale: 4 cm, length_scale_y: 3 cm}"}),
              testing::HasSubstr("kernel: depends on more than the distance"));
  const fs::path run = touched("taps=4");
  EXPECT_THAT(palpate({"resume", run}).out,
              testing::AllOf(testing::HasSubstr("on the object"), testing::Not(testing::HasSubstr("IoU"))));
  EXPECT_THAT(refused({"report", run, "--figures"}), testing::HasSubstr("is a run from any side, but --figures"));
  EXPECT_THAT(refused({"report", run, run}), testing::HasSubstr("is a run from any side, but pages of several"));
  const std::string record = text_of(run / "record.jsonl");
  for (const auto& [lost, told] : {std::pair("\"z\": ", "has some of z, direction and length, but not all"),
                                   std::pair("\"along\": ", "has no number 'along', how far the tool went to its")}) {
    std::string damaged = record;
    for (auto at = record.find(lost); at != std::string::npos; at = record.find(lost, at + 1)) damaged[at + 1] = '_';
    write(run / "record.jsonl", damaged);
    EXPECT_THAT(palpate({"export", run}).err, testing::HasSubstr(told));
  }
}

TEST_F(AnySide, KeysThatOnlyTapsFromAboveReadAreRefused) {
  const Words of_height_map(R"(belief.height.noise=1mm belief.label.clip=true belief.engine.type=dense
                               belief.footprint={"type":primitives} belief.prior={"depth":view.ply})");
  for (const std::string& word : of_height_map) {
    const std::string key = word.substr(7, word.find_first_of(".=", 7) - 7);
    EXPECT_THAT(refused({"run", config(), "--dry-run", word}),
                testing::HasSubstr("unknown option '" + key + "' of belief/solids"));
  }
  for (const char* const word :
       {"candidates.spacing=5mm", "choice.repeat=allow", "log.maps=true", "initial.design=grid"}) {
    EXPECT_THAT(refused({"run", config(), "--dry-run", word}),
                testing::HasSubstr("reads desk_position, which the belief solids does not offer"))
        << word;
  }
  EXPECT_THAT(refused({"run", config(), "--dry-run", "fitting=ceres"}),
              testing::HasSubstr("ceres fits nothing for the belief solids"));
  EXPECT_THAT(refused({"run", config(), "stop.expected_rmse=1cm"}),
              testing::HasSubstr("stop.expected_rmse reads expected_rmse, which the belief solids does not offer"));
  EXPECT_EQ(palpate({"run", config(), "--dry-run", "stop.robot_time=90s", "choice.tie_tolerance=1e-6",
                     "candidates.count=47", "initial.count=2500", "taps=3000"})
                .status,
            0);
  EXPECT_THAT(refused({"run", paper(), "--dry-run", "belief.particles=5"}),
              testing::HasSubstr("unknown option 'particles' of belief/height_map"));
}

TEST_F(AnySide, TheBeliefDecidesWhichWayTheToolComes) {
  const fs::path above = ran({"strategy=uncertainty", "scene=any_bowl", "taps=4"}, config());
  EXPECT_TRUE(fs::exists(above / "surface.csv"));
  const fs::path around = ran({"name=around", "belief=solids", "acquisition=random", "candidates.count=50", "taps=4"});
  EXPECT_TRUE(fs::exists(around / "surface.ply"));
}

TEST_F(AnySide, ASoftWorldAndAnArmThatErrsLeaveASurfaceNearlyAsGoodAsAPerfectOne) {
  if (test::brief()) GTEST_SKIP() << "runs at full effort";
  const std::string effects =
      "scene.effects={force_noise: {}, stiffness: {}, joint_lag: {}, pose_noise: {}, false_contacts: {}}";
  double sum = 0.0;
  for (const std::string scene : {"scene=any_mug", "scene=any_bowl"}) {
    const fs::path run = ran({scene, "taps=40", "seed=16100", effects}, config());
    sum += parse_json_row(text_of(run / "summary.json")).value().number("surface_distance_m").value();
  }
  // Without effects 1 mm; without a correction 11 mm.
  EXPECT_LT(sum / 2, 0.004);
}

}  // namespace
}  // namespace palpate
