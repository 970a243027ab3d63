// SPDX-License-Identifier: MIT
// The manual, from the same list as `--help`: palpate(1), and a page for each command.
#pragma once

#include "cli/usage.hpp"

#include <filesystem>

namespace palpate::cli {

/// Writes palpate.1 and palpate-COMMAND.1 into `folder`, which is made. Throws std::runtime_error where it cannot.
void write_manual(const Usage& usage, const std::filesystem::path& folder);

}  // namespace palpate::cli
