// SPDX-License-Identifier: MIT
#include "report/words/titles.hpp"

namespace palpate {

std::map<std::string, std::string> map_titles(const ExperimentOptions& options) {
  return {{"height", "Reconstructed surface"},
          {"deviation", "Standard deviation of the height"},
          {"u", "Uncertainty u: relative variance of the height"},
          {"w", "Weight w: 1 on an object, 0 on the desk"},
          {"p", "Probability p of an object, by footprint/" + belief_option(options, "footprint.type")},
          {"e", "Exploration e = u w: where to tap"},
          {"score", "Score of acquisition/" + options.acquisition.type + ": where to tap"}};
}

std::string error_title(const RecordField& error) { return (error.unit == Unit::metre ? "error " : "") + error.label; }

std::string surface_error_title(bool any_side) {
  return any_side ? "Error of the surface" : "Error of the surface (rms)";
}

}  // namespace palpate
