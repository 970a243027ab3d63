// SPDX-License-Identifier: MIT
#include "analysis/compare_report.hpp"
#include "cli/commands.hpp"
#include "config/hash.hpp"
#include "experiment/resolved.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdio>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

Condition read_condition(const std::string& text) {
  Tree tree = Tree::scalar(text, true);
  tree.place.file = std::make_shared<const std::string>("command line: --where");
  return Condition(tree);
}

/// Beside results.csv. Comparisons on other conditions have files of their own.
fs::path table_file(const Sweep& sweep, const Comparison& comparison, const std::string& where) {
  constexpr std::size_t kDigits = 6;
  std::string name = fmt::format("compare_{}_{}", slug(fmt::format("{}", fmt::join(comparison.by, "_"))),
                                 slug(comparison.metric.name));
  if (!where.empty()) name += "_where_" + hash_of(where).substr(0, kDigits);
  return sweep.directory / (name + ".csv");
}

}  // namespace

int compare(const CompareArguments& arguments) {
  if (!is_sweep(arguments.directory))
    throw Error(arguments.directory, "is not the directory of a sweep", "it has no manifest.jsonl");
  const Sweep sweep = read_sweep(arguments.directory);
  const std::vector<Row> results = sweep_results(sweep);
  std::optional<Condition> where;
  if (arguments.where) where.emplace(read_condition(*arguments.where));
  // All first: an unknown metric is no reason for half of an answer.
  std::vector<Comparison> comparisons;
  for (const std::string& metric : arguments.metrics) {
    comparisons.push_back(
        palpate::compare(sweep, results, {arguments.by, metric, where ? &*where : nullptr, arguments.baseline}));
  }
  for (const Comparison& one : comparisons) fmt::print("{}\n", compare_tables(one));
  fmt::print("{}", compare_legend(comparisons));
  const std::string condition = arguments.where.value_or("");
  for (const Comparison& one : comparisons) {
    const fs::path file = table_file(sweep, one, condition);
    try {
      write_file(file, to_csv(compare_rows(one, condition)));
      fmt::print(stderr, "table: {}\n", file.string());
    } catch (const Error& trouble) {  // what was asked for is on stdout
      fmt::print(stderr, "no table was left: {}\n", trouble.what());
    }
  }
  return kDone;
}

}  // namespace palpate::cli
