// SPDX-License-Identifier: MIT
// Runs from any side on backends other than the simulator: a program of version 2 of the protocol, behind which the
// simulator makes the taps, and recorded taps. Both have to give the simulator's own runs. PALPATE_LONG compares 8
// solids with 5 seeds and 40 taps.
#include "support/programs.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace palpate {
namespace {

class AnyLine : public Shell {
 protected:
  static std::string any_side() { return config("any_side.yaml"); }
  static std::string program(const Words& scene) {
    std::string out = "'" + (test::program_file().parent_path() / "tests/simulated_arm").string() + "'";
    for (const std::string& word : scene) out += " '" + word + "'";
    return out;
  }
  static Words with_program(const std::string& command, const std::string& more = "") {
    return {"backend={type: process, protocol: 2, repeatable: true, scene_is_truth: true, command: " +
            test::yaml_quoted(command) + more + "}"};
  }
  std::string taps_of(const Words& more, const std::string& runs) const {
    const fs::path where = here() / runs;
    const Ended ended = palpate(Words{"run", any_side(), "--quiet", "--runs", where} + more);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended.status == 0 ? text_of(only_run(where) / "taps.csv") : "";
  }
};

TEST_F(AnyLine, AProgramThatTapsTheSceneGetsTheLinesOfTheSimulatorAndGivesItsTaps) {
  Words solids{"any_two"};
  int seeds = 1;
  std::string taps = "10";
  if (std::getenv("PALPATE_LONG") != nullptr) {
    solids = "any_bottle any_bowl any_bracket any_jug any_leaning any_lidded_box any_mug any_two";
    seeds = 5;
    taps = "40";
  }
  int equal = 0;
  for (const std::string& solid : solids) {
    for (int seed = 1; seed <= seeds; ++seed) {
      const std::string name = solid + "_" + std::to_string(seed);
      const Words scene{"scene=" + solid, "seed=" + std::to_string(seed)};
      const std::string simulated = taps_of(scene + Words{"taps=" + taps}, "simulated_" + name);
      const std::string answered = taps_of(scene + Words{"taps=" + taps} + with_program(program(scene)), name);
      EXPECT_EQ(answered, simulated) << name;
      EXPECT_EQ(std::to_string(lines(simulated) - 1), taps);
      equal += answered == simulated ? 1 : 0;
    }
  }
  std::cout << equal << " of " << solids.size() * static_cast<std::size_t>(seeds) << " runs have equal taps\n";
}

const Words kFew = "scene=any_bowl candidates.count=600 belief.moves=50 taps=8";

TEST_F(AnyLine, AProgramThatReachesSomeLinesIsSentOnlyThose) {
  const Words shaft{"scene.effects={shaft: {radius: 2 cm, length: 3 cm}}"};
  const std::string simulated = taps_of(kFew + shaft, "simulated");
  EXPECT_THAT(simulated, HasSubstr("unreached"));
  EXPECT_EQ(taps_of(kFew + shaft + with_program(program(Words{"scene=any_bowl"} + shaft)), "answered"), simulated);
}

TEST_F(AnyLine, ARunThatWasCutIsResumedWithTheSameLines) {
  const fs::path run = ran(kFew + with_program(program({"scene=any_bowl"})), any_side());
  const std::string whole = part_of(run, "tap");
  cut_taps(run);
  ASSERT_EQ(resume(run).status, 0);
  EXPECT_EQ(part_of(run, "tap"), whole);
  EXPECT_THAT(palpate({"replay", run}).out, HasSubstr("all equal"));
}

TEST_F(AnyLine, RecordedTapsAreFoundByTheirLines) {
  const fs::path run = ran(kFew, any_side());
  const std::string replay = "backend={type: replay, scene_is_truth: true, record: '" + run.string() + "'}";
  EXPECT_EQ(taps_of(kFew + Words{replay}, "again"), text_of(run / "taps.csv"));
  const std::string other = taps_of(kFew + Words{replay, "seed=2"}, "other");
  EXPECT_THAT(other, AllOf(HasSubstr("unreachable"), Not(HasSubstr("contact"))));
}

TEST_F(AnyLine, TheQuestionsOfAProgramAreAnsweredOnceOrForAllLines) {
  // It writes each question to stderr, reaches all, and meets nothing.
  const std::string body =
      "for ask in asks():\n"
      "    print(json.dumps(ask), file=sys.stderr, flush=True)\n"
      "    if 'reaches' in ask: print('{\"reaches\": null}', flush=True)\n"
      "    else: tell(ask, outcome='no_contact', seconds=1)\n";
  const std::string command = "python3 -SE '" + write("program.py", test::python(body)).string() + "'";
  const fs::path run = ran(kFew + with_program(command), any_side());
  const std::string asked = text_of(run / "process.stderr.txt");
  EXPECT_EQ(lines(asked), 9) << "all lines are asked about once";
  const std::string id = run.filename().string();
  EXPECT_THAT(asked, StartsWith("{\"palpate\": 2, \"run\": \"" + id + "\", \"reaches\": [["));
  EXPECT_THAT(asked, HasSubstr("\n{\"palpate\": 2, \"run\": \"" + id + "\", \"tap\": 2, \"line\": {\"start\": ["));
  EXPECT_THAT(asked, HasSubstr("\"lowest_height\": 0.0, \"previous\": {\"start\": ["));
  EXPECT_THAT(asked, Not(HasSubstr("\"x\"")));
  EXPECT_THAT(text_of(run / "summary.json"), HasSubstr("\"no_contact_taps\": 8"));
}

TEST_F(AnyLine, AnInvalidAnswerAboutLinesEndsTheRunBeforeATap) {
  for (const char* answer : {"{\"reaches\": \"01\"}", "{\"reaches\": \"2\"}", "{}", "no JSON"}) {
    const std::string body = "for ask in asks(): print('" + std::string(answer) + "', flush=True)\n";
    const std::string command = "python3 -SE '" + write("program.py", test::python(body)).string() + "'";
    const Ended ended = palpate(Words{"run", any_side(), "--quiet", "--force"} + kFew + with_program(command));
    EXPECT_EQ(ended.status, 1);
    EXPECT_THAT(
        ended.err,
        HasSubstr("backend/process: the program has to answer 'reaches' with null or a text of 500 digits 0 and 1, "
                  "but printed '" +
                  std::string(answer) + "'"));
  }
}

TEST_F(AnyLine, AnInterruptedQuestionAboutLinesFailsNoRunAndNoneFollowsTheLastTap) {
  // Each of its processes answers six questions, then the program waits.
  const std::string body =
      "count = 0\n"
      "for ask in asks():\n"
      "    if count == 6: time.sleep(1000)\n"
      "    count += 1\n"
      "    if 'reaches' in ask: print(json.dumps({'reaches': '1' * len(ask['reaches'])}), flush=True)\n"
      "    else: tell(ask, outcome='no_contact', seconds=1)\n";
  const std::string command = "python3 -SE '" + write("program.py", test::python(body)).string() + "'";
  const Words words = Words{"run",
                            any_side(),
                            "--quiet",
                            "taps=6",
                            "candidates.count=400",
                            "belief.moves=50",
                            "backend={type: process, protocol: 2, command: " + test::yaml_quoted(command) + "}"};
  const auto child = begin(words);
  const auto taps = [&] {
    return fs::exists(here() / "runs") && fs::exists(directory() / "record.jsonl") ? lines(part_of(directory(), "tap"))
                                                                                   : 0;
  };
  ASSERT_TRUE(test::eventually([&] { return taps() == 3; }));
  child->signal(SIGINT);
  EXPECT_EQ(child->wait().status, 130);
  const Ended resumed = resume(directory());
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_EQ(taps(), 6);
}

TEST_F(AnyLine, AProgramOfVersion1IsRejectedBeforeTheFirstTap) {
  const std::string command = "python3 -SE '" + write("program.py", "").string() + "'";
  EXPECT_THAT(refused(Words{"run", any_side(), "backend={type: process, command: " + test::yaml_quoted(command) + "}"}),
              AllOf(HasSubstr("process only taps from above, which the belief solids does not"),
                    HasSubstr("with backend process protocol: 2")));
  EXPECT_TRUE(left_nothing());
}

TEST_F(AnyLine, FromAboveVersion2HasTheFieldsOfVersion1AndTakesDistances) {
  // The dome of the example by its distance from the start of the line.
  const std::string body =
      "import math\n"
      "for ask in asks():\n"
      "    assert ask['line']['direction'] == [0, 0, -1] and ask['line']['start'][:2] == [ask['x'], ask['y']]\n"
      "    away = math.hypot(ask['x'] - ask['area']['width'] / 2, ask['y'] - ask['area']['depth'] / 2)\n"
      "    height = math.sqrt(max(0.0, 0.06**2 - away**2))\n"
      "    found = {'distance': ask['line']['start'][2] - height}\n"
      "    if ask['tap'] % 2: found = {'contacts': [{'position': [ask['x'], ask['y'], height]}]}\n"
      "    tell(ask, outcome='contact', force=10, seconds=1, **found)\n";
  const std::string command = "python3 -SE '" + write("program.py", test::python(body)).string() + "'";
  const fs::path run = ran(Words{"backend.protocol=2", "backend.command=" + command}, config("process.yaml"));
  const std::vector<Row> rows = rows_of(run, "tap");
  ASSERT_EQ(rows.size(), 17U);
  for (const Row& row : rows) {
    const double away = std::hypot(row.number("x").value() - 0.115, row.number("y").value() - 0.115);
    EXPECT_NEAR(row.number("height").value(), std::sqrt(std::max(0.0, 0.06 * 0.06 - away * away)), 1e-12);
    EXPECT_EQ(row.number("along"), std::nullopt);
  }
}

}  // namespace
}  // namespace palpate
