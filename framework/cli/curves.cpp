// SPDX-License-Identifier: MIT
#include "cli/curves.hpp"

#include "analysis/group_curves_report.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "cli/sweep_display.hpp"
#include "config/catch_error.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "record/files.hpp"
#include "report/figures/figures.hpp"
#include "sweep/tap_summaries.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <set>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 4> kExtensions{".csv", ".png", ".pdf", ".svg"};

/// Returns the files to write: the files of -o, or else one picture and one table in the folder of results.csv. PDFs
/// come last. Pictures whose names differ only in the extension overwrite each other's gnuplot script, and the script
/// of the PDF should remain, because papers use PDFs.
std::vector<fs::path> curve_files(const Sweep& sweep, const CurvesArguments& arguments,
                                  const std::vector<std::string>& by, const std::string& metric) {
  std::vector<fs::path> out(arguments.outputs.begin(), arguments.outputs.end());
  for (const fs::path& file : out) {
    if (std::find(kExtensions.begin(), kExtensions.end(), file.extension().string()) == kExtensions.end())
      throw Error("command line", fmt::format("-o: '{}' has no supported file extension", file.string()),
                  fmt::format("use one of {}", fmt::join(kExtensions, ", ")));
    const fs::path folder = fs::absolute(file).parent_path();
    if (!fs::is_directory(folder))
      throw Error("command line", fmt::format("-o: the folder '{}' does not exist", folder.string()),
                  "create it first");
  }
  std::stable_partition(out.begin(), out.end(), [](const fs::path& file) { return file.extension() != ".pdf"; });
  if (!out.empty()) return out;
  const std::string groups = by.empty() ? "all" : slug(fmt::format("{}", fmt::join(by, "_")));
  const std::string name = fmt::format("curves_{}_{}_{}{}", groups, slug(metric), arguments.against,
                                       where_suffix(arguments.where.value_or("")));
  return {sweep.directory / (name + ".csv"), sweep.directory / (name + ".png")};
}

/// Returns the width of the pictures, metres.
double width_of(const CurvesArguments& arguments) {
  if (!arguments.width) return kFigureWidth;
  constexpr double kLeast = 0.05;
  constexpr double kMost = 1.0;
  const double width = read_quantity(parse_value(*arguments.width, "command line"), "--width", Unit::metre);
  if (width < kLeast || width > kMost)
    throw Error("command line", fmt::format("--width: {} is not between 5 cm and 1 m", *arguments.width),
                "use for example 8.8 cm for a column of a paper");
  return width;
}

/// Writes the table and the pictures, and prints the names of their files.
void write_curves(const Sweep& sweep, const GroupCurves& made, const CurvesArguments& arguments,
                  const std::vector<fs::path>& files, double width) {
  const std::string title = sweep_name(sweep) + (arguments.where ? ", where " + *arguments.where : "");
  std::set<fs::path> scripts;
  for (const fs::path& file : files) {
    if (file.extension() == ".csv") {
      write_file(file, to_csv(curves_rows(made)));
      print_message(fmt::format("table: {}\n", file.string()));
      continue;
    }
    std::string note;
    const auto trouble = catch_error([&] { note = write_curves_figure(made, title, width, file); });
    const fs::path script = fs::path(file).replace_extension(".gnuplot");
    if (std::error_code none; fs::is_regular_file(script, none)) scripts.insert(script);
    // Without -o, a missing picture is not an error, because the table is still a result.
    if (trouble && !arguments.outputs.empty()) throw *trouble;
    if (trouble) {
      print_message(fmt::format("no picture was drawn: {}\n", trouble->what()));
      continue;
    }
    if (!note.empty()) print_message(note + "\n");
    print_message(fmt::format("picture: {}\n", file.string()));
  }
  for (const fs::path& script : scripts) print_message(fmt::format("script: {}\n", script.string()));
}

}  // namespace

int curves(CommandEnvironment& program, const CurvesArguments& arguments) {
  const Sweep sweep = read_records(arguments.records, arguments.by);
  const std::vector<std::string> by = arguments.by.empty() ? curve_keys(sweep) : arguments.by;
  const std::vector<Row> results = sweep_results(sweep);
  const std::string asked = arguments.metric.empty() ? main_error(results) : arguments.metric;
  const std::vector<fs::path> files = curve_files(sweep, arguments, by, asked);
  const double width = width_of(arguments);
  if (asked.find(',') != std::string::npos)
    throw Error("command line", fmt::format("--metric: '{}' names several columns, but a figure shows one", asked),
                "draw one figure per column");
  const std::optional<WhereCondition> where = WhereCondition::of_command_line(arguments.where);
  // Invalid keys and metrics are rejected before the long computation.
  check_group_keys(sweep, by);
  if (!results.empty()) find_metric(sweep, asked, names_of(results));
  const std::string metric = field_name(asked);
  std::vector<TapValues> values(sweep.jobs.size());
  const TapSummaries summaries(sweep, keep_values(values, {metric, arguments.against}));
  const bool all = compute_jobs(program, summaries.missing(), arguments.workers,
                                [&](std::size_t job) { summaries.compute(program, job); });
  if (!all) return kInterrupted;
  summaries.read_missing();
  const GroupCurves made =
      make_group_curves(sweep, results, values, {by, metric, arguments.against, where ? &*where : nullptr});
  print_text(curves_table(made));
  write_curves(sweep, made, arguments, files, width);
  return kDone;
}

}  // namespace palpate::cli
