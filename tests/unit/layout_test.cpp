// SPDX-License-Identifier: MIT
#include "config/text_layout.hpp"

#include "support/testing.hpp"

namespace palpate::test {
namespace {

TEST(Wrapped, BreaksBetweenWordsAndLeavesALongWordWhole) {
  EXPECT_THAT(wrapped("aa bb  c\nd", 5), testing::ElementsAre("aa bb", "c d"));
  EXPECT_THAT(wrapped("a longword b", 5), testing::ElementsAre("a", "longword", "b"));
  EXPECT_TRUE(wrapped(" ", 5).empty());
}

TEST(Aligned, LeavesOutAnEmptyColumnAndBlanksAtTheEnd) {
  EXPECT_EQ(aligned({{"a", "", "1"}, {"bcd", "", "23"}, {"e", "", ""}}, "llr"), "a     1\nbcd  23\ne\n");
}

}  // namespace
}  // namespace palpate::test
