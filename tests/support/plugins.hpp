// SPDX-License-Identifier: MIT
// Plugins by their names, made as a run makes them: what unit and contract tests start from.
#pragma once

#include "config/tree.hpp"
#include "host/plugin_host.hpp"

#include <palpate/plugin.hpp>

#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

/// `options` is a YAML map, for example "{length_scale: 2 cm}", checked as a run would. Throws Error.
PluginChoice choose(const PluginHost& host, const std::string& kind, const std::string& name,
                    const std::string& options = "{}");

/// A desk of 23 cm by 23 cm at height 0 with the paper's object I in the middle.
const Scene& wave_scene();

/// What plugins are born with: `host`, wave_scene() and a seed.
Context context_of(const PluginHost& host, std::uint64_t seed = 1);

/// A host over the plugins of this build and those on PALPATE_PLUGIN_PATH: a plugin's author runs the contract tests
/// over his own.
const PluginHost& contract_host();

/// The names of the plugins of a kind that contract_host() finds. Broken ones are among them: their tests fail and say
/// why. A plugin with an option that has no default is left to tests of its own, which know what to say there.
std::vector<std::string> plugins_under_contract(const std::string& kind);

/// The name of a plugin in letters that a test's name may have.
std::string test_name(std::string plugin);

template <class Interface>
std::shared_ptr<Interface> make(const PluginHost& host, const std::string& name, const std::string& options = "{}",
                                std::uint64_t seed = 1) {
  return context_of(host, seed).create<Interface>(choose(host, Interface::kKind, name, options));
}

}  // namespace palpate::test
