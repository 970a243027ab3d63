// SPDX-License-Identifier: MIT
// Records of runs whose config names a file that is gone by now, or another: of each kind of file, by each command that
// reads a record.
#include "support/programs.hpp"
#include "support/sanitizers.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ostream>

namespace palpate {
namespace {

/// What the file of a config is for.
enum class Use { truth, models, taps };

/// A kind of file that a config may name.
struct Kind {
  const char* name;
  const char* file;
  Use use;
  std::string option;   ///< of the config, with the file
  std::string content;  ///< "@" and a path below the source folder for a copy of that
  std::string other;    ///< which is as sound
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

std::string obj(const std::string& height) {
  return "v 0 0 0\nv 60 0 0\nv 0 60 0\nv 0 0 " + height + "\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
}

std::string ply(const std::string& height) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 4\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n60 0 0\n0 60 0\n0 0 " +
         height + "\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
}

/// An array of NumPy of 3 x 3 bytes, of which the middle one is `height`.
std::string npy(char height) {
  const std::string header = "{'descr': '|u1', 'fortran_order': False, 'shape': (3, 3), }\n";
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(header.size()) + '\0' + header + std::string(4, '\0') +
         height + std::string(4, '\0');
}

/// Points of a desk that a camera saw.
std::string view(const std::string& height) {
  return "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
         "0.02 0.02 0\n0.11 0.11 " +
         height + "\n";
}

std::string mesh(const std::string& file) {
  return "scene.objects=[{type: mesh, file: " + file + ", unit: 1 mm, at: [11.5 cm, 11.5 cm]}]";
}

std::string heights(const std::string& file, const std::string& unit) {
  return "scene.objects=[{type: height_map, file: " + file + ", unit: " + unit +
         ", spacing: 2 cm, at: [11.5 cm, 11.5 cm]}]";
}

std::string table(const std::string& height) {
  std::string out = "x,y,outcome,height\n";
  for (const char* x : {"0.05", "0.1", "0.15"}) {
    for (const char* y : {"0.05", "0.1", "0.15"}) out += std::string(x) + "," + y + ",contact," + height + "\n";
  }
  return out;
}

std::string echo(const std::string& more) {
  return "# reads=[\"uncertainty\"]\nwhile read -r ask; do " + more +
         "\n  b=${ask##*\\\"bytes\\\":}\n  head -c \"${b%\\}}\"\ndone\n";
}

std::vector<Kind> kinds() {
  const auto robot = [](const std::string& more) {
    return test::python(more + "for ask in asks():\n    contact(ask)\n");
  };
  return {
      {"Stl", "a.stl", Use::truth, mesh("a.stl"), "@configs/scene/solids/mug.stl", "@configs/scene/solids/bracket.stl"},
      {"Obj", "a.obj", Use::truth, mesh("a.obj"), obj("60"), obj("50")},
      {"Ply", "a.ply", Use::truth, mesh("a.ply"), ply("60"), ply("50")},
      {"Csv", "a.csv", Use::truth, heights("a.csv", "1 cm"), "0,0,0\n0,3,0\n0,0,0\n", "0,0,0\n0,5,0\n0,0,0\n"},
      {"Npy", "a.npy", Use::truth, heights("a.npy", "1 mm"), npy(30), npy(50)},
      {"Png", "a.png", Use::truth, heights("a.png", "1 um"), "@tests/data/heights/map_16.png",
       "@tests/data/heights/map_8.png"},
      {"View", "view.ply", Use::models, "belief.prior={depth: view.ply, unit: 1 m}", view("0"), view("0.05")},
      {"Table", "table.csv", Use::taps, "backend={type: replay, record: table.csv, tolerance: 1 m}", table("0.07"), ""},
      {"Process", "robot.py", Use::taps, "backend={type: process, command: python3 -SE robot.py, repeatable: true}",
       robot(""), robot("import math\n")},
      {"Program", "echo.sh", Use::taps, "acquisition={type: program, command: sh echo.sh}", echo(":"), echo("true;")},
  };
}

class RecordOf : public Shell, public testing::WithParamInterface<Kind> {
 protected:
  void put(const std::string& content) const {
    const std::string copy = content.empty() || content[0] != '@' ? "" : content.substr(1);
    write(GetParam().file, copy.empty() ? content : text_of(test::source_folder() / copy));
  }
  void lose() const { fs::remove(here() / GetParam().file); }

  /// What a command prints that reads the record, and what it wrote into the folder out.
  std::string said(const Words& words) const {
    const Ended ended = palpate(words);
    EXPECT_EQ(ended.status, 0) << words.front() << ": " << ended.err;
    std::string out = ended.out;
    if (!fs::exists(here() / "out")) return out;
    for (const auto& one : fs::recursive_directory_iterator(here() / "out")) {
      const std::string ending = one.path().extension().string();
      // A surface has the true heights where they are known.
      if (ending == ".csv" || (ending == ".ply" && GetParam().use != Use::truth) ||
          one.path().filename() == "curves.png")
        out += text_of(one.path());
    }
    fs::remove_all(here() / "out");
    return out;
  }

  /// One line on stderr that names the file, for what lacks the truth; else nothing.
  void expect_told_once(const Words& words) const {
    const std::string err = palpate(words).err;
    EXPECT_EQ(lines(err), GetParam().use == Use::truth ? 1 : 0) << words.front() << ": " << err;
    EXPECT_THAT(err, GetParam().use == Use::truth ? HasSubstr(GetParam().file) : HasSubstr("")) << words.front();
  }
};

TEST_P(RecordOf, AFinishedRunIsReadWithoutItsFileAndWithAnotherInItsPlace) {
  const Kind& kind = GetParam();
  const bool is_one_of_many =
      kind.use == Use::truth && kind.name != std::string("Stl") && kind.name != std::string("Csv");
  if (test::brief() && is_one_of_many) GTEST_SKIP() << "./check --all looks at every format";
  put(kind.content);
  const Words few{"taps=5", "candidates.count=12", "--quiet", kind.option};
  const Ended begun = palpate(Words{"run", paper()} + few);
  if (begun.err.find("which this build does not have") != std::string::npos ||
      begun.err.find("which this build cannot read") != std::string::npos)
    GTEST_SKIP() << begun.err;
  ASSERT_EQ(begun.status, 0) << begun.err;
  const fs::path run = directory();
  const std::vector<Words> of_record{{"status", run}, {"list"}, {"export", run, "--format", "csv", "--to", "out"}};
  const std::vector<Words> of_models{
      {"explain", run, "4"}, {"export", run, "--to", "out"}, {"report", run, "--figures", "--to", "out"}};
  std::vector<std::string> whole;
  for (const auto* list : {&of_record, &of_models})
    for (const Words& words : *list) whole.push_back(said(words));
  for (const std::string& now : {std::string(), kind.other}) {
    SCOPED_TRACE(now.empty() ? "gone" : "another");
    now.empty() ? lose() : put(now);
    std::size_t next = 0;
    for (const Words& words : of_record) EXPECT_EQ(said(words), whole[next++]) << words.front();
    EXPECT_EQ(resume(run).status, 0) << "a finished run is shown";
    if (kind.use == Use::models) {
      for (const Words& words : of_models) EXPECT_THAT(refused(words), HasSubstr(kind.file));
      EXPECT_THAT(refused({"replay", run}), HasSubstr(kind.file));
      continue;
    }
    EXPECT_THAT(said({"replay", run}), ContainsRegex("5 taps, [0-9]+ numbers, all equal"));
    for (const Words& words :
         {Words{"replay", run}, Words{"report", run, "--to", "out"}, Words{"export", run, "--to", "out"}})
      expect_told_once(words);
    fs::remove_all(here() / "out");
    // Of the errors, too, which are in this record: curves.png is byte for byte that with the file.
    if (!now.empty()) continue;
    for (const Words& words : of_models) EXPECT_EQ(said(words), whole[next++]) << words.front();
  }
  lose();
  cut_taps(run);
  // What is tapped is in no record. A program may come back.
  const int status = kind.option.find("command: ") != std::string::npos ? 75 : 2;
  EXPECT_THAT(refused({"resume", run, "--quiet"}, status), HasSubstr(kind.file));
}

INSTANTIATE_TEST_SUITE_P(Each, RecordOf, testing::ValuesIn(kinds()),
                         [](const auto& kind) { return std::string(kind.param.name); });

class LostMesh : public Shell {
 protected:
  void put(const std::string& solid) const {
    write("a.stl", text_of(test::source_folder() / "configs/scene/solids" / (solid + ".stl")));
  }
  std::string own_config() const {
    return write("own.yaml",
                 "strategy: weighted\nbackend: simulator\nscene:\n  area: {width: 23 cm, depth: 23 cm}\n"
                 "  min_object_height: 1 cm\n"
                 "  objects: [{type: mesh, file: a.stl, unit: 1 mm, at: [11.5 cm, 11.5 cm]}]\n")
        .string();
  }
};

TEST_F(LostMesh, ASweepIsReadAndWhatItsRecordsLackIsRefusedByTheNameOfTheFile) {
  put("mug");
  const fs::path sweep = swept("taps=5 candidates.count=12 acquisition=random,uncertainty seed=1,2", own_config());
  const fs::path run = ran("taps=5 candidates.count=12 --runs alone", own_config());
  const Words curves{"curves", sweep, "-o", "curves.csv"};
  const Words at_2 = Words{"compare", sweep} + "--by acquisition --metric rmse_m --at 2";
  fs::remove(here() / "a.stl");
  fs::remove(run / "surface.csv");
  EXPECT_THAT(refused({"resume", run, "--quiet"}), HasSubstr("a.stl: no such file"));
  for (const Words& words : {curves, at_2}) EXPECT_THAT(refused(words, 1), HasSubstr("a.stl: no such file"));
  put("bracket");
  EXPECT_THAT(refused(curves, 1), HasSubstr("a.stl"));
  put("mug");
  ASSERT_EQ(palpate(curves).status, 0);
  const std::string whole = text_of(here() / "curves.csv");
  fs::remove(here() / "a.stl");
  for (const Words& words : {curves, Words{"report", sweep}, Words{"resume", sweep, "--quiet"}, Words{"status", sweep},
                             Words{"compare", sweep} + "--by acquisition --metric rmse_m", at_2,
                             Words{"pareto", sweep} + "--cost robot_seconds --error rmse_m"}) {
    const Ended ended = palpate(words);
    EXPECT_EQ(ended.status, 0) << words.front() << ": " << ended.err;
  }
  EXPECT_EQ(text_of(here() / "curves.csv"), whole);
}

}  // namespace
}  // namespace palpate
