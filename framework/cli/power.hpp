// SPDX-License-Identifier: MIT
// Arguments of `palpate power`.
#pragma once

#include "cli/compare.hpp"

namespace palpate::cli {

struct PowerArguments : ComparedArguments {
  std::string difference;
  std::string power = "0.8";
};
PALPATE_WHOLE int power(CommandEnvironment& program, const PowerArguments& arguments);

inline void add_power(CommandLine& line) {
  auto [command, query] = line.add<PowerArguments>("power", "Plan how many seeds a sweep needs", power, kNeedsWhole);
  add_compared(command, query, false);
  command.argument("--difference", query.difference, "VALUE", "difference to detect, for example 1mm", {required()});
  command.argument("--power", query.power, "NUMBER", "probability of detecting it, from 0.5 to 0.99", {with_default()});
  command.examples({"palpate power runs/pilot/* --by acquisition --metric rmse_m --difference 1mm",
                    "palpate power runs/pilot/* --by strategy --metric footprint_iou --difference 0.1 --power 0.9"});
}

}  // namespace palpate::cli
