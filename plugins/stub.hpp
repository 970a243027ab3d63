// SPDX-License-Identifier: MIT
// Stub of a plugin whose libraries were missing in this build. It has the options of the real plugin, so configs and
// records are read, listed and hashed in the same way. Creating the plugin fails with an error that lists the packages
// of stub_plugin() (plugins/CMakeLists.txt).
#pragma once

#include <palpate/plugin.hpp>

namespace palpate::stub {

constexpr const char* kReason =
    "this build has no " PALPATE_STUB "; 'sudo apt-get install --no-install-recommends " PALPATE_STUB_PACKAGES
    "' installs it, then build again; ./palpate does both";

/// Fills the manifest as palpate::manifest_of() does for a real plugin.
template <class Interface, class Options>
constexpr PluginManifest manifest_of(const char* name, const char* summary) {
  return {{'p', 'a', 'l', 'p', 'a', 't', 'e', '\0'},
          kPluginAbi,
          sizeof(PluginManifest),
          PALPATE_BUILD_STAMP,
          Interface::kKind,
          name,
          summary,
          false,
          [](Fields& fields) { Options().list(fields); },
          // Errors in the options come first, as in the real plugin.
          [](Fields& fields, const Context&) -> void* {
            Options().list(fields);
            throw Error("", kReason);
          },
          [](void*) {},
          nullptr};
}

}  // namespace palpate::stub

/// Exports the stub with the interface and the options of the real plugin.
#define PALPATE_STUB_PLUGIN(Interface, Options, name, summary)                                      \
  extern "C" __attribute__((visibility("default"))) const ::palpate::PluginManifest palpate_plugin; \
  const ::palpate::PluginManifest palpate_plugin = ::palpate::stub::manifest_of<Interface, Options>(name, summary);
