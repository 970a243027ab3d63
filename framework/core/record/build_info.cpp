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
  Tree out = Tree::map();
  out.at("Eigen") = Tree::quote(fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION));
  out.at("Boost") = Tree::quote(BOOST_LIB_VERSION);
  out.at("fmt") = Tree::quote(fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100));
  out.at("yaml-cpp") = Tree::quote(PALPATE_YAML_CPP_VERSION);
  return out;
}

Tree describe_plugins(const PluginHost& host, const PluginNames& plugins) {
  Tree out = Tree::list();
  for (const LoadedPlugin& one : host.loaded(plugins)) {
    Tree row = Tree::map();
    row.at("kind") = Tree::quote(one.kind);
    row.at("name") = Tree::quote(one.name);
    row.at("file") = Tree::quote(one.file.string());
    row.at("hash") = Tree::quote(one.hash);
    row.at("abi") = Tree::scalar(std::to_string(kPluginAbi));
    out.items.push_back(std::move(row));
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
  Tree out = Tree::map();
  out.at("version") = Tree::quote(kVersion);
  // Kept beside the program, not in it: a commit that changes no code leaves the program's bytes alone.
  const fs::path commit = installation.plugins / "build.json";
  Tree stamp = is_there(commit) ? read_json(commit) : Tree::map();
  for (const char* key : {"commit", "dirty"}) {
    const Tree* value = stamp.find(key);
    out.at(key) = value != nullptr ? *value : Tree{};
  }
  out.at("build") = Tree::quote(build_hash(host, plugins));
  out.at("compiler") = Tree::quote(PALPATE_COMPILER);
  out.at("instruction_path") = Tree::quote(instruction_path);
  out.at("build_stamp") = Tree::quote(PALPATE_BUILD_STAMP);
  out.at("libraries") = libraries();
  out.at("plugins") = describe_plugins(host, plugins);
  out.at("host") = Tree::quote(host_name());
  return out;
}

}  // namespace palpate
