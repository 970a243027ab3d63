// SPDX-License-Identifier: MIT
#include "reading/npy.hpp"
#include "reading/ply.hpp"
#include "reading/read_file.hpp"

#include "support/testing.hpp"

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <sys/stat.h>

namespace palpate::test {
namespace {

class AReading : public InFolder {
 protected:
  using Kind = FileReading::Kind;

  static Kind kind(const fs::path& file, FileOrigin origin = FileOrigin::record, std::uintmax_t most = 1000) {
    return read_bounded(file, most, origin).kind;
  }
};

TEST_F(AReading, HasEveryByteOfAFileUpToItsLimitAndNothingOfALargerOne) {
  const std::string text("a\0\r\n\xff", 5);
  const fs::path file = folder_.write("x", text);
  EXPECT_EQ(read_bounded(file, 5, FileOrigin::record).text, text);
  const FileReading large = read_bounded(file, 4, FileOrigin::record);
  EXPECT_EQ(large.kind, Kind::too_large);
  EXPECT_EQ(large.text, "");
  EXPECT_EQ(read_bounded(folder_.write("empty", ""), 0, FileOrigin::record).kind, Kind::whole);
}

TEST_F(AReading, OfOneEndOfAFileHasItsBytesAndTellsWhereTheyBegin) {
  const std::string text = "0123456789";
  const fs::path file = folder_.write("x", text);
  for (const std::size_t bytes : {0U, 1U, 9U, 10U, 11U, 100000U}) {
    const std::size_t there = std::min<std::size_t>(bytes, text.size());
    const FileReading first = read_begin_bounded(file, bytes, FileOrigin::record);
    const FileReading last = read_end_bounded(file, bytes, FileOrigin::record);
    EXPECT_EQ(first.text, text.substr(0, there)) << bytes;
    EXPECT_EQ(first.begin, 0U);
    EXPECT_EQ(last.text, text.substr(text.size() - there)) << bytes;
    EXPECT_EQ(last.begin, text.size() - there);
  }
  EXPECT_EQ(read_end_bounded(folder_.write("empty", ""), 5, FileOrigin::record).text, "");
}

TEST_F(AReading, CountsTheBytesOfAFileThatSaysThatItHasNone) {
  EXPECT_GT(read_bounded("/proc/self/status", 100'000, FileOrigin::user).text.size(), 100U);
  EXPECT_EQ(kind("/proc/self/status", FileOrigin::user, 100), Kind::too_large);
}

TEST_F(AReading, ReturnsAtOnceWhatIsNoFile) {
  const fs::path pipe = folder_.path() / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const FileOrigin origin : {FileOrigin::user, FileOrigin::record}) {
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
  EXPECT_EQ(kind(folder_.path() / "link", FileOrigin::user), Kind::whole);
  EXPECT_EQ(kind(folder_.path() / "link"), Kind::link);
  EXPECT_EQ(kind(folder_.path() / "zero", FileOrigin::user), Kind::not_regular);
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
  EXPECT_EQ(words_of(read_bounded(folder_.write("x", "12345"), 4, FileOrigin::record), 4).reason,
            "is too large for its purpose: at most 4 bytes are read");
  EXPECT_EQ(words_of({Kind::too_large, {}}, 512 << 20).reason,
            "is too large for its purpose: at most 512 MiB are read");
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

TEST(NpyHeader, SaysWhatFollowsInWhateverOrderAndQuotes) {
  // As numpy.lib.format writes it, but for the second.
  const NpyHeader usual = read_npy_header("{'descr': '<f8', 'fortran_order': False, 'shape': (3, 4), }       \n");
  EXPECT_EQ(usual.type, "<f8");
  EXPECT_EQ(usual.order, "False");
  EXPECT_EQ(usual.shape, "(3,4)");
  EXPECT_EQ(usual.sizes, (std::vector<std::uint64_t>{3, 4}));
  const NpyHeader other = read_npy_header("{\"shape\":(7,),\"fortran_order\":True,\"descr\":\"|u1\"}");
  EXPECT_EQ(other.type, "|u1");
  EXPECT_EQ(other.order, "True");
  EXPECT_EQ(other.sizes, std::vector<std::uint64_t>{7});
  // The names of a record's fields are no keys.
  const NpyHeader record = read_npy_header(
      "{'descr': [('shape', '<f8'), ('descr', '|b1', (2, 2))], 'fortran_order': False, 'shape': (5,), }");
  EXPECT_EQ(record.type, "[('shape','<f8'),('descr','|b1',(2,2))]");
  EXPECT_EQ(record.sizes, std::vector<std::uint64_t>{5});
}

TEST(NpyHeader, LeavesEmptyWhatIsNotInTheWordsOfTheFormat) {
  EXPECT_THAT(read_npy_header("{'shape': (), }").sizes, testing::IsEmpty()) << "a single number";
  for (const char* shape : {"(3, 1234567890)", "(-3,)", "(3, 4", "3", "(a,)", "(,)", "((3,), 4)"})
    EXPECT_THAT(read_npy_header(std::string("{'shape': ") + shape + "}").sizes, testing::IsEmpty()) << shape;
  for (const char* text : {"", "{", "'descr': '<f8'", "[{'descr': '<f8'}]", "{'descr", "{descr: '<f8'}"})
    EXPECT_EQ(read_npy_header(text).type, "") << text;
}

TEST(NpyHeader, LiesWhereItsVersionSays) {
  const auto place = [](const std::string& bytes) {
    const auto found = npy_header_place(bytes);
    return found ? std::pair(found->begin, found->length) : std::pair<std::size_t, std::size_t>();
  };
  const std::string magic = "\x93NUMPY";
  const auto bytes = [](std::initializer_list<int> all) { return std::string(all.begin(), all.end()); };
  EXPECT_EQ(place(magic + bytes({1, 0, 0x76, 0x01})), (std::pair<std::size_t, std::size_t>(10, 0x176)));
  EXPECT_EQ(place(magic + bytes({2, 0, 1, 2, 3, 4})), (std::pair<std::size_t, std::size_t>(12, 0x04030201)));
  EXPECT_EQ(place(magic + bytes({3, 0, 0xff, 0, 0, 0xff})), (std::pair<std::size_t, std::size_t>(12, 0xff0000ff)));
  for (const std::string& none :
       {std::string(), magic, magic + bytes({1, 0, 7}), magic + bytes({2, 0, 1, 2, 3}), magic + bytes({0, 0, 7, 0}),
        magic + bytes({4, 0, 7, 0, 0, 0}), "NUMPY\x93" + bytes({1, 0, 7, 0})})
    EXPECT_FALSE(npy_header_place(none)) << printable(none);
}

TEST(PlyScalar, IsTheSameByEitherOfItsNames) {
  const char bytes[8] = {'\x01', '\x80', 0, '\xc0', 0, 0, '\xf0', '\x3f'};
  const auto value = [&](const char* name) { return ply_scalar(name)->read(bytes); };
  for (const auto& [one, other, size, wanted] :
       {std::tuple("char", "int8", 1U, 1.0), std::tuple("short", "int16", 2U, -32767.0),
        std::tuple("ushort", "uint16", 2U, 32769.0), std::tuple("int", "int32", 4U, -1073709055.0),
        std::tuple("uint", "uint32", 4U, 3221258241.0), std::tuple("float", "float32", 4U, -2.0078127)}) {
    EXPECT_EQ(ply_scalar(one), ply_scalar(other)) << one;
    EXPECT_EQ(ply_scalar(one)->size, size) << one;
    EXPECT_NEAR(value(one), wanted, 1e-7) << one;
  }
  EXPECT_EQ(ply_scalar("double")->size, 8U);
  EXPECT_EQ(ply_scalar("uchar"), ply_scalar("uint8"));
  EXPECT_EQ(ply_scalar("list"), nullptr);
}

}  // namespace
}  // namespace palpate::test
