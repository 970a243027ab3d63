// SPDX-License-Identifier: MIT
#include "support/parts.hpp"

#include "record/json.hpp"
#include "support/support.hpp"

#include <fstream>
#include <sstream>

namespace palpate::test {

namespace fs = std::filesystem;

std::string part_of(const fs::path& run, const std::string& name) {
  if (fs::exists(run / name)) return text_of(run / name);
  if (!fs::exists(run / "record.jsonl")) return "";
  std::istringstream in(text_of(run / "record.jsonl"));
  std::string out;
  std::vector<Row> objects;
  for (std::string line; std::getline(in, line) && !in.eof();) {
    const std::string kind = line.substr(2, line.find('"', 2) - 2);
    if (kind == "attempt" && name == "attempts.jsonl") out += line + "\n";
    if (kind == "manifest" && name == "manifest.json") {
      const std::string value = line.substr(std::string("{\"manifest\": ").size());
      out = value.substr(0, value.size() - 1) + "\n";
    }
    if (kind == "object" && name == "objects.csv") {
      Row row = parse_json_row(line).value();
      if (row.number("object") == 0.0) objects.clear();
      objects.push_back(std::move(row));
      out = to_csv(objects);
    }
    if (kind != "tap") continue;
    const std::size_t begin = line.find(", \"seconds\": {");
    const std::size_t end = begin == std::string::npos ? begin : line.find('}', begin);
    if (name == "taps.jsonl") out += (begin == end ? line : line.substr(0, begin) + line.substr(end + 1)) + "\n";
    if (name != "timings.csv" || begin == end) continue;
    if (out.empty()) out = "tap,robot,fit,infer,acquire,log\n";
    const Row row = parse_json_row(line).value();
    out += row.cell("tap");
    for (const char* phase : {"robot", "fit", "infer", "acquire", "log"})
      out += "," + row.cell(std::string("seconds.") + phase);
    out += "\n";
  }
  return out;
}

std::vector<Row> rows_of(const fs::path& run, const std::string& name) {
  std::vector<Row> out;
  std::istringstream in(part_of(run, name));
  for (std::string line; std::getline(in, line);) out.push_back(parse_json_row(line).value());
  return out;
}

void unpack(const fs::path& job) {
  for (const char* name : {"taps.jsonl", "attempts.jsonl", "manifest.json", "timings.csv", "objects.csv"}) {
    if (const std::string text = part_of(job, name); !text.empty()) std::ofstream(job / name) << text;
  }
  std::ofstream(job / "lock") << "";
  fs::remove(job / "record.jsonl");
}

}  // namespace palpate::test
