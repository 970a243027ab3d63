// SPDX-License-Identifier: MIT
#include "record/build_info.hpp"

#include "config/hash.hpp"
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

Tree text(const std::string& value) { return Tree::scalar(value, true); }

Tree libraries() {
  Tree out = Tree::map();
  out.at("Eigen") = text(fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION));
  out.at("Boost") = text(BOOST_LIB_VERSION);
  out.at("fmt") = text(fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100));
  out.at("yaml-cpp") = text(PALPATE_YAML_CPP_VERSION);
  return out;
}

Tree describe_plugins(const PluginHost& host, const PluginNames& plugins) {
  Tree out = Tree::list();
  for (const LoadedPlugin& one : host.loaded(plugins)) {
    Tree row = Tree::map();
    row.at("kind") = text(one.kind);
    row.at("name") = text(one.name);
    row.at("file") = text(one.file.string());
    row.at("hash") = text(one.hash);
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
  out.at("version") = text(kVersion);
  // Kept beside the program, not in it: a commit that changes no code leaves the program's bytes alone.
  const fs::path commit = installation.plugins / "build.json";
  std::error_code none;
  Tree stamp = fs::exists(commit, none) ? read_json(commit) : Tree::map();
  for (const char* key : {"commit", "dirty"}) {
    const Tree* value = stamp.find(key);
    out.at(key) = value != nullptr ? *value : Tree{};
  }
  out.at("build") = text(build_hash(host, plugins));
  out.at("compiler") = text(PALPATE_COMPILER);
  out.at("instruction_path") = text(instruction_path);
  out.at("build_stamp") = text(PALPATE_BUILD_STAMP);
  out.at("libraries") = libraries();
  out.at("plugins") = describe_plugins(host, plugins);
  out.at("host") = text(host_name());
  return out;
}

}  // namespace palpate
