// SPDX-License-Identifier: MIT
#include "cli/power.hpp"

#include "analysis/compare_report.hpp"
#include "cli/output.hpp"
#include "cli/sweep_display.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"

#include <palpate/error.hpp>

namespace palpate::cli {

int power(CommandEnvironment&, const PowerArguments& arguments) {
  const Sweep sweep = read_records(arguments.records, arguments.by);
  const std::optional<WhereCondition> where = WhereCondition::of_command_line(arguments.where);
  const double power = read_quantity(parse_value(arguments.power, "command line"), "--power", Unit::none);
  if (power < 0.5 || power > 0.99) throw Error("command line", "--power: outside 0.5 to 0.99", "0.8 is usual");
  for (const std::string& metric : arguments.metrics) {
    const CompareQuery query{arguments.by, metric, where ? &*where : nullptr, arguments.baseline};
    const Comparison made = palpate::compare(sweep, sweep_results(sweep), query);
    const Tree wanted = parse_value(arguments.difference, "command line");
    const double difference = read_quantity(wanted, "--difference", made.metric.unit);
    if (difference <= 0.0) throw Error("command line", "--difference: not positive", "give the smallest that matters");
    if (!made.by_seed) throw Error("command line", "the seed is not swept", "sweep it, as in \"seed=range(0,20)\"");
    print_out("{}\n", power_table(made, difference, power));
  }
  print_text(
      "sd: standard deviation of the differences per seed, with its chi-square interval.\n"
      "seeds needed: then, a two-sided paired t test at 5 % has this power on average over such pilots.\n");
  return kDone;
}

}  // namespace palpate::cli
