// SPDX-License-Identifier: MIT
#pragma once

#include "config/resolve.hpp"
#include "config/yaml.hpp"
#include "support/support.hpp"

#include <string>

namespace palpate::test {

/// An options struct filled from a YAML map, checked as a run would. Throws Error.
template <class Filled>
Filled filled(const std::string& yaml) {
  Filled options;
  ResolveNotes notes;
  resolve(options, parse_yaml(yaml, "options.yaml"), shared_host(), notes);
  return options;
}

}  // namespace palpate::test
