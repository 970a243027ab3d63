// SPDX-License-Identifier: MIT
// The acquisition `program` against programs that behave and programs that do not.
#include "support/mocks.hpp"
#include "support/programs.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

#include <palpate/acquisition.hpp>

#include <atomic>
#include <cstring>

namespace palpate::test {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;
using testing::StartsWith;

/// Six candidates in two rows.
WrittenBelief written() {
  WrittenBelief out;
  out.tapped = {4, 3};
  out.lines.starts.setZero(6, 3);
  out.lines.starts.col(0) << 0.01, 0.02, 0.03, 0.01, 0.02, 0.03;
  out.lines.starts.col(1) << 0.05, 0.05, 0.05, 0.06, 0.06, 0.06;
  out.lines.from_above = true;
  out.lines.rows = 2;
  out.lines.columns = 3;
  out.arrays[quantity::kUncertainty] = Eigen::VectorXd{{1.0, 0.5, 0.2, 0.0, 0.8, 0.1}};
  out.arrays[quantity::kLabelMean] = Eigen::VectorXd{{0.1, 1.2, -0.3, 0.5, 0.0, 0.25}};
  out.arrays[quantity::kObjectProbability] = Eigen::VectorXd{{0.0, 0.25, 0.5, 1.0, 0.9, 0.75}};
  out.arrays[quantity::kHeightStd] = out.arrays[quantity::kUncertainty];
  return out;
}

/// Reads an ask and its arrays, in the standard library alone; scores are sent by `answer(values)`.
constexpr const char* kHead = R"py(import json, os, struct, sys, time

def asks():
    for line in sys.stdin.buffer:
        ask = json.loads(line)
        ask["raw"] = {a["name"]: sys.stdin.buffer.read(a["bytes"]) for a in ask["arrays"]}
        yield ask

def numbers(raw):
    return list(struct.unpack("<%dd" % ((len(raw) - 128) // 8), raw[128:]))

def npy(values, descr="<f8", shape=None):
    header = "{'descr': '%s', 'fortran_order': False, 'shape': %s, }" % (descr, shape or "(%d,)" % len(values))
    header += " " * (117 - len(header)) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() + struct.pack("<%dd" % len(values), *values)

def answer(values, **more):
    sys.stdout.buffer.write(npy(values, **more))
    sys.stdout.buffer.flush()

)py";

class ProgramAcquisition : public InFolder {
 protected:
  ProgramAcquisition() { fs::create_directory(folder_.path() / "record"); }

  /// The words that start a Python program with this body, which declares what it reads.
  std::string command(const std::string& body, const std::string& reads = "\"uncertainty\"") const {
    const std::string declared = "def declares(reads=[" + reads + "]): pass\n";
    return "python3 -SE '" + folder_.write("program.py", kHead + declared + body).string() + "'";
  }

  std::shared_ptr<Acquisition> open(const std::string& command, const std::string& more = "") const {
    return context_.create<Acquisition>(
        choose(shared_host(), "acquisition", "program", "{command: " + yaml_quoted(command) + more + "}"));
  }

  static std::vector<double> scores(const Acquisition& acquisition) {
    Eigen::VectorXd out(6);
    acquisition.score(written(), out);
    return {out.data(), out.data() + 6};
  }

  /// What is said of a program that answers its first ask by `odd`.
  std::string trouble(const std::string& odd, const std::string& more = "") const {
    const auto acquisition = open(command("for ask in asks():\n    " + odd + "\n"), more);
    return error_of([&] { scores(*acquisition); });
  }

  /// What the programs in the record's folder said, one after the other by the names of their files.
  std::string diary() const { return texts_of(".stderr.txt"); }
  std::string texts_of(const std::string& ending) const {
    std::set<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder_.path() / "record")) {
      const std::string name = entry.path().filename().string();
      if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
        files.insert(entry.path());
    }
    std::string out;
    for (const fs::path& file : files) out += text_of(file);
    return out;
  }

  std::atomic<bool> interrupted_{false};
  Context context_{shared_host(), wave_scene(), 7, &interrupted_, (folder_.path() / "record").string()};
};

TEST_F(ProgramAcquisition, SendsTheArraysThatTheProgramNamesAndTakesItsScores) {
  const auto acquisition =
      open(command("for ask in asks():\n"
                   "    maps = [numbers(ask['raw'][name]) for name in ('height_std', 'object_probability')]\n"
                   "    places = numbers(ask.pop('raw')['desk_position'])\n"
                   "    sys.stderr.write(json.dumps(ask) + str(places[:4]) + '\\n')\n"
                   "    answer([a * b for a, b in zip(*maps)])\n",
                   "\"height_std\", 'object_probability',\n  \"desk_position\""));
  EXPECT_EQ(acquisition->reads(),
            (QuantitySet{quantity::kHeightStd, quantity::kObjectProbability, quantity::kDeskPosition}))
      << "the models of others are not built";
  const WrittenBelief belief = written();
  const Eigen::VectorXd expected =
      belief.arrays.at(quantity::kHeightStd).cwiseProduct(belief.arrays.at(quantity::kObjectProbability));
  EXPECT_EQ(scores(*acquisition), std::vector<double>(expected.data(), expected.data() + 6));
  EXPECT_EQ(diary(),
            R"({"palpate": 1, "tap": 5, "initial_taps": 3, "rows": 2, "columns": 3, "candidates": 6, )"
            R"("area": {"width": 0.23, "depth": 0.23}, "desk": 0, "seed": 7, )"
            R"("arrays": [{"name": "height_std", "bytes": 176}, {"name": "object_probability", "bytes": 176}, )"
            R"({"name": "desk_position", "bytes": 224}], "bytes": 576}[0.01, 0.05, 0.02, 0.05])" +
                std::string("\n"));
}

TEST_F(ProgramAcquisition, IsToldInOneLineWithPlaceReasonAndRemedyWhateverItDoesInsteadOfScoring) {
  EXPECT_EQ(trouble("answer([1.0] * 5)"),
            "acquisition/program: the program answered with an array of the shape '(5,)', not (6,): '{'descr': '<f8', "
            "'fortran_order': False, 'shape': (5,), }                       ...', correct it; a changed program makes "
            "a new run");
  EXPECT_THAT(trouble("answer([1.0] * 6, shape='(2, 3)')"), HasSubstr("an array of the shape '(2,3)', not (6,)"));
  EXPECT_THAT(trouble("answer([1.0] * 6, descr='<f4')"), HasSubstr("numbers of the type '<f4', not '<f8'"));
  EXPECT_THAT(trouble("answer([1.0] * 5 + [float('nan')])"),
              HasSubstr("gave candidate 5 the score nan, which is not a finite number"));
  EXPECT_THAT(trouble("print('[1, 2, 3, 4, 5, 6]', flush=True)"),
              HasSubstr("answered with data that is not an array in the format NPY 1.0: '[1, 2, 3, "));
  EXPECT_THAT(
      trouble("sys.exit('no torch here')"),
      testing::MatchesRegex("acquisition/program: the program ended with exit status 1, its last output: 'no torch "
                            "here', correct it, its output is in .*/record/acquisition_[0-9a-f]{8}.stderr.txt"));
  EXPECT_THAT(trouble("import numpy"), HasSubstr("Debian: apt install python3-numpy")) << "-S finds no packages";
  EXPECT_THAT(trouble("os.kill(os.getpid(), 9)"), HasSubstr("the program was ended by signal 9 (Killed)"));
  EXPECT_THAT(trouble("time.sleep(600)", ", deadline: 0.2 s, start: 0 s"),
              AllOf(StartsWith("acquisition/program: the program sent no scores in time and has never sent any"),
                    HasSubstr("acquisition.deadline")));
  EXPECT_THAT(trouble("sys.stdout.buffer.write(npy([1.0] * 6)[:-1]); sys.stdout.buffer.flush(); time.sleep(600)",
                      ", deadline: 0.2 s, start: 0 s"),
              AnyOf(HasSubstr("incomplete scores until the deadline"), HasSubstr("sent no scores in time")))
      << "the second on a machine so busy that the program had not begun";
  const auto chatty = open(command(
      "for ask in asks():\n    sys.stdout.buffer.write(npy([1.0] * 6) + b'more')\n    sys.stdout.buffer.flush()\n"));
  EXPECT_EQ(scores(*chatty), std::vector<double>(6, 1.0));
  EXPECT_THAT(error_of([&] { scores(*chatty); }), HasSubstr("the program printed more than its scores"));
}

TEST_F(ProgramAcquisition, KeepsTheTextOfItsProgramWithTheRun) {
  const auto acquisition = open(command("for ask in asks():\n    answer([1.0] * 6)\n"));
  EXPECT_EQ(texts_of(".py"), "") << "nothing was started";
  scores(*acquisition);
  const std::string text = text_of(folder_.path() / "program.py");
  EXPECT_EQ(texts_of(".py"), text);
  folder_.write("program.py", "another one by now");
  EXPECT_EQ(texts_of(".py"), text);
}

TEST_F(ProgramAcquisition, BesideAnotherInAMixtureHasItsOwnFileForWhatItSays) {
  const auto part = [&](const char* name) {
    const std::string body = std::string("for ask in asks():\n    sys.stderr.write('") + name +
                             "\\n')\n    sys.stderr.flush()\n    answer([1.0] * 6)\n";
    const fs::path file = folder_.write(std::string(name) + ".py", kHead + body);
    return "{type: program, reads: none, command: " + yaml_quoted("python3 -SE '" + file.string() + "'") + "}";
  };
  const std::string both = "{acquisitions: [" + part("first") + ", " + part("second") + "]}";
  for (int process = 1; process <= 2; ++process) {  // as when a run is resumed
    const auto sum = context_.create<Acquisition>(choose(shared_host(), "acquisition", "sum", both));
    EXPECT_EQ(scores(*sum), std::vector<double>(6, 2.0));
  }
  EXPECT_THAT(diary(), testing::AnyOf("first\nfirst\nsecond\nsecond\n", "second\nsecond\nfirst\nfirst\n"));
}

TEST_F(ProgramAcquisition, IsEndedWithAllThatItStarted) {
  long own = 0;
  long other = 0;
  {
    const auto acquisition =
        open(command("import subprocess\n"
                     "for ask in asks():\n"
                     "    child = subprocess.Popen(['sleep', '600'], start_new_session=True)\n"
                     "    answer([os.getpid(), child.pid, 0, 0, 0, 0])\n"));
    own = std::lround(scores(*acquisition).at(0));
    other = std::lround(scores(*acquisition).at(1));
    EXPECT_TRUE(running(own) && running(other));
  }
  EXPECT_FALSE(running(own));
  EXPECT_FALSE(running(other));
}

TEST_F(ProgramAcquisition, IsNotStartedWhereNoRecordIsKept) {
  const std::string words = command("open('started', 'w')\nfor ask in asks(): answer([1.0] * 6)\n");
  context_.directory.clear();
  const auto acquisition = open(words);
  EXPECT_EQ(error_of([&] { scores(*acquisition); }),
            "acquisition/program: programs are started in a run only, use the values that the run recorded");
  EXPECT_FALSE(fs::exists("started"));
}

TEST_F(ProgramAcquisition, SaysWhatIsWrongWithItsOptionsBeforeAnythingStarts) {
  const auto refusal = [&](const std::string& words, const std::string& more = "") {
    return error_of([&] { open(words, more); });
  };
  EXPECT_EQ(refusal(command("")), "accepted");
  EXPECT_THAT(refusal(command("", "\"height\"")),
              AllOf(HasSubstr("plugin.command: reads=[...] in '"),
                    HasSubstr("has 'height', which is not one of uncertainty, label_mean, "), HasSubstr(", contacts, "),
                    HasSubstr(", surface_std, ")))
      << "the config has no reads";
  EXPECT_THAT(refusal(command(""), ", reads: height"), HasSubstr("plugin.reads: has 'height', which is not one of "));
  EXPECT_THAT(refusal(command("reads=['height_mean']")), HasSubstr("the program has several reads=[...]"));
  EXPECT_EQ(refusal(command("reads=['height_mean']"), ", reads: \"height_mean\""), "accepted");
  EXPECT_THAT(refusal("python3 -m mine"), HasSubstr("is not given, and 'python3 -m mine' names no file in"));
  EXPECT_THAT(refusal("python3 -m mine"), HasSubstr("relative paths start in the current folder"));
  fs::create_directory(folder_.path() / "own");
  folder_.write("own/own.py", "# reads=[\"uncertainty\"]\n");
  EXPECT_THAT(refusal("python3 own/own.py", ", folder: " + yaml_quoted((folder_.path() / "own").string())),
              HasSubstr("so call palpate in '" + folder_.path().string() + "'"));
  const std::string both = command("", "\"height_mean\", \"surface_std\"");
  EXPECT_EQ(refusal(both), "accepted");
  const std::vector<std::string> words{"acquisition={type: program, command: " + yaml_quoted(both) + "}"};
  EXPECT_THAT(error_of([&] { Prepared("default.yaml", words); }),
              HasSubstr("acquisition: program reads surface_std, which the belief height_map does not offer"));
  EXPECT_THAT(error_of([&] { Prepared("any_side.yaml", words); }),
              HasSubstr("acquisition: program reads height_mean, which the belief solids does not offer"));
  EXPECT_THAT(refusal("nobody-has-this x", ", reads: uncertainty"), HasSubstr("there is no program 'nobody-has-this'"));
  EXPECT_THAT(refusal(command(""), ", checksum: other"), HasSubstr("restore the program that the run started with"));
}

TEST_F(ProgramAcquisition, AWaitForItsScoresIsBrokenOff) {
  const auto acquisition = open(command("for ask in asks(): time.sleep(600)\n"));
  interrupted_ = true;
  EXPECT_EQ(error_of([&] { scores(*acquisition); }),
            "acquisition/program: the program was interrupted, run 'palpate resume' to continue");
}

}  // namespace
}  // namespace palpate::test
