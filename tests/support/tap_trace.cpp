// SPDX-License-Identifier: MIT
#include "support/tap_trace.hpp"

#include "support/support.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace palpate::test {

TapTrace read_trace(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + " cannot be read");
  std::map<std::string, std::string> fields;
  std::string line;
  while (std::getline(in, line) && line.rfind("# ", 0) == 0) {
    const std::size_t colon = line.find(": ");
    if (colon == std::string::npos) throw std::runtime_error(file.string() + ": no field in '" + line + "'");
    fields[line.substr(2, colon - 2)] = line.substr(colon + 2);
  }
  const auto number = [&](const char* name) { return std::stod(fields.at(name)); };
  TapTrace out;
  try {
    out.what = fields.at("what");
    out.motion = fields.at("motion");
    out.verdict = fields.at("verdict") == "fault" ? TapTrace::Verdict::fault : TapTrace::Verdict::contact;
    out.not_before = number("not_before_s");
    out.by = number("by_s");
    out.height = number("height_m");
    out.tolerance = number("tolerance_m");
    for (char comma = 0; std::getline(in, line);) {
      TapTrace::Row row{};
      std::istringstream(line) >> row.time >> comma >> row.height >> comma >> row.force;
      out.rows.push_back(row);
    }
  } catch (const std::exception& trouble) {
    throw std::runtime_error(file.string() + ": " + trouble.what());
  }
  return out;
}

void write_trace(const TapTrace& trace, const std::filesystem::path& file) {
  std::ofstream out(file);
  out << "# what: " << trace.what << "\n# motion: " << trace.motion
      << "\n# verdict: " << (trace.verdict == TapTrace::Verdict::fault ? "fault" : "contact")
      << fmt::format("\n# not_before_s: {:.2f}\n# by_s: {:.2f}\n# height_m: {:.4f}\n# tolerance_m: {:.4f}\n",
                     trace.not_before, trace.by, trace.height, trace.tolerance)
      << "time_s,height_m,force_n\n";
  for (const TapTrace::Row& row : trace.rows)
    out << fmt::format("{:.2f},{:.5f},{:.2f}\n", row.time, row.height, row.force);
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
