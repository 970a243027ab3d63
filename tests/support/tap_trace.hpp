// SPDX-License-Identifier: MIT
// Recorded descents with a verdict, tests/data/guarded_taps: what a guarded tap in any language must decide, and by
// when.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

/// A descent as an arm reported it, one row per control period of 10 ms, from the tare at the height of travel on. The
/// file begins with lines `# key: value`, the fields below; then come the columns time_s, height_m, force_n, sender. A
/// positive force presses against the tool. `sender` is 0 for the robot; of a period with two messages each has a row.
struct TapTrace {
  enum class Verdict {
    contact,     ///< the set-point stops within [not_before, by], and the tap reports `height` to within `tolerance`
    no_contact,  ///< the tap reports within [not_before, by] that nothing was touched
    fault        ///< the motion is stopped within [not_before, by], whatever the tap reports
  };
  struct Row {
    double time, height, force;
    int sender = 0;
  };

  std::string what;    ///< the case, a sentence
  std::string motion;  ///< YAML of the motion's options
  Verdict verdict = Verdict::contact;
  double not_before = 0.0;  ///< s
  double by = 0.0;          ///< s
  double height = 0.0;      ///< m
  double tolerance = 0.0;   ///< m
  std::vector<Row> rows;
};

/// Reads and writes a trace. Throws std::runtime_error with the file's name, and the line, if it is not one: a field
/// that is missing, an unknown verdict, a row that is not four numbers or is earlier than the one before, no rows.
TapTrace read_trace(const std::filesystem::path& file);
void write_trace(const TapTrace& trace, const std::filesystem::path& file);

/// All traces of tests/data/guarded_taps, by name.
std::vector<std::filesystem::path> recorded_traces();

}  // namespace palpate::test
