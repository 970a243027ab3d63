// SPDX-License-Identifier: MIT
#include "reading/reading.hpp"

#include "support/testing.hpp"

#include <sys/stat.h>

namespace palpate::test {
namespace {

class AReading : public InFolder {
 protected:
  using Kind = Reading::Kind;

  static Kind kind(const fs::path& file, Origin origin = Origin::record, std::uintmax_t most = 1000) {
    return read_bounded(file, most, origin).kind;
  }
};

TEST_F(AReading, HasEveryByteOfAFileUpToItsLimitAndNothingOfALargerOne) {
  const std::string text("a\0\r\n\xff", 5);
  const fs::path file = folder_.write("x", text);
  EXPECT_EQ(read_bounded(file, 5, Origin::record).text, text);
  const Reading large = read_bounded(file, 4, Origin::record);
  EXPECT_EQ(large.kind, Kind::too_large);
  EXPECT_EQ(large.text, "");
  EXPECT_EQ(read_bounded(folder_.write("empty", ""), 0, Origin::record).kind, Kind::whole);
}

TEST_F(AReading, OfOneEndOfAFileHasItsBytesAndTellsWhereTheyBegin) {
  const std::string text = "0123456789";
  const fs::path file = folder_.write("x", text);
  for (const std::size_t bytes : {0U, 1U, 9U, 10U, 11U, 100000U}) {
    const std::size_t there = std::min<std::size_t>(bytes, text.size());
    const Reading first = read_begin_bounded(file, bytes, Origin::record);
    const Reading last = read_end_bounded(file, bytes, Origin::record);
    EXPECT_EQ(first.text, text.substr(0, there)) << bytes;
    EXPECT_EQ(first.begin, 0U);
    EXPECT_EQ(last.text, text.substr(text.size() - there)) << bytes;
    EXPECT_EQ(last.begin, text.size() - there);
  }
  EXPECT_EQ(read_end_bounded(folder_.write("empty", ""), 5, Origin::record).text, "");
}

TEST_F(AReading, CountsTheBytesOfAFileThatSaysThatItHasNone) {
  EXPECT_GT(read_bounded("/proc/self/status", 100'000, Origin::user).text.size(), 100U);
  EXPECT_EQ(kind("/proc/self/status", Origin::user, 100), Kind::too_large);
}

TEST_F(AReading, ReturnsAtOnceWhatIsNoFile) {
  const fs::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const Origin origin : {Origin::user, Origin::record}) {
    EXPECT_EQ(kind(pipe, origin), Kind::not_regular);
    EXPECT_EQ(kind("/dev/zero", origin), Kind::not_regular);
    EXPECT_EQ(kind(folder_.path(), origin), Kind::not_regular);
    EXPECT_EQ(kind(folder_.path() / "none", origin), Kind::absent);
    EXPECT_EQ(kind(pipe / "none", origin), Kind::absent);
  }
}

TEST_F(AReading, FollowsLinksOfTheUserAndNoneInARecord) {
  const fs::path file = folder_.write("jobs/0123456789ab/x", "mine");
  fs::create_symlink(file, folder_.path() / "link");
  fs::create_directory_symlink(file.parent_path(), folder_.path() / "jobs/ba9876543210");
  fs::create_symlink("/dev/zero", folder_.path() / "zero");
  EXPECT_EQ(kind(folder_.path() / "link", Origin::user), Kind::whole);
  EXPECT_EQ(kind(folder_.path() / "link"), Kind::link);
  EXPECT_EQ(kind(folder_.path() / "zero", Origin::user), Kind::not_regular);
  EXPECT_EQ(kind(folder_.path() / "zero"), Kind::link);
  EXPECT_EQ(kind(file), Kind::whole);
  EXPECT_EQ(kind(folder_.path() / "jobs/ba9876543210/x"), Kind::link) << "the folder of a job";
  fs::create_directory_symlink(folder_.path() / "jobs", folder_.path() / "sweep");
  fs::create_directories(folder_.path() / "other");
  fs::create_directory_symlink(folder_.path() / "jobs", folder_.path() / "other/jobs");
  EXPECT_EQ(kind(folder_.path() / "other/jobs/0123456789ab/x"), Kind::link) << "the folder of all jobs";
  EXPECT_EQ(kind(folder_.path() / "sweep/0123456789ab/x"), Kind::whole) << "a path of the user";
}

TEST_F(AReading, IsToldOfInWords) {
  EXPECT_EQ(words_of(read_bounded(folder_.write("x", "12345"), 4, Origin::record), 4).reason,
            "is too large for what it should hold: at most 4 bytes are read");
  EXPECT_EQ(words_of({Kind::too_large, {}}, 512 << 20).reason,
            "is too large for what it should hold: at most 512 MiB are read");
}

TEST(Printable, KeepsTextAndLineEndsAndShowsWhatATerminalWouldObey) {
  const std::string kept = "a\tb\n\xc3\xa4 \xe2\x82\xac \xf0\x9f\x98\x80 \\x1b";
  EXPECT_EQ(printable(kept), kept);
  EXPECT_EQ(printable(std::string("\0\r\x1b[2J\x7f", 7)), "\\x00\\x0d\\x1b[2J\\x7f");
  EXPECT_EQ(printable("\xc2\x80\xc2\x9b\xc2\x9f\xc2\xa0"), "\\x80\\x9b\\x9f\xc2\xa0");
  EXPECT_EQ(printable("\xe2\x80\xae\xe2\x81\xa6\xd8\x9c\xe2\x80\xa8"), "\\u202e\\u2066\\u061c\\u2028");
}

TEST(Printable, ShowsEachByteThatIsNoTextWhereverItStands) {
  EXPECT_EQ(printable("\x9b"), "\\x9b");
  EXPECT_EQ(printable("a\xff"), "a\\xff");
  EXPECT_EQ(printable("\xc3"), "\\xc3") << "cut off";
  EXPECT_EQ(printable("\xc0\x9b"), "\\xc0\\x9b") << "too long a form";
  EXPECT_EQ(printable("\xe0\x80\x9b"), "\\xe0\\x80\\x9b");
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half a surrogate pair";
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond Unicode";
  EXPECT_EQ(printable("\xe2\x82z"), "\\xe2\\x82z");
}

}  // namespace
}  // namespace palpate::test
