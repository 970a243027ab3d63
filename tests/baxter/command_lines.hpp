// SPDX-License-Identifier: MIT
// Command lines of robot and program in tests, and access to fields of records.
#pragma once

#include "record/json.hpp"
#include "support/parts.hpp"
#include "support/support.hpp"

#include <string>
#include <vector>

namespace palpate::test {

inline std::string object_i() { return (source_folder() / "configs/paper/object_i.yaml").string(); }

/// Returns arguments of fake_baxter: object I with the effects of an arm like Baxter, at ten times real time.
inline std::vector<std::string> robot_arguments(const std::vector<std::string>& more = {}) {
  std::vector<std::string> out{object_i(), "backend=fake_baxter", "scene=object_i_arm", "--rate", "10"};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

/// Returns arguments of palpate: the paper's experiment on this robot with this number of taps.
inline std::vector<std::string> run_arguments(int taps, const std::vector<std::string>& more = {}) {
  const std::string initial = std::to_string(std::min(taps, 3));
  std::vector<std::string> out{
      "run", object_i(), "backend=fake_baxter", "taps=" + std::to_string(taps), "--quiet", "initial.count=" + initial};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

/// Returns the taps of a run that have a result.
inline std::vector<Row> results(const std::filesystem::path& run) { return rows_of(run, "tap"); }

/// Returns a field of a row as text, empty for null.
inline std::string field(const Row& row, const char* name) {
  const Scalar* value = row.find(name);
  return value != nullptr ? csv_cell(*value) : "no such field";
}

/// Returns a field of all rows as text.
inline std::vector<std::string> fields(const std::vector<Row>& rows, const char* name) {
  std::vector<std::string> out;
  for (const Row& row : rows) out.push_back(field(row, name));
  return out;
}

}  // namespace palpate::test
