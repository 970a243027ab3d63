// SPDX-License-Identifier: MIT
#include "record/row.hpp"

#include "record/json.hpp"
#include "support/testing.hpp"

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <cstring>
#include <random>

namespace palpate::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Cell, HoldsEveryKindOfScalar) {
  EXPECT_EQ(csv_cell(std::monostate{}), "");
  EXPECT_EQ(csv_cell(true), "true");
  EXPECT_EQ(csv_cell(false), "false");
  EXPECT_EQ(csv_cell(std::int64_t{-9007199254740993}), "-9007199254740993");
  EXPECT_EQ(csv_cell(0.1), "0.1");
  EXPECT_EQ(csv_cell(std::string("a b")), "a b");
}

TEST(Cell, IsEmptyForWhatIsNotFinite) {
  EXPECT_EQ(csv_cell(kNaN), "");
  EXPECT_EQ(csv_cell(kInfinity), "");
  EXPECT_EQ(csv_cell(-kInfinity), "");
}

TEST(Cell, ReadsBackAsTheSameBits) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t pattern = random();
    double value = 0.0;
    std::memcpy(&value, &pattern, sizeof value);
    if (!std::isfinite(value)) continue;
    ASSERT_EQ(std::strtod(csv_cell(value).c_str(), nullptr), value) << csv_cell(value);
  }
  EXPECT_TRUE(std::signbit(std::strtod(csv_cell(-0.0).c_str(), nullptr)));
}

TEST(CsvText, IsQuotedOnlyWhereItMustBe) {
  EXPECT_EQ(csv_text("plain text"), "plain text");
  EXPECT_EQ(csv_text("a,b"), "\"a,b\"");
  EXPECT_EQ(csv_text("say \"x\""), "\"say \"\"x\"\"\"");
  EXPECT_EQ(csv_text("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(csv_text("a\rb"), "\"a\rb\"");
}

TEST(Csv, HoldsNothingThatASpreadsheetWouldCompute) {
  const auto cell = [](const std::string& text) {
    const std::string csv = to_csv({Row{{{"a", text}}}});
    return csv.substr(2, csv.size() - 3);
  };
  EXPECT_EQ(cell("=1+1"), "'=1+1");
  EXPECT_EQ(cell("@SUM(A1)"), "'@SUM(A1)");
  EXPECT_EQ(cell("+1+1"), "'+1+1");
  EXPECT_EQ(cell("-1 cm"), "'-1 cm");
  EXPECT_EQ(cell(" =1"), "' =1");
  EXPECT_EQ(cell("=cmd|'/c calc',A1"), "\"'=cmd|'/c calc',A1\"");
  EXPECT_EQ(cell("'=1"), "''=1") << "taking one away gives back the text, whatever it was";
  for (const char* plain : {"-1.5", "+2e-3", "-.5", "1-1", "'quoted'", "", "'", "-0"}) EXPECT_EQ(cell(plain), plain);
  for (const char* computed : {"-inf", "+nan", "-0x10", "--1", "-1-1", "+", "-"})
    EXPECT_EQ(cell(computed), "'" + std::string(computed));
  EXPECT_EQ(to_csv({Row{{{"=note", 1}}}}), "'=note\n1\n");
  EXPECT_EQ(csv_cell(std::string("-1 cm")), "-1 cm") << "what is shown to people stays as it is";
}

TEST(JsonText, EscapesControlsAndReplacesWhatIsNotUtf8) {
  const auto quoted = [](const std::string& text) { return to_json_line(Tree::quote(text)); };
  EXPECT_EQ(quoted("a\"b\\c\nd\te\x01"
                   "f\x1f"),
            R"("a\"b\\c\nd\te\u0001f\u001f")");
  EXPECT_EQ(quoted("\xc3\xa4 \xf0\x9f\x98\x80"), "\"\xc3\xa4 \xf0\x9f\x98\x80\"");
  for (const char* text : {"a\xff", "\xc3", "\x80", "\xc3\"", "\xed\xa0\x80"}) {
    EXPECT_THAT(quoted(text), testing::HasSubstr("\xef\xbf\xbd"));
    EXPECT_TRUE(nlohmann::json::accept(quoted(text))) << text;
  }
}

TEST(Row, BecomesOneLineOfJson) {
  Row row;
  row.add("tap", 3);
  row.add("source", "initial");
  row.add("score", std::optional<double>());
  row.add("height", 0.25);
  row.add("bad", kNaN);
  row.add("hit", true);
  EXPECT_EQ(to_json_line(row),
            R"({"tap": 3, "source": "initial", "score": null, "height": 0.25, "bad": null, "hit": true})");
}

TEST(Row, NestsByTheDotsOfItsNames) {
  Row row;
  row.fields = {{"a.b.c", 1}, {"a.b.d", 2}, {"a.e", 3}, {"f", 4}};
  EXPECT_EQ(to_json_line(row), R"({"a": {"b": {"c": 1, "d": 2}, "e": 3}, "f": 4})");
  EXPECT_EQ(
      to_json(row),
      "{\n  \"a\": {\n    \"b\": {\n      \"c\": 1,\n      \"d\": 2\n    },\n    \"e\": 3\n  },\n  \"f\": 4\n}\n");
}

TEST(Row, NestsNumbersOfAListAndNothingThatOnlyBeginsAlike) {
  EXPECT_EQ(to_json_line(Row{{{"a.b", 1}, {"ab", 2}}}), R"({"a": {"b": 1}, "ab": 2})");
  const Row list{{{"kernels.0.factor", 1}, {"kernels.0.kernel.length_scale", 2}, {"kernels.1.alpha", 3}}};
  EXPECT_EQ(to_json_line(list),
            R"({"kernels": {"0": {"factor": 1, "kernel": {"length_scale": 2}}, "1": {"alpha": 3}}})");
}

TEST(Row, FindsAFieldByItsName) {
  const Row row{{{"a", 1}, {"b.c", "x"}}};
  ASSERT_NE(row.find("b.c"), nullptr);
  EXPECT_EQ(*row.find("b.c"), Scalar{std::string("x")});
  EXPECT_EQ(row.find("b"), nullptr);
}

TEST(Csv, HasAHeaderAndARowEach) {
  EXPECT_EQ(to_csv({Row{{{"id", "x,y"}, {"n", 1}}}, Row{{{"id", "z"}, {"n", 2.5}}}}), "id,n\n\"x,y\",1\nz,2.5\n");
  EXPECT_EQ(to_csv({}), "");
}

TEST(Csv, LeavesCellsEmptyThatARowLacks) {
  const Row whole{{{"a", 1}, {"b", 2}, {"c", 3}}};
  const Row part{{{"a", 4}, {"c", 5}}};
  const Row swapped{{{"c", 6}, {"a", 7}}};
  EXPECT_EQ(to_csv({part, whole, swapped}), "a,b,c\n4,,5\n1,2,3\n7,,6\n");
}

TEST(Csv, HasTheNamesOfAllRowsEachOnceAndBehindTheOneThatItFollows) {
  const Row start{{{"tap", 1}, {"signal", 1.5}, {"rmse", 2}}};
  const Row fitted{{{"tap", 2},
                    {"kernel.length_scale", 0.5},
                    {"signal", 2.5},
                    {"fit.changed", true},
                    {"fit.reason", "converged, almost"},
                    {"rmse", 1}}};
  const Row unfitted{{{"tap", 3}, {"kernel.length_scale", 0.25}, {"signal", 2.5}, {"rmse", 1}, {"last", {}}}};
  EXPECT_EQ(to_csv({start, fitted, unfitted}),
            "tap,kernel.length_scale,signal,fit.changed,fit.reason,rmse,last\n"
            "1,,1.5,,,2,\n"
            "2,0.5,2.5,true,\"converged, almost\",1,\n"
            "3,0.25,2.5,,,1,\n");
  EXPECT_EQ(to_csv({Row{{{"a", 1}, {"b", 2}}}, Row{{{"b", 3}, {"new", 4}, {"a", 5}}}}), "a,b,new\n1,2,\n5,3,4\n");
}

TEST(Csv, OfRowsThatHaveNoNameInCommonTakesTimeInProportionToTheirFields) {
  // By a look at each name for each field this takes a hundred times as long.
  constexpr int kFields = 30'000;
  std::vector<Row> rows(3);
  for (int i = 0; i < 3 * kFields; ++i) rows[i / kFields].add("name " + std::to_string(i), std::int64_t{i});
  const std::vector<std::string> names = names_of(rows);
  ASSERT_EQ(names.size(), 3U * kFields);
  EXPECT_EQ(names.front(), "name " + std::to_string(2 * kFields)) << "a name that follows none comes first";
  const std::string text = to_csv(rows);
  const std::size_t second = text.find('\n') + 1;
  EXPECT_EQ(text.compare(second + 2 * kFields, 4, "0,1,"), 0) << "of the first row, behind those of the others";
}

TEST(Csv, ReadsBackWhateverItsCellsHold) {
  const std::vector<std::string> texts = {"x,y", "say \"x\", twice", "two\nlines", "\"", "plain", ""};
  std::vector<Row> rows;
  for (const std::string& text : texts) rows.push_back({{{"text", text}, {"n", 7}}});
  const std::vector<test::Cells> read = test::csv_rows(to_csv(rows));
  ASSERT_EQ(read.size(), texts.size());
  for (std::size_t i = 0; i < texts.size(); ++i) EXPECT_EQ(read[i], (test::Cells{{"text", texts[i]}, {"n", "7"}}));
}

}  // namespace
}  // namespace palpate::test
