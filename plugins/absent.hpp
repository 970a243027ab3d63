// SPDX-License-Identifier: MIT
// What stands in the place of a plugin whose libraries this build was made without. Its options are those of the real
// one, so that configs and records from elsewhere are read, listed and hashed alike; only to be made, it lacks what
// absent_plugin() of plugins/CMakeLists.txt names, and says what to install.
#pragma once

#include <palpate/plugin.hpp>

namespace palpate::absent {

constexpr const char* kReason =
    "this build has no " PALPATE_ABSENT "; 'sudo apt-get install --no-install-recommends " PALPATE_ABSENT_PACKAGES
    "' installs it, then build again, as ./palpate does by itself";

template <class Options>
void describe(Fields& fields) {
  Options options;
  options.list(fields);
}

/// What is wrong with the options is said first, as by the real one.
template <class Options>
void* refuse(Fields& fields, const Context&) {
  describe<Options>(fields);
  throw Error("", kReason);
}

/// Nothing was made.
inline void destroy(void*) {}

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
          &describe<Options>,
          &refuse<Options>,
          &destroy};
}

}  // namespace palpate::absent

/// Exports the plugin that is not there, of the interface and with the options of the real one.
#define PALPATE_ABSENT_PLUGIN(Interface, Options, name, summary)                                    \
  extern "C" __attribute__((visibility("default"))) const ::palpate::PluginManifest palpate_plugin; \
  const ::palpate::PluginManifest palpate_plugin = ::palpate::absent::manifest_of<Interface, Options>(name, summary);
