// SPDX-License-Identifier: MIT
// How pages of the documents are compared with what their commands print and draw (document.hpp).
#include "system/document.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

namespace palpate {
namespace {

using test::Document;
using test::same_line;

class Blocks : public Shell {
 protected:
  /// A page of one command, and what its part after that differs by from what is printed.
  std::string difference(const std::string& marked, const std::string& printed) const {
    Document page(write("page.md", "```sh\nls\n```\n" + marked + "\n"));
    return page.difference(1, printed, here());
  }
};

TEST_F(Blocks, AreComparedLetterByLetterButForBlanksBoldTypeAndTimesOfDay) {
  EXPECT_TRUE(same_line("| **2 (1-3)** | 0.5 |", "| 2 (1-3) |   0.5 |", 0.0));
  EXPECT_TRUE(same_line("a 2026-11-25T00:02:05 b", "a 2027-01-01T10:00:00 b", 0.0));
  EXPECT_FALSE(same_line("error: 0.26 cm", "error: 0.27 cm", 0.0));
  EXPECT_FALSE(same_line("error: 0.26 cm", "error: 0.260 cm", 0.0));
  EXPECT_FALSE(same_line("14 on the object", "14 on the desk", 0.0));
  EXPECT_FALSE(same_line("runs/default/602185fcd5ad", "runs/default/602185fcd5ae", 0.5)) << "an id is no number";
  EXPECT_FALSE(same_line("1 2", "1", 0.5));
}

TEST_F(Blocks, MayHaveNumbersWithinAShareAndOneInTheLastDigit) {
  EXPECT_TRUE(same_line("took 102 ms", "took 100 ms", 0.02));
  EXPECT_FALSE(same_line("took 104 ms", "took 100 ms", 0.02));
  EXPECT_TRUE(same_line("0.1 mm", "0.2 mm", 0.01));
  EXPECT_FALSE(same_line("0.1 mm", "0.3 mm", 0.01));
  EXPECT_TRUE(same_line("3e-05", "2e-05", 0.01));
}

TEST_F(Blocks, ShowLinesOfWhatIsPrintedInItsOrder) {
  const std::string block = "<!-- printed -->\n```\none 1\nthree 3\n```";
  EXPECT_EQ(difference(block, "zero 0\none 1\ntwo 2\nthree 3\n"), "");
  EXPECT_THAT(difference(block, "one 1\nthree 4\n"),
              HasSubstr("page.md:7: shows    three 3\n  but is printed: three 4\n"));
  EXPECT_THAT(difference(block, "three 3\none 1\n"),
              HasSubstr("page.md:7: shows    three 3\n  but is printed: nothing"));
  EXPECT_EQ(difference("<!-- printed, within 30 % -->\n```\none 1\nthree 3\n```", "one 1\nthree 4\n"), "");
}

TEST_F(Blocks, ShowTablesBesideColumnsThatAClockMakes) {
  const std::string table =
      "<!-- printed, not seconds -->\n\n| taps | seconds [s] | error |\n|---|---:|---|\n| 3 | 1.5 | 7 |\n";
  EXPECT_EQ(difference(table, "| taps | seconds [s] | error |\n|---|---|---|\n| 3 | 90 | 7 |\n"), "");
  EXPECT_THAT(difference(table, "| taps | seconds [s] | error |\n|---|---|---|\n| 3 | 1.5 | 8 |\n"),
              HasSubstr("page.md:8: "));
}

TEST_F(Blocks, SayOfANumberInAParagraphWhatIsPrinted) {
  const std::string said = "It says 1.4 +- 0.5\nmm.\n<!-- printed: 1.4 +- 0.5 mm -->\n";
  EXPECT_EQ(difference(said, "1.4 +- 0.5 mm more than the default\n"), "");
  EXPECT_THAT(difference(said, "11.4 +- 0.5 mm more\n"), HasSubstr("page.md:6: shows    1.4 +- 0.5 mm\n"));
  EXPECT_THAT(difference("It says 1.5 +- 0.6 mm.\n<!-- printed: 1.4 +- 0.5 mm -->\n", "1.4 +- 0.5 mm more\n"),
              HasSubstr("the page does not say: 1.4 +- 0.5 mm"));
}

TEST_F(Blocks, HavePicturesThatWereMadeWithTheNumbersAboveThem) {
  write("one/made.png", "new picture");
  write("shown.png", "old picture");
  const auto page = [&](const std::string& number, const std::string& seal) {
    return Document(write("page.md", "```sh\nls\n```\n<!-- printed -->\n```\nerror " + number +
                                         " of 0123456789ab\n```\n<!-- drawn */made.png, seal " + seal +
                                         " -->\n![a picture](shown.png)\n"));
  };
  Document kept = page("0.7", "");
  const std::string printed = "error 0.3 of 0123456789aa\n";
  EXPECT_EQ(kept.difference(1, printed, here(), true), "");
  EXPECT_EQ(kept.difference(2, printed, here(), true), "");
  kept.write();
  const std::string text = text_of(here() / "page.md");
  EXPECT_EQ(text_of(here() / "shown.png"), "new picture");
  EXPECT_THAT(text, HasSubstr("\n" + printed));
  Document again(here() / "page.md");
  EXPECT_EQ(again.difference(1, printed, here()) + again.difference(2, printed, here()), "");
  const std::string seal = text.substr(text.find("seal ") + 5, 32);
  EXPECT_THAT(page("0.4", seal).difference(2, "", here()), HasSubstr("were not made together"))
      << "only the number is new";
  write("shown.png", "old picture");
  EXPECT_THAT(again.difference(2, printed, here()), HasSubstr("were not made together")) << "only the picture is old";
}

TEST_F(Blocks, HaveNoMarkersThatNobodyUnderstands) {
  for (const char* marker :
       {"<!-- printed by ls -->\n```\n```", "<!-- printed -->\nwords", "<!-- printed -->", "<!-- drawn -->"})
    EXPECT_THROW(difference(marker, ""), std::runtime_error) << marker;
}

}  // namespace
}  // namespace palpate
