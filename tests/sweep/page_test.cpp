// SPDX-License-Identifier: MIT
// The parts of a page: packed data can be unpacked by an independent reader, and text stays data.
#include "report/page/page.hpp"
#include "report/page/run_page.hpp"
#include "support/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace palpate {
namespace {

using test::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::Not;

TEST(Base64, HasTheVectorsOfItsStandard) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("fooba"), "Zm9vYmE=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xFF\xFE\x00", 3)), "//4A");
}

TEST(Deflated, IsUnpackedByPythonAndTheSameEveryTime) {
  const TemporaryFolder folder;
  std::string bytes;
  std::mt19937 random(1);
  for (int i = 0; i < 100'000; ++i) bytes += static_cast<char>(random() % 7 == 0 ? random() & 0xFFU : 'a');
  for (const std::string& one : {std::string(), std::string("x"), bytes}) {
    EXPECT_EQ(deflated(one), deflated(one));
    folder.write("packed", deflated(one));
    const std::string unpack = "import zlib; open(1, 'wb').write(zlib.decompress(open('packed', 'rb').read()))";
    const test::Ended ended = test::run_program({"python3", "-c", unpack}, folder.path());
    EXPECT_EQ(ended.status, 0);
    EXPECT_TRUE(ended.out == one);
  }
}

/// Unpacks a frame as web/run.js does.
std::vector<double> unpack_frame(const std::string& bytes, std::size_t at, std::size_t cells, double least,
                                 double most) {
  std::vector<double> out;
  unsigned level = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    const auto low = static_cast<unsigned char>(bytes[at + i]);
    const auto high = static_cast<unsigned char>(bytes[at + cells + i]);
    level = (level + low + 256U * high) & 0xFFFFU;
    out.push_back(least + level / 65535.0 * (most - least));
  }
  return out;
}

TEST(PackedMaps, AreOffByAtMostHalfAStepOfTheirRange) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> any(-3.0F, 5.0F);
  std::vector<Eigen::VectorXf> frames;
  for (int frame = 0; frame < 4; ++frame)
    frames.emplace_back(Eigen::VectorXf::NullaryExpr(35, [&](Eigen::Index) { return any(random); }));
  const PackedMaps packed = pack_maps(frames);
  EXPECT_EQ(packed.bytes.size(), 4U * 35U * 2U);
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const std::vector<double> out = unpack_frame(packed.bytes, 70 * f, 35, packed.least, packed.most);
    for (std::size_t i = 0; i < out.size(); ++i)
      EXPECT_LE(std::abs(out[i] - static_cast<double>(frames[f](static_cast<Eigen::Index>(i)))),
                (packed.most - packed.least) / 131070.0 * 1.0001);
  }
}

TEST(PackedMaps, KeepAMapThatIsEverywhereTheSame) {
  const PackedMaps packed = pack_maps({Eigen::VectorXf::Constant(9, 0.25F)});
  EXPECT_EQ(packed.least, 0.25);
  EXPECT_EQ(packed.most, 0.25);
  for (const double value : unpack_frame(packed.bytes, 0, 9, 0.25, 0.25)) EXPECT_EQ(value, 0.25);
}

TEST(PageData, HasRowsWithTheirDottedNamesAndNullForWhatIsAbsentOrNoNumber) {
  Row row;
  row.add("a.b", 1);
  row.add("none", std::optional<double>());
  row.add("text", "\"</script>");
  EXPECT_EQ(Json(std::vector<Row>{row}).dump(), R"([{"a.b":1,"none":null,"text":"\"</script>"}])");
  EXPECT_EQ(Json(std::vector<std::optional<double>>{0.5, {}, std::nan("")}).dump(), "[0.5,null,null]");
}

TEST(Page, AsksNoNetworkForAnythingAndHasNoDataAsMarkup) {
  const std::string page = make_page("draw();", {{"name", "<b>secret</b>"}, {"bytes", "no UTF-8: \xFF"}}, "maps");
  EXPECT_THAT(page, HasSubstr("content=\"default-src 'none';"));
  const std::string head = page.substr(0, page.find("<script"));
  const std::string tail = page.substr(page.rfind("<script>"));
  EXPECT_THAT(head, Not(HasSubstr("http:")));
  EXPECT_THAT(tail, Not(HasSubstr("src=")));
  EXPECT_TRUE(page.find("secret") == std::string::npos);
  EXPECT_THAT(tail, HasSubstr("draw();</script>"));
}

}  // namespace
}  // namespace palpate
