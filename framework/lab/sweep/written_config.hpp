// SPDX-License-Identifier: MIT
// The config that a sweep leaves in its directory.
#pragma once

#include "config/tree.hpp"
#include "record/resolved.hpp"
#include "sweep/description.hpp"

#include <filesystem>
#include <optional>

namespace palpate {

/// A config from which `palpate sweep` makes the same jobs again. What the sweep leaves alone stands there in full,
/// groups included; where it chooses groups or types, there stands what `file` itself says, because what a group brings
/// must not outlive another choice. `base` is `file` composed without any combination, `alone` the same
/// resolved, if it is a whole config; `first` the first job, whose order of keys is taken.
Tree written_config(const std::filesystem::path& file, const Tree& base, const std::optional<ResolvedConfig>& alone,
                    const SweepDescription& description, const ResolvedConfig& first);

}  // namespace palpate
