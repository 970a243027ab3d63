// SPDX-License-Identifier: MIT
// Numbers within sentences.
#include "report/words/words.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace palpate {
namespace {

TEST(Words, TakeTheUnitThatSuitsALength) {
  EXPECT_EQ(length_words(0.0), "0 cm");
  EXPECT_EQ(length_words(-0.0), "0 cm");
  EXPECT_EQ(length_words(1e-4), "0.1 mm");
  EXPECT_EQ(length_words(0.017), "1.7 cm");
  EXPECT_EQ(length_words(-0.0906652), "-9.067 cm");
  EXPECT_EQ(length_words(1.0), "1 m");
  EXPECT_EQ(plain_words(-0.0), "0");
  EXPECT_EQ(plain_words(0.38483319), "0.3848");
  EXPECT_EQ(counted(1, "tap"), "1 tap");
  EXPECT_EQ(counted(0, "tap"), "0 taps");
}

TEST(Words, OfARecordAreNoneWhereItHasNoNumber) {
  Row row;
  row.add("u", 0.25);
  row.add("height", 0.017);
  row.add("w", std::optional<double>());
  row.add("why", "text");
  EXPECT_EQ(number_words(row, "u"), "0.25");
  EXPECT_EQ(number_words(row, "height", length_words), "1.7 cm");
  for (const char* field : {"w", "why", "absent"}) EXPECT_EQ(number_words(row, field), "");
}

TEST(Page, BreaksLinesBetweenWordsAndLosesNone) {
  TextSections page;
  page.heading("Of\na tap");
  std::string said;
  for (int i = 0; i < 60; ++i) said += (i == 0 ? "" : " ") + std::to_string(i * i * i);
  page.add(said);
  page.add(std::string(150, 'x') + "\ny");
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
