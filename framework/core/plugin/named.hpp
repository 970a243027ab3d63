// SPDX-License-Identifier: MIT
// What goes wrong inside of a plugin is told with the plugin's name.
#pragma once

#include <memory>
#include <string>

namespace palpate {

class Motions;

/// `object`, which implements the interface of `kind`, behind another of that interface: whatever it throws becomes an
/// Error whose place is <kind>/<type>. Only copies of its words leave the plugin, where the code of its exceptions is.
/// A function that gives a number which is not finite, where its interface asks for a finite one, ends the run
/// likewise. Two are checked where their numbers are used: scores, and contacts, which become failed taps.
std::shared_ptr<void> named(const std::string& kind, const std::string& type, const std::shared_ptr<void>& object);

/// The same of the motions of a backend, `name` <kind>/<type>.
std::shared_ptr<const Motions> named(const std::string& name, const std::shared_ptr<Motions>& motions);

}  // namespace palpate
