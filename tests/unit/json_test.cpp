// SPDX-License-Identifier: MIT
#include "record/json.hpp"

#include "config/yaml.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

TEST(JsonRow, JoinsNestedNamesByDotsAndKeepsTheOrderOfItsFields) {
  const auto row = parse_json_row(R"({"d": "x", "a": {"b": {"c": 1}}, "g": 0.5, "e": null, "f": true})");
  ASSERT_TRUE(row);
  EXPECT_EQ(row->fields, (Row{{{"d", "x"}, {"a.b.c", 1}, {"g", 0.5}, {"e", {}}, {"f", true}}}).fields);
}

TEST(JsonRow, IsNoneForWhatIsNotOneFlatObject) {
  for (const char* text : {"", "[1]", "1", "{\"a\": 1", "{\"a\": [1}", "{\"a\": [1]", "{\"a\": NaN}",
                           "{\"a\": 1} {\"b\": 2}", "{'a': 1}", "{\"a\": \"\xff\"}"}) {
    EXPECT_FALSE(parse_json_row(text)) << text;
  }
}

TEST(JsonRow, HasListsAsTheirText) {
  for (const char* list : {"[]", "[1, -2, 0.5]", R"([{"tap": 8, "probability": 0.93}, {"tap": 12, "probability": 1}])",
                           R"([null, true, "a, [b]", [[]], {}])"}) {
    const std::string text = std::string(R"({"a": {"b": )") + list + "}, \"c\": 1}";
    const auto row = parse_json_row(text);
    ASSERT_TRUE(row) << text;
    EXPECT_EQ(row->fields, (Row{{{"a.b", JsonList{list}}, {"c", 1}}}).fields);
    EXPECT_EQ(to_json_line(*row), text);
  }
  EXPECT_EQ(csv_cell(JsonList{"[1, 2]"}), "\"[1, 2]\"");
  EXPECT_FALSE(parse_json_row(R"({"a": )" + std::string(200, '[') + std::string(200, ']') + "}"));
}

TEST(JsonRow, ListsOfObjectsAreRows) {
  const std::vector<Row> rows = rows_of({R"([{"tap": 8, "probability": 0.93}, {"tap": 12, "probability": 1}])"});
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].number("tap"), 8.0);
  EXPECT_EQ(rows[1].number("probability"), 1.0);
  EXPECT_TRUE(rows_of({"[]"}).empty());
}

TEST(JsonRow, IsNoneWhereEveryNameRepeatsWhatIsAroundIt) {
  // 240 KB would become fields with 400 MB of names.
  std::string deep;
  std::string ends;
  for (int i = 0; i < 20'000; ++i) {
    deep += R"({"a":1,"b":)";
    ends += '}';
  }
  EXPECT_FALSE(parse_json_row(deep + "1" + ends));
}

TEST(JsonRow, ReadsBackWhatARowWrites) {
  Row row;
  row.add("a.b", 0.1);
  row.add("a.b2", -0.0);
  row.add("a.c", std::int64_t{9223372036854775807});
  row.add("name", "tab\t\"quote\" \\ \x01 \xc3\xa4");
  row.add("none", std::optional<int>());
  row.add("yes", true);
  for (const std::string& text : {to_json_line(row), to_json(row)}) {
    const auto again = parse_json_row(text);
    ASSERT_TRUE(again) << text;
    EXPECT_EQ(again->fields, row.fields);
    EXPECT_EQ(csv_cell(*again->find("a.b2")), csv_cell(-0.0)) << "a replay compares texts";
  }
}

TEST(JsonRow, TakesAWholeNumberBeyond63BitsForTheSameRealNumber) {
  for (const char* text : {"12345678901234567168", "-12345678901234567168", "9223372036854775808"}) {
    const auto row = parse_json_row(std::string("{\"a\": ") + text + "}");
    ASSERT_TRUE(row);
    EXPECT_EQ(row->fields, (Row{{{"a", std::stod(text)}}}).fields) << text;
    EXPECT_EQ(parse_json_row(to_json_line(*row))->fields, row->fields) << text;
  }
}

using JsonLinesFile = InFolder;

struct JsonLines {
  std::vector<Row> rows;
  std::uintmax_t bytes = 0;
};
JsonLines lines_of_file(const std::filesystem::path& file) {
  JsonLines out;
  out.bytes = read_json_lines(file, [&](Row row) { out.rows.push_back(std::move(row)); });
  return out;
}

TEST_F(JsonLinesFile, IsReadWithItsLengthAndOfAnEmptyOneNothing) {
  const JsonLines lines = lines_of_file(folder_.write("taps.jsonl", "{\"tap\": 1}\n{\"tap\": 2}\n"));
  ASSERT_EQ(lines.rows.size(), 2U);
  EXPECT_EQ(*lines.rows[1].find("tap"), Scalar{std::int64_t{2}});
  EXPECT_EQ(lines.bytes, 22U);
  const JsonLines none = lines_of_file(folder_.write("taps.jsonl", ""));
  EXPECT_TRUE(none.rows.empty());
  EXPECT_EQ(none.bytes, 0U);
}

TEST_F(JsonLinesFile, LeavesOutALastLineThatWasCutOff) {
  for (const char* tail : {"{\"ta", "{\"tap\": 2}"}) {
    const JsonLines lines = lines_of_file(folder_.write("taps.jsonl", std::string("{\"tap\": 1}\n") + tail));
    EXPECT_EQ(lines.rows.size(), 1U) << tail;
    EXPECT_EQ(lines.bytes, 11U) << tail;
  }
}

TEST_F(JsonLinesFile, RefusesADamagedLineInTheMiddleAndAMissingFile) {
  const auto file = folder_.write("taps.jsonl", "{\"tap\": 1}\n{\"ta\n{\"tap\": 3}\n");
  EXPECT_EQ(error_of([&] { lines_of_file(file); }), file.string() + ":2: is not a JSON object, the file is damaged");
  EXPECT_EQ(error_of([] { lines_of_file("/nonexistent/taps.jsonl"); }), "/nonexistent/taps.jsonl: cannot be read");
}

TEST_F(JsonLinesFile, RefusesALineThatIsTooLongTooDeepOrHoldsTooMuch) {
  const auto refusal = [&](const std::string& line) {
    const auto file = folder_.write("taps.jsonl", "{}\n" + line + "\n");
    return error_of([&] { lines_of_file(file); }).substr(file.string().size());
  };
  const auto nested = [](int levels) {
    std::string open, close;
    for (int i = 0; i < levels; ++i) open += "{\"a\":", close += "}";
    return open + "1" + close;
  };
  const auto fields = [](int count) {
    std::string out = "{";
    for (int i = 0; i < count; ++i) out += (i == 0 ? "\"" : ",\"") + std::to_string(i) + "\":0";
    return out + "}";
  };
  EXPECT_EQ(lines_of_file(folder_.write("sound", nested(100) + "\n" + fields(4096) + "\n")).rows.size(), 2U);
  EXPECT_EQ(refusal(nested(101)), ":2: is nested too deeply: at most 100 levels, the file is damaged");
  EXPECT_EQ(refusal(nested(150'000)), ":2: is nested too deeply: at most 100 levels, the file is damaged");
  EXPECT_EQ(refusal(fields(4097)), ":2: contains too many values: at most 4096, the file is damaged");
  EXPECT_EQ(refusal("{\"" + std::string(1025, 'a') + "\": 1}"),
            ":2: has a name of more than 1 KiB, the file is damaged");
  EXPECT_EQ(refusal("{\"a\": \"" + std::string(1 << 20, 'a') + "\"}"),
            ":2: is too long: a line has at most 1 MiB, the file is damaged");
}

TEST(JsonRows, OfOneFileHoldNoMoreNamesThanFitIntoMemory) {
  std::string line = "{\"" + std::string(1000, 'n') + "\":{\"\":1";
  for (int i = 1; i < 4000; ++i) line += ",\"\":1";
  JsonLinesReader lines("record.jsonl");
  std::size_t bytes = 0;
  const std::string words = error_of([&] {
    for (;;)
      for (const auto& field : lines.read(line + "}}").fields) bytes += field.first.size();
  });
  EXPECT_THAT(words, testing::HasSubstr("the file is too large"));
  EXPECT_LT(bytes, std::size_t{3} << 29);
}

TEST(JsonTree, KeepsPlainScalarsAndQuotesTheOthers) {
  const Tree tree = parse_yaml("a: 1\nb: '1'\nc: [true, 'x y']\nd: {}\ne: []\nf:\n", "c.yaml");
  EXPECT_EQ(to_json(tree),
            "{\n  \"a\": 1,\n  \"b\": \"1\",\n  \"c\": [\n    true,\n    \"x y\"\n  ],\n  \"d\": {},\n  \"e\": [],\n  "
            "\"f\": null\n}\n");
}

TEST(JsonTree, ComesBackFromItsFileAsItWas) {
  Tree tree = parse_yaml("a: [1, -2, 1.50, 1e-3, true, ~, {b: [[]]}, {}]\nc: []\n", "c.yaml");
  tree.at("text") = Tree::scalar("line\nbreak \"quoted\" \\ \x01 \xc3\xa4", true);
  for (int i = 0; i < 5000; ++i) tree.at("many").entries.push_back({"key " + std::to_string(i), {}, tree.at("text")});
  tree.at("many").kind = Tree::Kind::map;
  const TemporaryFolder folder;
  const Tree again = read_json(folder.write("manifest.json", to_json(tree)));
  EXPECT_EQ(again.canonical(), tree.canonical());
  EXPECT_EQ(to_json(again), to_json(tree));
}

std::string json_refusal(const std::string& text) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("manifest.json", text);
  return error_of([&] { read_json(file); }).substr(folder.path().string().size() + 1);
}

TEST(JsonTree, IsRefusedInOneLineWhereItsFileIsDamaged) {
  const std::string remedy = ", the file is damaged: put it back as it was, or remove it";
  EXPECT_EQ(json_refusal(""), "manifest.json:1:1: is not valid JSON" + remedy);
  EXPECT_EQ(json_refusal("{\n  \"a\": 1\n},"), "manifest.json:3:2: is not valid JSON" + remedy);
  EXPECT_EQ(json_refusal("{\"a\": \"\xff\"}"), "manifest.json:1:8: is not valid JSON" + remedy);
  for (const char* text : {"1", "\"a\"", "[]", "[{}]"})
    EXPECT_EQ(json_refusal(text), "manifest.json: is not a JSON object" + remedy) << text;
  std::string deep = "{\"a\": ";
  for (int i = 0; i < 100'000; ++i) deep += "[";
  EXPECT_EQ(json_refusal(deep), "manifest.json: is nested too deeply: at most 100 levels" + remedy);
  std::string many = "{\"a\": [0";
  for (int i = 0; i < 1'000'000; ++i) many += ",0";
  EXPECT_EQ(json_refusal(many + "]}"), "manifest.json: contains too many values" + remedy);
}

TEST(JsonTree, IsNotReadFromAFileLargerThanAnyThatIsWritten) {
  const TemporaryFolder folder;
  const auto file = folder.write("manifest.json", "{}");
  std::filesystem::resize_file(file, (64U << 20) + 1);
  EXPECT_THROW(read_json(file), Error);
}

}  // namespace
}  // namespace palpate::test
