// SPDX-License-Identifier: MIT
// What goes wrong inside of a plugin is told with the plugin's name.
#pragma once

#include <memory>
#include <string>

namespace palpate {

/// `object`, which implements the interface of `kind`, behind another of that interface: whatever it throws becomes an
/// Error whose place is <kind>/<type>. Only copies of its words leave the plugin, where the code of its exceptions is.
std::shared_ptr<void> named(const std::string& kind, const std::string& type, const std::shared_ptr<void>& object);

}  // namespace palpate
