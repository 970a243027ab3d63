// SPDX-License-Identifier: MIT
#include "support/tap_trace.hpp"

#include "support/support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <stdexcept>

namespace palpate::test {

namespace {

constexpr const char* kColumns = "time_s,height_m,force_n,sender";
const std::map<TapTrace::Verdict, std::string> kVerdicts = {{TapTrace::Verdict::contact, "contact"},
                                                            {TapTrace::Verdict::no_contact, "no_contact"},
                                                            {TapTrace::Verdict::fault, "fault"}};

TapTrace::Verdict verdict_of(const std::string& word) {
  for (const auto& [verdict, name] : kVerdicts) {
    if (name == word) return verdict;
  }
  throw std::runtime_error("there is no verdict '" + word + "'");
}

TapTrace::Row row_of(const std::string& line) {
  TapTrace::Row out{};
  int length = 0;
  const int read =
      std::sscanf(line.c_str(), "%lf,%lf,%lf,%d%n", &out.time, &out.height, &out.force, &out.sender, &length);
  const bool finite = std::isfinite(out.time) && std::isfinite(out.height) && std::isfinite(out.force);
  if (read != 4 || static_cast<std::size_t>(length) != line.size() || !finite || out.sender < 0) {
    throw std::runtime_error("'" + line + "' is no row");
  }
  return out;
}

TapTrace read(std::istream& in) {
  std::map<std::string, std::string> fields;
  std::string line;
  while (std::getline(in, line) && line.rfind("# ", 0) == 0) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) throw std::runtime_error("no field in '" + line + "'");
    fields[line.substr(2, colon - 2)] = line.substr(colon + 2);
  }
  if (line != kColumns) throw std::runtime_error("the columns are '" + line + "', not " + kColumns);
  const auto field = [&](const char* name) {
    const auto found = fields.find(name);
    if (found == fields.end()) throw std::runtime_error(std::string("there is no field ") + name);
    return found->second;
  };
  const auto number = [&](const char* name) { return std::stod(field(name)); };
  TapTrace out;
  out.what = field("what");
  out.motion = field("motion");
  out.verdict = verdict_of(field("verdict"));
  out.not_before = number("not_before_s");
  out.by = number("by_s");
  out.height = number("height_m");
  out.tolerance = number("tolerance_m");
  while (std::getline(in, line)) {
    const TapTrace::Row row = row_of(line);
    if (!out.rows.empty() && row.time < out.rows.back().time)
      throw std::runtime_error("'" + line + "' is earlier than the row before");
    out.rows.push_back(row);
  }
  if (out.rows.empty()) throw std::runtime_error("there are no rows");
  return out;
}

}  // namespace

TapTrace read_trace(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + " cannot be read");
  try {
    return read(in);
  } catch (const std::exception& trouble) {
    throw std::runtime_error(file.string() + ": " + trouble.what());
  }
}

void write_trace(const TapTrace& trace, const std::filesystem::path& file) {
  std::ofstream out(file);
  out << "# what: " << trace.what << "\n# motion: " << trace.motion << "\n# verdict: " << kVerdicts.at(trace.verdict)
      << fmt::format("\n# not_before_s: {:.2f}\n# by_s: {:.2f}\n# height_m: {:.4f}\n# tolerance_m: {:.4f}\n",
                     trace.not_before, trace.by, trace.height, trace.tolerance)
      << kColumns << '\n';
  for (const TapTrace::Row& row : trace.rows)
    out << fmt::format("{:.2f},{:.5f},{:.2f},{}\n", row.time, row.height, row.force, row.sender);
  if (!out.flush()) throw std::runtime_error(file.string() + " cannot be written");
}

std::vector<std::filesystem::path> recorded_traces() {
  std::vector<std::filesystem::path> out;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "tests/data/guarded_taps")) {
    if (entry.path().extension() == ".csv") out.push_back(entry.path());
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace palpate::test
