// SPDX-License-Identifier: MIT
// The columns of `palpate list`, for folders written by hand.
#include "analysis/runs_table.hpp"

#include "config/yaml.hpp"
#include "support/parts.hpp"
#include "support/testing.hpp"
#include "sweep/sweep.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <ctime>

#include <utime.h>

namespace palpate::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class RunsTable : public InFolder {
 protected:
  RunsTable() {
    ::setenv("TZ", "UTC0", 1);
    ::tzset();
  }

  /// Writes a run that began `hours` hours after midnight of 1 March 2026.
  fs::path run(const std::string& name, int hours, const std::string& summary = "") const {
    const fs::path config =
        folder_.write(name + "/config.yaml", "name: " + name + "\nseed: " + std::to_string(hours) +
                                                 "\ntaps: 30\nkernel: {type: rbf, length_scale: 0.017 m}\n"
                                                 "acquisition: {type: sum}\n"
                                                 "scene: {objects: [{type: wave}, {type: box}, {type: wave}]}\n");
    begin(config, hours);
    if (!summary.empty()) folder_.write(name + "/record.jsonl", ended(summary));
    return config.parent_path();
  }
  /// Returns a record with this end; "{" is not an end.
  static std::string ended(const std::string& summary, const std::string& manifest = R"({"manifest": 1})") {
    const std::string how = summary.find("failed") == std::string::npos ? "done" : "failed";
    return manifest + "\n{\"end\": \"" + how + "\", \"summary\": " + summary + "}\n";
  }
  static void begin(const fs::path& config, int hours) {
    constexpr std::time_t kFirstOfMarch = 1772323200;
    const std::time_t begun = kFirstOfMarch + std::time_t{3600} * hours;
    const utimbuf then{begun, begun};
    ASSERT_EQ(::utime(config.c_str(), &then), 0);
  }
  fs::path done(const std::string& name, int hours, const std::string& rmse) const {
    return run(name, hours,
               R"({"status": "done", "taps": 30, "rmse_m": )" + rmse + R"(, "footprint_iou": 0.875, "found": true})");
  }
  static std::vector<Row> rows_of(std::vector<ListedRecord> records) {
    add_differences(records);
    std::vector<Row> out;
    for (ListedRecord& one : records) out.push_back(std::move(one.row));
    return out;
  }
  static std::vector<std::string> names_where(const std::vector<ListedRecord>& records, const std::string& where) {
    std::vector<std::string> names;
    for (const Row& row : rows_where(records, *WhereCondition::of_command_line(where)))
      names.push_back(row.text("name"));
    return names;
  }
};

TEST_F(RunsTable, IsThisLetterByLetter) {
  const fs::path killed = run("killed", 26);
  folder_.write("killed/record.jsonl",
                begun_record() + "{\"tap\": 1, \"outcome\": \"contact\"}\n{\"tap\": 2, \"outcome\": \"contact\"}\n{");
  folder_.write("failed/record.jsonl", ended(R"({"status": "failed", "taps": 3, "rmse_m": null})"));
  const std::vector<Row> rows =
      rows_of({list_record(done("first", 1, "0.0123")), list_record(killed), list_record(run("failed", 27))});
  const std::string in = folder_.path().string() + "/";
  EXPECT_EQ(runs_table(rows),
            "name    begun                strategy  scene      taps  rmse_m [mm]   IoU  state       set apart by  "
            "directory\n"
            "first   2026-03-01T01:00:00  sum       wave, box    30         12.3  0.88  done                      " +
                in + "first\n" +
                "killed  2026-03-02T02:00:00  sum       wave, box     2                     "
                "unfinished                " +
                in + "killed\n" +
                "failed  2026-03-02T03:00:00  sum       wave, box     3                     failed"
                "                    " +
                in + "failed\n");
  EXPECT_EQ(runs_table({}), "");
}

TEST_F(RunsTable, SetsRunsApartBySceneBackendAndAcquisitionAndNotByWhatTheyShareOrBySweepsOfTheirName) {
  const auto begun = [&](const std::string& id, const std::string& acquisition, const std::string& scene,
                         const std::string& motion) {
    const std::string effects = scene == "ring_arm" ? "  noise: 1 N  # c/scene/ring_arm.yaml:4:1\n" : "";
    return list_record(folder_
                           .write(id + "/config.yaml",
                                  "complete: 1\nname: a\nseed: 1\ntaps: 17\nacquisition:\n  type: " + acquisition +
                                      "  # c/acquisition/" + acquisition +
                                      ".yaml:1:1\nscene:\n  desk: 0 m  # c/scene/ring.yaml:1:1\n" + effects +
                                      "backend:\n  type: simulator  # c/backend/simulator.yaml:1:1\n  speed: " +
                                      (motion == "paper" ? "1" : "2") + " m/s  # c/backend/" + motion + ".yaml:1:1\n")
                           .parent_path());
  };
  std::vector<ListedRecord> records{begun("1", "weighted", "ring", "paper"),
                                    begun("2", "weighted", "ring_arm", "continuous"),
                                    begun("3", "uncertainty", "ring", "paper")};
  Sweep sweep{folder_.path() / "many", {"seed"}, {{0, "000000000000", {"1"}}, {1, "000000000001", {"2"}}}};
  const std::string config = "name: a\nacquisition: {type: weighted}\n";
  folder_.write("many/config.yaml", config);
  folder_.write("many/manifest.jsonl", manifest_text(sweep, sweep_id(parse_yaml(config, "config.yaml"), sweep)));
  records.push_back(list_record(sweep.directory));
  const std::vector<Row> rows = rows_of(std::move(records));
  EXPECT_EQ(rows.at(0).text("apart"), "acquisition weighted, scene ring, backend paper");
  EXPECT_EQ(rows.at(1).text("apart"), "scene ring_arm, backend continuous, acquisition weighted");
  EXPECT_EQ(rows.at(2).text("apart"), "acquisition uncertainty, scene ring, backend paper");
  EXPECT_EQ(rows.at(3).text("apart"), "seed (2)");
}

TEST_F(RunsTable, PutsTheSettingFirstThatSetsARunApartFromMostOthers) {
  std::vector<ListedRecord> records;
  for (const char* config : {"seed: 1\ntaps: 9\n", "seed: 1\ntaps: 9\nchoice: {repeat: allow}\n", "seed: 1\ntaps: 12\n",
                             "seed: 1\ntaps: 9\nkernel: {type: rbf}\n", "seed: 2\ntaps: 9\n"}) {
    const std::string id = std::to_string(records.size());
    records.push_back(list_record(folder_.write(id + "/config.yaml", std::string("name: a\n") + config).parent_path()));
  }
  const std::vector<Row> rows = rows_of(std::move(records));
  EXPECT_EQ(rows.at(0).text("apart"), "seed 1, taps 9");
  EXPECT_EQ(rows.at(1).text("apart"), "choice.repeat allow, seed 1, taps 9");
  EXPECT_EQ(rows.at(2).text("apart"), "taps 12, seed 1");
  EXPECT_EQ(rows.at(3).text("apart"), "kernel.type rbf, seed 1, taps 9");
  EXPECT_EQ(rows.at(4).text("apart"), "seed 2, taps 9");
}

TEST_F(RunsTable, TellsOfASweepWhatItSweepsAndOfWhichStrategyAndSceneItsJobsAre) {
  Sweep sweep{folder_.path() / "many", {"seed", "kernel.length_scale"}, {}};
  for (int job = 0; job < 4; ++job)
    sweep.jobs.push_back({job, fmt::format("{:012x}", job), {std::to_string(job), job < 2 ? "1 cm" : "2 cm"}});
  const std::string config = "name: many\nacquisition: {type: sum}\nscene: {objects: [{type: wave}]}\n";
  folder_.write("many/config.yaml", config);
  folder_.write("many/manifest.jsonl", manifest_text(sweep, sweep_id(parse_yaml(config, "config.yaml"), sweep)));
  folder_.write("many/jobs/000000000000/config.yaml",
                "acquisition:\n  type: sum  # configs/acquisition/fill.yaml:3:9\n"
                "scene:\n  desk: 0 m  # a b/scene/ring.yaml:1:1\n");
  const Row row = rows_of({list_record(sweep.directory)}).at(0);
  EXPECT_EQ(row.text("strategy"), "fill");
  EXPECT_EQ(row.text("scene"), "ring");
  EXPECT_EQ(row.text("apart"), "seed (4), kernel.length_scale (2)");
}

TEST_F(RunsTable, CallsItAStrategyOfTheCallerWhereHisScoresChoseTaps) {
  const auto strategy = [&](const std::string& source) {
    const fs::path config =
        folder_.write("told/config.yaml", "name: told\nbackend: {type: caller}\nacquisition: {type: sum}\n");
    folder_.write(
        "told/record.jsonl",
        begun_record() + "{\"tap\": 1, \"source\": \"initial\"}\n{\"tap\": 2, \"source\": \"" + source + "\"}\n");
    return list_record(config.parent_path()).row.text("strategy");
  };
  EXPECT_EQ(strategy("caller"), "scores of the caller");
  EXPECT_EQ(strategy("acquisition"), "sum");
}

TEST_F(RunsTable, CallsStrategyAndSceneAsTheGroupsAreThatTheConfigNamed) {
  const fs::path one = done("first", 1, "0.01");
  const std::string scene = "scene:\n  objects:\n    - type: wave  # default\n  desk: 0 m  # a b/scene/ring.yaml:1:1\n";
  folder_.write("first/config.yaml", "acquisition:\n  type: sum  # configs/acquisition/fill.yaml:3:9\n" + scene);
  EXPECT_EQ(list_record(one).row.text("strategy"), "fill");
  EXPECT_EQ(list_record(one).row.text("scene"), "ring");
  folder_.write("first/config.yaml", "acquisition:\n  type: sum\n");
  EXPECT_EQ(list_record(one).row.text("strategy"), "sum") << "without comments no more than these names is lost";
}

TEST_F(RunsTable, ConditionsNameColumnsFieldsOfTheSummaryAndKeysOfTheConfigWithTheirUnits) {
  const std::vector<ListedRecord> all{list_record(done("good", 1, "0.004")), list_record(done("bad", 2, "0.02")),
                                      list_record(run("killed", 3))};
  EXPECT_THAT(names_where(all, "rmse_m < 5 mm"), ElementsAre("good"));
  EXPECT_THAT(names_where(all, "not rmse_m < 5 mm"), ElementsAre("bad")) << "the other has no result";
  EXPECT_THAT(names_where(all, "kernel.length_scale == 1.7 cm and seed >= 2"), ElementsAre("bad", "killed"));
  EXPECT_THAT(names_where(all, "state == done and found == true"), ElementsAre("good", "bad"));
  EXPECT_THAT(names_where(all, "taps < 30"), ElementsAre("killed")) << "those that were made, not the budget";
  EXPECT_THAT(names_where({all.back()}, "nlpd > 0"), ElementsAre()) << "it will be known";
  EXPECT_EQ(error_of([&] { names_where(all, "rmse < 5 mm"); }),
            "command line: --where: the condition 'rmse < 5 mm' has the unknown name 'rmse', did you mean 'rmse_m'?");
}

TEST_F(RunsTable, OfADamagedRunIsAnError) {
  EXPECT_THAT(error_of([&] { list_record(run("first", 1, "{")); }),
              StartsWith((folder_.path() / "first/record.jsonl: its last line is not a JSON object").string()));
  folder_.write("second/record.jsonl", ended("{}"));
  EXPECT_THAT(error_of([&] { list_record(folder_.path() / "second"); }), HasSubstr("is not a run directory"));
  run("third", 3);
  folder_.write("third/record.jsonl", "what\n");
  EXPECT_THAT(error_of([&] { list_record(folder_.path() / "third"); }), HasSubstr("record.jsonl:1"));
}

}  // namespace
}  // namespace palpate::test
