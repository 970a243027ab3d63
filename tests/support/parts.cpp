// SPDX-License-Identifier: MIT
#include "support/parts.hpp"

#include "record/json.hpp"
#include "support/support.hpp"

#include <fmt/format.h>

#include <fstream>
#include <sstream>

namespace palpate::test {

namespace fs = std::filesystem;

namespace {

/// Calls `use` with kind and text of each whole line.
template <class Use>
void for_lines(const std::string& record, const Use& use) {
  std::istringstream in(record);
  for (std::string line; std::getline(in, line) && !in.eof();)
    use(line.size() < 2 ? "" : line.substr(2, line.find('"', 2) - 2), line + "\n");
}

std::string record_of(const fs::path& run) {
  return fs::exists(run / "record.jsonl") ? text_of(run / "record.jsonl") : "";
}

}  // namespace

std::string part_of(const fs::path& run, const std::string& kind) {
  std::string out;
  for_lines(record_of(run), [&](const std::string& one, const std::string& line) { out += one == kind ? line : ""; });
  return out;
}

std::vector<Row> rows_of(const fs::path& run, const std::string& kind) {
  std::vector<Row> out;
  for_lines(part_of(run, kind),
            [&](const std::string&, const std::string& line) { out.push_back(parse_json_row(line).value()); });
  return out;
}

std::string lasting_part_of(const fs::path& run) {
  std::string out;
  std::string objects;  // the last ones hold
  for_lines(record_of(run), [&](const std::string& one, const std::string& line) {
    if (one == "intent" || one == "tap") out += line;
    if (one == "objects") objects = line;
  });
  return out + objects;
}

std::string record_until(const std::string& record, int taps) {
  std::string out;
  int made = 0;
  for_lines(record, [&](const std::string& kind, const std::string& line) {
    made += kind == "tap" ? 1 : 0;
    if (made > taps || (made == taps && kind != "tap" && kind != "timing" && made > 0)) return;
    if (kind != "end" && kind != "objects") out += line;
  });
  return out;
}

void forget_end(const fs::path& run) {
  std::string out;
  for_lines(record_of(run),
            [&](const std::string& kind, const std::string& line) { out += kind == "end" ? "" : line; });
  std::ofstream(run / "record.jsonl") << out;
  fs::remove(run / "summary.json");
}

void set_end(const fs::path& run, const std::string& summary) {
  if (part_of(run, "manifest").empty()) std::ofstream(run / "record.jsonl") << "{\"manifest\": 1}\n";
  forget_end(run);
  const Row row = parse_json_row(summary).value();
  Row end;
  end.add("end", row.text("status"));
  end.add("reason", row.text("stop_reason"));
  std::string line = to_json_line(end);
  line.pop_back();
  std::ofstream(run / "record.jsonl", std::ios::app) << line << ", \"summary\": " << to_json_line(row) << "}\n";
  std::ofstream(run / "summary.json") << to_json(row);
}

void write_part(const fs::path& run, const std::string& kind, const std::string& text) {
  std::string out;
  std::istringstream others(text);
  for_lines(record_of(run), [&](const std::string& one, const std::string& line) {
    std::string other;
    if (one != kind) {
      out += line;
    } else if (std::getline(others, other)) {
      out += other + "\n";
    }
  });
  std::ofstream(run / "record.jsonl") << out;
}

std::string begun_record(bool announces) {
  return fmt::format(
      "{{\"manifest\": 1}}\n{{\"attempt\": 1, \"after_tap\": 0}}\n"
      "{{\"setup\": 1, \"announces\": {}, \"models\": {{}}}}\n",
      announces);
}

}  // namespace palpate::test
