// SPDX-License-Identifier: MIT
// tests/same_taps.sh finds what differs between two builds: over programs whose taps are chosen here, and over this
// build with the configs of another tree.
#include "support/sanitizers.hpp"
#include "system/shell.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace palpate {
namespace {

namespace fs = std::filesystem;

class OtherBuild : public Shell {
 protected:
  /// A tree with a program that leaves tree/taps.csv as the taps of its only job, and its words in tree/words.
  void pretend(const std::string& tree, const std::string& taps) const {
    write(here() / tree / "taps.csv", taps);
    fs::create_directories(here() / tree / "configs");
    const fs::path program = write(here() / tree / "build/release/palpate", R"(#!/bin/sh
for word in "$@"; do echo "$word"; done >words
while [ $# -gt 0 ]; do
  case $1 in name=*) name=${1#name=} ;; --runs) runs=$2 ;; esac
  shift
done
job=$runs/$name/id/jobs/$(basename "$PWD" | md5sum | cut -c1-12)
mkdir -p "$job" && cp taps.csv "$job"
echo "{\"job\": 0, \"id\": \"${job##*/}\"}" >"$runs/$name/id/manifest.jsonl"
)");
    fs::permissions(program, fs::perms::owner_all);
  }
  Ended compare(const std::vector<std::string>& more, const fs::path& program) const {
    std::vector<std::string> words{"/bin/sh", (test::source_folder() / "tests/same_taps.sh").string(),
                                   (here() / "other/build/release/palpate").string(), "--here", program.string()};
    words.insert(words.end(), more.begin(), more.end());
    return test::run_program(words, here());
  }
  /// Of the pretended programs of the trees `here` and `other`, whose columns have the same names.
  Ended compare() const {
    const std::string renames = write(here() / "renames.csv", "what,other,here\n").string();
    return compare({"standard", "--renames", renames}, here() / "here/build/release/palpate");
  }
};

const std::string kTaps = "tap,reason,x,gp.noise,gp.signal\n1,\"far, \"\"too\"\" far\",0.5,1,2\n2,,0.25,3,4\n";

TEST_F(OtherBuild, DiffersByOneDigitOfOneCellOrByATapLess) {
  pretend("here", kTaps);
  pretend("other", "x,tap,gp.signal,gp.noise,reason\n0.5,1,2,1,\"far, \"\"too\"\" far\"\n0.25,2,4,3.0,\n");
  const Ended digit = compare();
  EXPECT_EQ(digit.status, 1);
  EXPECT_EQ(digit.out,
            "standard: taps.csv differs in 1 of 1 jobs, the first above\n"
            "  job 0: tap 2: gp.noise is 3 here, 3.0 of the other program\n");
  pretend("other", kTaps.substr(0, kTaps.find("2,,")));
  EXPECT_THAT(compare().out, HasSubstr("job 0: tap 2 only here"));
  pretend("here", kTaps.substr(0, kTaps.find("1,\"")));
  pretend("other", kTaps.substr(0, kTaps.find("1,\"")));
  EXPECT_THAT(compare().out, HasSubstr("no taps to compare"));
}

TEST_F(OtherBuild, RunsTheConfigsOfItsOwnTree) {
  if (test::brief()) GTEST_SKIP() << "./check --all makes it in release";
  const fs::path program = write(here() / "other/build/release/palpate",
                                 fmt::format("#!/bin/sh\nexec '{}' \"$@\"\n", test::program_file().string()));
  fs::permissions(program, fs::perms::owner_all);
  fs::create_directories(here() / "other/configs/effects");
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "configs")) {
    if (entry.path().filename() != "effects")
      fs::create_symlink(entry.path(), here() / "other/configs" / entry.path().filename());
  }
  const std::string standard = text_of(test::source_folder() / "configs/effects/standard.yaml");
  const fs::path effects = write(here() / "other/configs/effects/standard.yaml", standard);
  const Ended same = compare({"--seeds", "1", "standard"}, test::program_file());
  EXPECT_EQ(same.status, 0) << same.out << same.err;
  EXPECT_EQ(same.out, "standard: taps.csv of 12 jobs equal, 360 taps\n");

  write(effects, standard + "  push: {after: 15, distance: 1.5 cm}\n");
  const Ended pushed = compare({"--seeds", "1", "standard"}, test::program_file());
  EXPECT_EQ(pushed.status, 1);
  EXPECT_THAT(pushed.out, HasSubstr("standard: taps.csv differs in "));
  EXPECT_THAT(pushed.out, HasSubstr(": tap "));
}

}  // namespace
}  // namespace palpate
