// SPDX-License-Identifier: MIT
// What stands in the place of a plugin whose libraries this build was made without. Its options are those of the real
// one, so that configs and records from elsewhere are read, listed and hashed alike; only to be made, it lacks what
// absent_plugin() of plugins/CMakeLists.txt names, and says what to install.
#pragma once

#include <palpate/plugin.hpp>

namespace palpate::absent {

constexpr const char* kReason =
    "this build has no " PALPATE_ABSENT "; 'sudo apt-get install --no-install-recommends " PALPATE_ABSENT_PACKAGES
    "' installs it, then build again; ./palpate does both";

/// As manifest_of() fills it for a plugin that is there.
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
          // What is wrong with the options is said first, as by the real one.
          [](Fields& fields, const Context&) -> void* {
            Options().list(fields);
            throw Error("", kReason);
          },
          [](void*) {},
          nullptr};
}

}  // namespace palpate::absent

/// Exports the plugin that is not there, of the interface and with the options of the real one.
#define PALPATE_ABSENT_PLUGIN(Interface, Options, name, summary)                                    \
  extern "C" __attribute__((visibility("default"))) const ::palpate::PluginManifest palpate_plugin; \
  const ::palpate::PluginManifest palpate_plugin = ::palpate::absent::manifest_of<Interface, Options>(name, summary);
