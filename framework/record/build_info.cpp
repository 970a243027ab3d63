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

/// Returns the commit, and whether the source tree differed from it. A separate file, not the program, contains this
/// information, so that a commit without changes of code does not change the program.
Tree read_stamp(const Installation& installation) {
  const fs::path file = installation.plugins / "build.json";
  return is_there(file) ? read_json(file, FileOrigin::user) : Tree::map();
}

Tree describe_plugins(const PluginHost& host, const PluginNames& plugins) {
  Tree out = Tree::list();
  for (const LoadedPlugin& one : host.loaded(plugins))
    out.items.push_back(Tree::map({{"kind", Tree::quote(one.kind)},
                                   {"name", Tree::quote(one.name)},
                                   {"file", Tree::quote(one.file.string())},
                                   {"hash", Tree::quote(one.hash)},
                                   {"abi", Tree::scalar(std::to_string(kPluginAbi))}}));
  return out;
}

}  // namespace

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

Installation find_installation() { return find_installation(fs::read_symlink("/proc/self/exe")); }

Installation find_installation(const fs::path& file) {
  for (fs::path folder = file.parent_path(); folder != folder.root_path(); folder = folder.parent_path()) {
    const fs::path plugins = folder / "lib" / "palpate";
    if (!fs::exists(plugins)) continue;
    const fs::path configs = folder / "share" / "palpate" / "configs";
    const fs::path installed = folder / "bin" / "palpate";
    if (fs::exists(configs)) return {installed, installed, plugins, configs};
    return {folder / "palpate", folder / "palpate-whole", plugins, folder.parent_path().parent_path() / "configs"};
  }
  throw Error(file.string(), "is not part of an installation: there is no lib/palpate above it",
              "install palpate as a whole");
}

std::string build_text(const Installation& installation) {
  const Tree stamp = read_stamp(installation);
  const auto said = [&](const char* key) {
    const Tree* value = stamp.find(key);
    return value != nullptr ? value->text : std::string();
  };
  const std::string commit = said("commit");
  return fmt::format("palpate {}\ncommit: {}{}\nbuild: {}\ncompiler: {}", kVersion, commit.empty() ? "unknown" : commit,
                     said("dirty") == "true" ? ", with changes that are in no commit" : "", hash_of(kCoreHash),
                     PALPATE_COMPILER);
}

std::string build_hash(const PluginHost& host, const PluginNames& plugins) {
  std::string all = kCoreHash;
  for (const LoadedPlugin& one : host.loaded(plugins)) all += one.kind + "/" + one.name + "=" + one.hash;
  return hash_of(all);
}

Tree describe_build(const Installation& installation, const PluginHost& host, const PluginNames& plugins,
                    const std::string& instruction_path) {
  Tree stamp = read_stamp(installation);
  return Tree::map({{"version", Tree::quote(kVersion)},
                    {"commit", stamp.at("commit")},
                    {"dirty", stamp.at("dirty")},
                    {"build", Tree::quote(build_hash(host, plugins))},
                    {"build_without_plugins", Tree::quote(hash_of(kCoreHash))},
                    {"compiler", Tree::quote(PALPATE_COMPILER)},
                    {"instruction_path", Tree::quote(instruction_path)},
                    {"build_stamp", Tree::quote(PALPATE_BUILD_STAMP)},
                    {"libraries", libraries()},
                    {"plugins", describe_plugins(host, plugins)},
                    {"host", Tree::quote(host_name())}});
}

}  // namespace palpate
