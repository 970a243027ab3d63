// SPDX-License-Identifier: MIT
// What is recorded and what is computed now are told apart; and numbers read like words.
#include "report/words/evidence.hpp"
#include "report/words/words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

namespace palpate {
namespace {

using ::testing::ElementsAre;

TEST(Evidence, PrefersTheRecordAndMarksWhatIsComputed) {
  Row recorded;
  recorded.add("u", 0.5);
  recorded.add("w", std::optional<double>());
  recorded.add("ties", 3);
  Row computed;
  computed.add("u", 0.75);
  computed.add("w", 0.25);
  const Evidence evidence(recorded, computed);
  EXPECT_EQ(evidence.number("u"), 0.5);
  EXPECT_EQ(evidence.number("ties"), 3.0);
  EXPECT_EQ(evidence.star("u"), "");
  EXPECT_FALSE(evidence.starred());
  EXPECT_EQ(evidence.number("w"), 0.25);
  EXPECT_EQ(evidence.star("w"), "*");
  EXPECT_TRUE(evidence.starred());
  EXPECT_FALSE(evidence.number("e").has_value());
}

TEST(Evidence, NeverCompletesARecordedProcessWithComputedFields) {
  Row recorded;
  recorded.add("height_process.signal", 1.0);
  recorded.add("weight_process.signal", std::optional<double>());
  Row computed;
  computed.add("height_process.kernel.length_scale", 0.02);
  computed.add("height_process.signal", 2.0);
  computed.add("height_process.fit.reason", "of another build");
  computed.add("weight_process.kernel.kernels.0.length_scale", 0.03);
  computed.add("weight_process.signal", 3.0);
  const Evidence evidence(recorded, computed);
  EXPECT_EQ(evidence.number("height_process.signal"), 1.0);
  EXPECT_EQ(evidence.text("height_process.fit.reason"), "");
  EXPECT_TRUE(evidence.below("height_process.kernel.").empty());
  EXPECT_EQ(evidence.number("weight_process.signal"), 3.0);
  EXPECT_FALSE(evidence.recorded("weight_process.signal"));
  EXPECT_THAT(evidence.below("weight_process.kernel."), ElementsAre("kernels.0.length_scale"));
}

TEST(Words, TakeTheUnitThatSuitsALength) {
  EXPECT_EQ(length_words(0.0), "0 cm");
  EXPECT_EQ(length_words(-0.0), "0 cm");
  EXPECT_EQ(length_words(1e-4), "0.1 mm");
  EXPECT_EQ(length_words(0.017), "1.7 cm");
  EXPECT_EQ(length_words(-0.0906652), "-9.067 cm");
  EXPECT_EQ(length_words(1.0), "1 m");
  EXPECT_EQ(plain_words(-0.0), "0");
  EXPECT_EQ(plain_words(0.38483319), "0.384833");
  EXPECT_EQ(counted(1, "tap"), "1 tap");
  EXPECT_EQ(counted(0, "tap"), "0 taps");
}

TEST(Page, BreaksLinesBetweenWordsAndLosesNone) {
  Page page;
  page.heading("Of\na tap");
  std::string said;
  for (int i = 0; i < 60; ++i) said += (i == 0 ? "" : " ") + std::to_string(i * i * i);
  page.say(said);
  page.say(std::string(150, 'x') + "\ny");
  std::istringstream lines(page.text());
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "Of a tap");
  std::string joined;
  for (int i = 0; i < 1000 && std::getline(lines, line) && line.find('x') == std::string::npos; ++i) {
    EXPECT_LE(line.size(), 100U);
    EXPECT_EQ(line.substr(0, 4), joined.empty() && i == 0 ? "  - " : "    ");
    joined += (joined.empty() ? "" : " ") + line.substr(4);
  }
  EXPECT_EQ(joined, said);
  EXPECT_EQ(std::count(page.text().begin(), page.text().end(), 'x'), 150);
}

}  // namespace
}  // namespace palpate
