// SPDX-License-Identifier: MIT
#include "cli/pareto.hpp"

#include "analysis/gnuplot.hpp"
#include "analysis/mean_output.hpp"
#include "analysis/pareto_report.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "cli/sweep_display.hpp"
#include "config/yaml.hpp"
#include "record/files.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace palpate::cli {
namespace {

/// Writes the picture and the table into the folder of results.csv.
void write_files(const Sweep& sweep, const Pareto& pareto, const std::string& name, const std::string& where,
                 const std::optional<double>& bound, const Setting* chosen) {
  const std::filesystem::path stem = sweep.directory / fmt::format("pareto_{}_{}{}", slug(pareto.cost.name),
                                                                   slug(pareto.error.name), where_suffix(where));
  write_file(stem.string() + ".csv", to_csv(pareto_rows(pareto)));
  const bool empty = std::all_of(pareto.settings.begin(), pareto.settings.end(),
                                 [](const Setting& one) { return one.cost.count == 0; });
  const std::string title = fmt::format("{}: {} settings, {} each; bars: 95 % intervals of the means", name,
                                        pareto.settings.size(), seeds_words(pareto));
  const std::string trouble = empty ? "no setting has a value"
                                    : draw_picture(pareto_script(pareto, title, bound, chosen), kParetoWidth,
                                                   kParetoHeight, stem.string() + ".png");
  if (trouble.empty()) {
    print_message(fmt::format("picture: {0}.png, table: {0}.csv\n", stem.string()));
  } else {
    print_message(fmt::format("no picture was drawn: {}; table: {}.csv\n", trouble, stem.string()));
  }
}

/// Prints the config of the first job of a setting, after a comment with the reason for this choice. The expectations
/// of the sweep are left out, because they do not apply to a single run.
void print_config(const Sweep& sweep, const Pareto& pareto, const Setting& chosen, double bound) {
  Tree config = read_run_config(job_directory(sweep, sweep.jobs[chosen.first_job]));
  config.erase("expect");
  // With a new name, the run gets a folder runs/NAME of its own. The examples of other commands assume that runs/NAME/*
  // is a single directory.
  Tree& name = config.at("name");
  name = Tree::scalar(name.text + "_best", true);
  const char* const kept =
      pareto.more_is_better() ? "lower 95 % bound of {} is at least {}" : "upper 95 % bound of {} is at most {}";
  print_out("# {}\n# The cheapest setting of {} whose {}:\n", chosen.name, sweep.directory.string(),
            fmt::format(fmt::runtime(kept), pareto.error.name, bound_words(pareto, bound)));
  print_out("# {}; {}; {}, of which this is the first.\n", error_words(pareto, chosen), cost_words(pareto, chosen),
            units_words(chosen.error.clusters, pareto.by_seed));
  print_data(to_yaml(config));
}

}  // namespace

int pareto(CommandEnvironment&, const ParetoArguments& arguments) {
  const Sweep sweep = read_records(arguments.records, {});
  const std::optional<WhereCondition> where = WhereCondition::of_command_line(arguments.where);
  const Pareto pareto =
      make_pareto(sweep, sweep_results(sweep), arguments.cost, arguments.error, where ? &*where : nullptr);
  const bool asked = arguments.within.has_value();
  const std::optional<double> bound = asked ? std::optional(read_bound(pareto, *arguments.within)) : std::nullopt;
  const Setting* chosen = bound ? cheapest_within(pareto, *bound) : nullptr;
  if (pareto.unfinished > 0)
    print_message(
        fmt::format("{} of {} jobs have not ended, run them with 'palpate resume'\n", pareto.unfinished, pareto.jobs));
  asked ? print_message(pareto_table(pareto)) : print_text(pareto_table(pareto));
  // The config is printed first, because writing the files may fail.
  if (chosen != nullptr) print_config(sweep, pareto, *chosen, *bound);
  write_files(sweep, pareto, sweep_name(sweep), arguments.where.value_or(""), bound, chosen);
  if (!bound || chosen != nullptr) return kDone;
  const Setting* best = best_bounded(pareto);
  throw Error("", fmt::format("no setting keeps {} within {}", pareto.error.name, bound_words(pareto, *bound)),
              best != nullptr
                  ? fmt::format("the nearest is {}: {}", best->name, error_words(pareto, *best))
                  : "no setting has an interval, which needs two or more seeds with different values and no failed job",
              Error::Kind::run);
}

}  // namespace palpate::cli
