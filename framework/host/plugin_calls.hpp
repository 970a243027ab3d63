// SPDX-License-Identifier: MIT
// A wrapper around plugins that adds the name of the plugin to errors and checks its results.
#pragma once

#include <memory>
#include <string>

namespace palpate {

class Motions;

/// Returns `object`, which implements the interface of `kind`, behind a wrapper of the same interface. Any exception
/// becomes an Error with the place <kind>/<type>. The texts of the Error are copies, because the code of the exception
/// belongs to the library. If the interface requires a finite result and the plugin's result is not finite, the wrapper
/// throws Error of kind `run`. Scores and contacts are not checked here, because the code that uses them checks them.
std::shared_ptr<void> wrap_plugin(const std::string& kind, const std::string& type,
                                  const std::shared_ptr<void>& object);

/// Returns the motions of a backend, behind a wrapper like that of the other overload. `name` is <kind>/<type>.
std::shared_ptr<const Motions> wrap_plugin(const std::string& name, const std::shared_ptr<Motions>& motions);

}  // namespace palpate
