// SPDX-License-Identifier: MIT
// Arguments of `palpate curves`.
#pragma once

#include "cli/command_line.hpp"

namespace palpate::cli {

struct CurvesArguments {
  std::vector<std::string> records;  ///< sweeps and runs, as find_records() takes them; they are pooled into one sweep
  std::vector<std::string> by;       ///< swept keys that define the groups; if empty, curve_keys() of the sweep
  std::string metric;                ///< "": main_error() of the results
  std::string against = "taps";
  std::optional<std::string> where;
  std::vector<std::string> outputs;  ///< files to write; if empty, one picture and one table next to results.csv
  std::optional<int> workers;
  std::optional<std::string> width;  ///< width of the pictures, with its unit
};
PALPATE_WHOLE int curves(CommandEnvironment& program, const CurvesArguments& arguments);

inline void add_curves(CommandLine& line) {
  auto [command, query] = line.add<CurvesArguments>(
      "curves", "Draw curves of a sweep's results against taps, one per group with a band, and write them as CSV",
      curves, kNeedsEverything);
  command.pooled_records(query.records);
  command.argument(
      "--by", query.by, "KEYS",
      "swept keys that define the groups, for example acquisition,kernel; default: all swept keys except the "
      "seed and the scene. Each scene has its own panel",
      {comma_separated()});
  command.argument("--metric", query.metric, "COLUMN",
                   "column of results.csv to draw, for example footprint_iou; default: rmse_m, or "
                   "rms_surface_distance_m if the tool taps from any side");
  command.argument("--against", query.against, "COLUMN",
                   "quantity on the horizontal axis: taps is the number of taps, robot_seconds is the robot time",
                   {one_of({"taps", "robot_seconds"}), with_default()});
  command.argument("--where", query.where, "CONDITION",
                   "draw only jobs that satisfy this condition, for example \"first_hit_tap <= 3\"");
  command.argument(
      "-o", query.outputs, "FILE",
      "output file that ends in .png, .pdf, .svg or .csv; default: one PNG and one CSV file next to results.csv",
      {one_per_option()});
  command.argument("--width", query.width, "LENGTH",
                   "printed width of the figure, with unit, for example 8.8cm for one column; default: 17.8 cm, which "
                   "is two columns. Panels that do not fit side by side continue in a further row");
  command.argument("-j", query.workers, "N", "number of jobs replayed in parallel; default: number of cores",
                   {between(1, kMaxWorkers)});
  command.examples({"palpate curves runs/many/*",
                    "palpate curves runs/many/* --by acquisition --width 8.8cm -o curves.pdf -o curves.csv",
                    "palpate curves runs/many/* --metric footprint_iou --against robot_seconds -o iou.svg"});
}

}  // namespace palpate::cli
