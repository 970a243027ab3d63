// SPDX-License-Identifier: MIT
#include "record/build_info.hpp"

#include "config/hash.hpp"
#include "record/files.hpp"
#include "record/json.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <Eigen/Core>
#include <boost/version.hpp>

#include <array>

#include <unistd.h>

namespace palpate {

namespace fs = std::filesystem;

const char* const kVersion = PALPATE_VERSION;

namespace {

Tree libraries() {
  const auto version = [](int major, int minor, int patch) {
    return Tree::quote(fmt::format("{}.{}.{}", major, minor, patch));
  };
  return Tree::map({{"Eigen", version(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
                    {"Boost", Tree::quote(BOOST_LIB_VERSION)},
                    {"fmt", version(FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
                    {"yaml-cpp", Tree::quote(PALPATE_YAML_CPP_VERSION)}});
}

Tree describe_plugins(const PluginHost& host, const PluginNames& plugins) {
  Tree out = Tree::list();
  for (const LoadedPlugin& one : host.loaded(plugins)) {
    out.items.push_back(Tree::map({{"kind", Tree::quote(one.kind)},
                                   {"name", Tree::quote(one.name)},
                                   {"file", Tree::quote(one.file.string())},
                                   {"hash", Tree::quote(one.hash)},
                                   {"abi", Tree::scalar(std::to_string(kPluginAbi))}}));
  }
  return out;
}

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

Installation find_installation() {
  const fs::path folder = fs::read_symlink("/proc/self/exe").parent_path();
  const fs::path program = folder / "palpate";
  // Installed: bin/palpate, lib/palpate/plugins, share/palpate/configs. Built: build/<preset>/palpate beside lib.
  if (fs::exists(folder / "lib" / "palpate"))
    return {program, folder / "palpate-whole", folder / "lib" / "palpate", folder / ".." / ".." / "configs"};
  return {program, program, folder / ".." / "lib" / "palpate", folder / ".." / "share" / "palpate" / "configs"};
}

std::string build_hash(const PluginHost& host, const PluginNames& plugins) {
  std::string all = kCoreHash;
  for (const LoadedPlugin& one : host.loaded(plugins)) all += one.kind + "/" + one.name + "=" + one.hash;
  return hash_of(all);
}

Tree describe_build(const Installation& installation, const PluginHost& host, const PluginNames& plugins,
                    const std::string& instruction_path) {
  // Kept beside the program, not in it: a commit that changes no code leaves the program's bytes alone.
  const fs::path commit = installation.plugins / "build.json";
  Tree stamp = is_there(commit) ? read_json(commit) : Tree::map();
  return Tree::map({{"version", Tree::quote(kVersion)},
                    {"commit", stamp.at("commit")},
                    {"dirty", stamp.at("dirty")},
                    {"build", Tree::quote(build_hash(host, plugins))},
                    {"compiler", Tree::quote(PALPATE_COMPILER)},
                    {"instruction_path", Tree::quote(instruction_path)},
                    {"build_stamp", Tree::quote(PALPATE_BUILD_STAMP)},
                    {"libraries", libraries()},
                    {"plugins", describe_plugins(host, plugins)},
                    {"host", Tree::quote(host_name())}});
}

}  // namespace palpate
