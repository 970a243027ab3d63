// SPDX-License-Identifier: MIT
#include "system/shell.hpp"

#include "record/json.hpp"

#include <algorithm>
#include <iterator>
#include <memory>
#include <set>
#include <sstream>

namespace palpate::test {

Words::Words(const std::string& text) {
  std::istringstream in(text);
  assign(std::istream_iterator<std::string>(in), {});
}

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

Words set_by(const Words& words, const Words& more) {
  const auto key = [](const std::string& word) { return word.substr(0, word.find('=')); };
  Words out;
  for (const std::string& word : words) {
    const auto same = [&](const std::string& other) {
      return word.find('=') != std::string::npos && key(other) == key(word);
    };
    if (std::none_of(more.begin(), more.end(), same)) out.push_back(word);
  }
  return out + more;
}

namespace {

/// What is named like a run or a sweep below `folder`: RUNS/NAME/ID.
std::set<fs::path> directories_in(const fs::path& folder) {
  std::set<fs::path> out;
  for (fs::recursive_directory_iterator at(folder), end; at != end; ++at) {
    if (at.depth() == 2) at.disable_recursion_pending();
    if (at.depth() == 2 && fs::exists(at->path() / "config.yaml")) out.insert(at->path());
  }
  return out;
}

/// The one directory that is there now and was not before.
fs::path made_since(const std::set<fs::path>& before, const fs::path& folder) {
  std::set<fs::path> made = directories_in(folder);
  for (const fs::path& old : before) made.erase(old);
  EXPECT_EQ(made.size(), 1U);
  return made.empty() ? fs::path() : *made.begin();
}

}  // namespace

void Shell::replace(const fs::path& file, const std::string& part, const std::string& text) const {
  std::string all = text_of(file);
  const auto at = all.find(part);
  ASSERT_NE(at, std::string::npos) << part;
  write(file, all.replace(at, part.size(), text));
}

std::unique_ptr<Child> Shell::begin(const Words& words) const {
  return std::make_unique<Child>(Words{program_file()} + words, here(), environment_);
}

fs::path Shell::ran(const Words& more, const std::string& file) const {
  const std::set<fs::path> before = directories_in(here());
  const Ended ended = run(Words{"--quiet"} + more, file);
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_EQ(ended.out + ended.err, "");
  return made_since(before, here());
}

fs::path Shell::swept(const Words& more, const std::string& file, int status) const {
  const std::set<fs::path> before = directories_in(here());
  const Ended ended = sweep(Words{"--quiet"} + more, file);
  EXPECT_EQ(ended.status, status) << ended.err;
  return made_since(before, here());
}

std::string Shell::refused(const Words& words, int status) const {
  const Ended ended = palpate(words);
  EXPECT_EQ(ended.status, status) << ended.err;
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(lines(ended.err), 1) << ended.err;
  return ended.err;
}

void Shell::break_off(const fs::path& run) const {
  fs::remove(run / "summary.json");
  cut_taps(run);
}

void cut_taps(const fs::path& run) {
  const fs::path file = run / "record.jsonl";
  const std::string text = text_of(file);
  const std::size_t last = text.rfind("\n{\"tap\": ");
  fs::resize_file(file, (text.find("{\"tap\": ") + text.find('\n', last + 1) + 1) / 2);
}

void Shell::make_of_another_build(const fs::path& run) const {
  const fs::path file = run / "record.jsonl";
  std::string record = text_of(file);
  char& first = record[record.find("\"build\": \"") + 10];
  first = first == '0' ? '1' : '0';
  write(file, record);
}

std::vector<Row> json_rows(const fs::path& file) {
  std::vector<Row> rows;
  read_json_lines(file, [&](Row row) { rows.push_back(std::move(row)); });
  return rows;
}

fs::path job_of(const fs::path& sweep, int index) {
  const std::vector<Row> rows = json_rows(sweep / "manifest.jsonl");
  return sweep / "jobs" / std::get<std::string>(*rows.at(static_cast<std::size_t>(index)).find("id"));
}

std::vector<fs::path> jobs_of(const fs::path& sweep) {
  return {fs::directory_iterator(sweep / "jobs"), fs::directory_iterator()};
}

std::vector<std::string> outcomes(const fs::path& run) {
  std::vector<std::string> out;
  for (const Cells& row : csv_rows(text_of(run / "taps.csv"))) out.push_back(row.at("outcome"));
  return out;
}

}  // namespace palpate::test
