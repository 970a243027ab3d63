// SPDX-License-Identifier: MIT
// What a program may answer, line by line, and what becomes of it.
#include "answers/tap_result_checks.hpp"
#include "unit/process_backend.hpp"

#include <cmath>

namespace palpate::test {
namespace {

/// One line as the answer to tap 2, what is said of it, and whether the program goes on.
struct Odd {
  const char* name;
  std::string line;
  std::string reason;
  bool kept;
};

class OddAnswer : public ProcessBackend, public testing::WithParamInterface<Odd> {};

TEST_P(OddAnswer, FailsTheTapWithOneClearLineAndTheNextTapIsFine) {
  const std::string file = folder_.write("odd", GetParam().line + "\n").string();
  const TapResult contact =
      second_tap("sys.stdout.buffer.write(open('" + file + "', 'rb').read()); sys.stdout.flush()", GetParam().kept);
  expect_failure(contact, Outcome::aborted, GetParam().reason);
}

std::vector<Odd> odd_answers() {
  const auto said = [](const std::string& what, const std::string& line) {
    return "the answer " + what + ": '" + line + "'";
  };
  const auto odd = [&](const char* name, const std::string& line, const std::string& what, bool kept) {
    return Odd{name, line, said(what, line), kept};
  };
  const std::string deep(60000, '[');
  const std::string endless(70000, 'x');
  const std::string nan = "is not JSON, which has no NaN and no Infinity";
  const auto height = [](const std::string& value) {
    return "is rejected, height " + value +
           " m is outside -0.04 to 0.135 m (1 cm below desk - overrun to desk + hover), " +
           "give metres in the scene's frame (are these millimetres?)";
  };
  const auto force = [](const std::string& value) {
    return "is rejected, force " + value +
           " N is outside 0 to 1000 N, give the size of the push in newtons (are these " + "millinewtons?)";
  };
  const auto seconds = [](const std::string& value) {
    return "is rejected, seconds " + value + " is outside 0 to 86400, give the time of the tap in seconds (are these " +
           "milliseconds?)";
  };
  return {
      odd("Nothing", "", "is not JSON", false),
      odd("Garbage", "moving to 3", "is not JSON", false),
      odd("CutOff", R"({"tap": 2, "outcome": "contact", "height": 0.0)", "is not JSON", false),
      odd("TwoObjects", R"({"tap": 2} {"tap": 2})", "is not JSON", false),
      odd("List", "[2]", "is not a JSON object", false),
      odd("NaN", R"({"tap": 2, "outcome": "contact", "height": NaN, "seconds": 1})", nan, false),
      odd("Infinity", R"({"tap": 2, "outcome": "contact", "height": 0, "seconds": Infinity})", nan, false),
      odd("BeyondDouble", R"({"tap": 2, "outcome": "contact", "height": 1e999})", "is not JSON", false),
      odd("NoNumber", R"({"outcome": "contact", "height": 0.07, "seconds": 1})", "lacks 'tap'", false),
      odd("EarlierTap", R"({"tap": 1, "outcome": "contact", "height": 0.07})", "does not belong to tap 2", false),
      odd("NumberAsText", R"({"tap": "2", "outcome": "contact", "height": 1})", "does not belong to tap 2", false),
      odd("NaNAsText", R"({"tap": 2, "outcome": "contact", "height": "NaN", "seconds": 1})",
          "has a 'height' that is not a number", true),
      odd("NoOutcome", R"({"tap": 2, "height": 0.07, "seconds": 1})", "lacks 'outcome'", true),
      odd("UnknownOutcome", R"({"tap": 2, "outcome": "hit", "height": 0.07, "seconds": 1})", "has an unknown outcome",
          true),
      odd("OutcomeOfResume", R"({"tap": 2, "outcome": "unknown", "reason": "?", "seconds": 1})",
          "has an unknown outcome", true),
      odd("OutcomeAsNumber", R"({"tap": 2, "outcome": 1})", "has a 'outcome' that is not a text", true),
      odd("NoHeight", R"({"tap": 2, "outcome": "contact", "seconds": 1})", "lacks 'height'", true),
      odd("NullHeight", R"({"tap": 2, "outcome": "contact", "height": null, "seconds": 1})", "lacks 'height'", true),
      odd("Millimetres", R"({"tap": 2, "outcome": "contact", "height": 70, "seconds": 1})", height("70"), true),
      odd("AboveTheWayOfTheArm", R"({"tap": 2, "outcome": "contact", "height": 0.1351, "seconds": 1})",
          height("0.1351"), true),
      odd("FarBelow", R"({"tap": 2, "outcome": "contact", "height": -1e300, "seconds": 1})", height("-1e+300"), true),
      odd("MillimetresBelowTheDesk", R"({"tap": 2, "outcome": "contact", "height": -3.0, "seconds": 1})", height("-3"),
          true),
      odd("BelowTheFloor", R"({"tap": 2, "outcome": "contact", "height": -0.0401, "seconds": 1})", height("-0.0401"),
          true),
      odd("ForceBeyondReason", R"({"tap": 2, "outcome": "contact", "height": 0, "seconds": 1, "force": 1e200})",
          force("1e+200"), true),
      odd("Pull", R"({"tap": 2, "outcome": "contact", "height": 0, "seconds": 1, "force": -8})", force("-8"), true),
      odd("NoSeconds", R"({"tap": 2, "outcome": "contact", "height": 0.07})", "lacks 'seconds'", true),
      odd("NegativeSeconds", R"({"tap": 2, "outcome": "contact", "height": 0.07, "seconds": -1})", seconds("-1"), true),
      odd("SecondsOfAnAge", R"({"tap": 2, "outcome": "contact", "height": 0.07, "seconds": 86400.1})",
          seconds("86400.1"), true),
      odd("FlagForForce", R"({"tap": 2, "outcome": "contact", "height": 0, "seconds": 1, "force": true})",
          "has a 'force' that is not a number", true),
      odd("NoReason", R"({"tap": 2, "outcome": "no_contact", "seconds": 1})", "lacks 'reason'", true),
      odd("BlankReason", R"({"tap": 2, "outcome": "no_contact", "seconds": 1, "reason": "\n"})",
          "has no text in 'reason'", true),
      odd("MisspeltField", R"({"tap": 2, "outcome": "contact", "heigth": 0.07, "seconds": 1})",
          "has an unknown field 'heigth'", true),
      odd("EndAsText", R"({"tap": 2, "outcome": "contact", "height": 0, "seconds": 1, "ends_run": "no"})",
          "has a 'ends_run' that is neither true nor false", true),
      odd("EndAsNumber", R"({"tap": 2, "outcome": "contact", "height": 0, "seconds": 1, "ends_run": 0})",
          "has a 'ends_run' that is neither true nor false", true),
      odd("EndWithoutReason", R"({"tap": 2, "outcome": "contact", "height": 0, "seconds": 1, "ends_run": true})",
          "lacks 'reason'", true),
      odd("EndForNoReason", R"({"tap": 2, "outcome": "aborted", "seconds": 1, "ends_run": true, "reason": "\t"})",
          "has no text in 'reason'", true),
      {"NoText", std::string("\0\xff\x1b[2J\xc3", 7), said("is not JSON", "???[2J?"), false},
      {"BadUtf8InReason", "{\"tap\": 2, \"outcome\": \"no_contact\", \"seconds\": 1, \"reason\": \"\xff\"}",
       said("is not JSON", R"({"tap": 2, "outcome": "no_contact", "seconds": 1, "reason": "?"})"), false},
      {"Deep", deep, said("is not JSON", deep.substr(0, 80) + "..."), false},
      {"TooLong", endless, "the program answered with a line that is too long: '" + endless.substr(0, 80) + "...'",
       false},
  };
}

INSTANTIATE_TEST_SUITE_P(Every, OddAnswer, testing::ValuesIn(odd_answers()),
                         [](const auto& one) { return one.param.name; });

TEST(Answer, HasTheSameBoundsForItsPeakAsForItsForce) {
  const TapLine line = line_from_above({});
  TapResult contact = contact_on(line, 0.05, 8.0, 1.0);
  EXPECT_FALSE(find_fault(contact, line, kAnyArm));
  for (const double peak : {0.0, 8.0, 1000.0}) {
    contact.peak_force = peak;
    EXPECT_FALSE(find_fault(contact, line, kAnyArm)) << peak;
  }
  for (const double peak : {-1.0, 1000.1, 1e300, HUGE_VAL, std::nan("")}) {
    contact.peak_force = peak;
    const auto fault = find_fault(contact, line, kAnyArm);
    ASSERT_TRUE(fault) << peak;
    EXPECT_THAT(fault->reason, testing::HasSubstr("N is outside 0 to 1000 N"));
  }
}

}  // namespace
}  // namespace palpate::test
