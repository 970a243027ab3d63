// SPDX-License-Identifier: MIT
// What the maps of a run are called, on its page and in its pictures alike.
#pragma once

#include "experiment/experiment_options.hpp"
#include "record/field.hpp"

#include <map>
#include <string>

namespace palpate {

/// A line each, by the names of History::maps, and of `e` = u w: of all that may be drawn, whether this run has it or
/// not. "p" and "score" name the plugins that they come from.
std::map<std::string, std::string> map_titles(const ExperimentOptions& options);

/// Returns the title of an error: "error over the scene", "footprint IoU".
std::string error_title(const RecordField& error);

/// Returns the title of the errors that are lengths: "Error of the surface (rms)".
std::string surface_error_title(const ExperimentOptions& options);

}  // namespace palpate
