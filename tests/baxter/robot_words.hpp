// SPDX-License-Identifier: MIT
// The words with which tests start the robot and the program, and what they read of the record.
#pragma once

#include "record/json.hpp"
#include "support/parts.hpp"
#include "support/support.hpp"

#include <string>
#include <vector>

namespace palpate::test {

inline std::string object_i() { return (source_folder() / "configs/paper/object_i.yaml").string(); }

/// For fake_baxter: object I as an arm like Baxter feels it, at ten times the speed of real time.
inline std::vector<std::string> robot_words(const std::vector<std::string>& more = {}) {
  std::vector<std::string> out{object_i(), "backend=fake_baxter", "scene=object_i_arm", "--rate", "10"};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

/// For palpate: the paper's experiment on it, so many taps of it.
inline std::vector<std::string> run_words(int taps, const std::vector<std::string>& more = {}) {
  const std::string initial = std::to_string(std::min(taps, 3));
  std::vector<std::string> out{
      "run", object_i(), "backend=fake_baxter", "taps=" + std::to_string(taps), "--quiet", "initial.count=" + initial};
  out.insert(out.end(), more.begin(), more.end());
  return out;
}

/// The taps of a run that have a result.
inline std::vector<Row> results(const std::filesystem::path& run) { return rows_of(run, "tap"); }

/// One field of them as text, "" for null.
inline std::string field(const Row& row, const char* name) {
  const Scalar* value = row.find(name);
  return value != nullptr ? csv_cell(*value) : "no such field";
}

/// The same of all of them.
inline std::vector<std::string> fields(const std::vector<Row>& rows, const char* name) {
  std::vector<std::string> out;
  for (const Row& row : rows) out.push_back(field(row, name));
  return out;
}

}  // namespace palpate::test
