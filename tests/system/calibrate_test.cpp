// SPDX-License-Identifier: MIT
// `palpate calibrate`: a file that configs take as it is, and what runs are refused.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

class CalibrateCommand : public Shell {
 protected:
  fs::path tapped(const Words& more = {}) const {
    return ran(set_by("scene=block acquisition=random taps=30 scene.effects=standard", more), config("default.yaml"));
  }
};

TEST_F(CalibrateCommand, PrintsAFileThatAConfigTakesAsItsEffects) {
  const fs::path one = tapped();
  const fs::path other = tapped("seed=2");
  const Ended ended = palpate({"calibrate", one, other});
  ASSERT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.err, "");
  EXPECT_THAT(ended.out, StartsWith("# Effects of an arm, by 60 taps of\n#   " + one.string() + " (simulator)\n#   " +
                                    other.string() + " (simulator)\n"));
  EXPECT_EQ(palpate({"calibrate", one, other}).out, ended.out) << "it draws the same again";
  write("effects/mine.yaml", ended.out);
  const fs::path own = write("own.yaml", text_of(config("default.yaml")));
  const Ended resolved = palpate({"run", own, "scene.effects=mine", "--print-config"});
  ASSERT_EQ(resolved.status, 0) << resolved.err;
  EXPECT_THAT(resolved.out, HasSubstr("height_offset:"));
  EXPECT_THAT(resolved.out, HasSubstr("false_contacts:"));
}

TEST_F(CalibrateCommand, SaysWhichCountsAreExpectedAndHowMuchOfARateTheMotionsShow) {
  const std::string file = palpate({"calibrate", tapped()}).out;
  EXPECT_THAT(file, ContainsRegex("missed_contacts: .*# [0-9]+ of 30 taps made no contact; [^ ]+ \\[.*\\] per tap, of "
                                  "which these motions reveal [0-9]+ %\n"));
  EXPECT_THAT(file,
              ContainsRegex("false_contacts: .*# [0-9]+\\.[0-9] of [0-9]+ contacts are estimated to be far from the "
                            "scene; [^ ]+ \\[.*\\] per tap, of which these motions reveal [0-9]+ %\n"));
}

TEST_F(CalibrateCommand, RefusesInOneLineWhatSaysTooLittle) {
  const fs::path run = tapped();
  EXPECT_THAT(refused({"calibrate", tapped("taps=5")}),
              HasSubstr("taps are contacts, but 10 are needed, make more taps on a "));
  EXPECT_THAT(refused({"calibrate", here() / "nowhere"}), HasSubstr("nowhere"));
  const std::string replay = "backend={type: replay, record: " + run.string() + "}";
  const fs::path again = ran(Words{"scene=block", "taps=20", replay}, config("default.yaml"));
  EXPECT_THAT(refused({"calibrate", again}), HasSubstr("its backend, replay, has no motion to simulate"));
}

}  // namespace
}  // namespace palpate
