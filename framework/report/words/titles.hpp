// SPDX-License-Identifier: MIT
// Titles of maps and errors for pages, figures and texts.
#pragma once

#include "experiment/experiment_options.hpp"
#include "record/field.hpp"

#include <map>
#include <string>

namespace palpate {

/// Returns the titles of all possible maps, with their names in History::maps as keys, and the title of "e" (e = u w).
/// The titles of "p" and "score" name the plugins.
std::map<std::string, std::string> map_titles(const ExperimentOptions& options);

/// Returns the title of an error: "error over the scene", "footprint IoU".
std::string error_title(const RecordField& error);

/// Returns the common title of the errors that are lengths: "Error of the surface (rms)".
std::string surface_error_title(bool any_side);

}  // namespace palpate
