// SPDX-License-Identifier: MIT
#include "plugin/host.hpp"

#include "config/hash.hpp"
#include "config/tree.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/backend.hpp>
#include <palpate/fitting.hpp>
#include <palpate/kernel.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <boost/dll/library_info.hpp>
#include <boost/dll/shared_library.hpp>

namespace palpate {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& file, const std::string& step, const std::string& reason,
                         const std::string& hint = {}) {
  throw Error("", fmt::format("{}: {}: {}", file.string(), step, reason), hint);
}

/// Boost words its failures as "<function> failed (dlerror system message: <text>): <unrelated errno text>".
std::string dlerror_part(const std::string& what) {
  const std::string mark = "dlerror system message: ";
  const auto begin = what.find(mark);
  if (begin == std::string::npos) return what;
  const auto end = what.rfind("):");
  const auto from = begin + mark.size();
  return what.substr(from, end == std::string::npos || end < from ? std::string::npos : end - from);
}

/// "what is 32 here and 16 in the program" for the first part of the stamps that differs.
std::string stamp_difference(std::string_view theirs, std::string_view ours) {
  const auto part = [](std::string_view& stamp) {
    const auto end = std::min(stamp.find(';'), stamp.size());
    const std::string_view head = stamp.substr(0, end);
    stamp.remove_prefix(std::min(end + 1, stamp.size()));
    return head;
  };
  while (!ours.empty() || !theirs.empty()) {
    const std::string_view mine = part(ours);
    const std::string_view other = part(theirs);
    if (mine != other) return fmt::format("built with {}, the program with {}", other, mine);
  }
  return {};
}

/// A truncated library kills the process inside dlopen (SIGBUS), so its section table is read first.
void check_sections(const fs::path& file) {
  try {
    boost::dll::library_info info(file.string());
    if (info.sections().empty()) refuse(file, "reading sections", "not a shared library");
  } catch (const Error&) {
    throw;
  } catch (const std::exception&) {
    refuse(file, "reading sections", "not a complete shared library", "build or copy it again");
  }
}

const PluginManifest& check_manifest(const boost::dll::shared_library& library, const fs::path& file,
                                     const std::string& kind, const std::string& name) {
  if (!library.has("palpate_plugin")) {
    refuse(file, "finding the symbol", "no symbol 'palpate_plugin'", "end the source with PALPATE_PLUGIN(...)");
  }
  const auto& manifest = library.get<const PluginManifest>("palpate_plugin");
  if (std::memcmp(manifest.magic, "palpate", sizeof manifest.magic) != 0) {
    refuse(file, "reading the manifest", "the symbol 'palpate_plugin' is not a plugin manifest");
  }
  if (manifest.abi != kPluginAbi || manifest.size != sizeof(PluginManifest)) {
    refuse(file, "comparing the ABI", fmt::format("built for ABI {}, the program has {}", manifest.abi, kPluginAbi),
           "build it again with the headers of this program");
  }
  if (std::string_view(manifest.stamp) != PALPATE_BUILD_STAMP) {
    refuse(file, "comparing the build", stamp_difference(manifest.stamp, PALPATE_BUILD_STAMP),
           "build it with the same compiler flags (-march, -mavx and their like) as the program");
  }
  if (kind != manifest.kind || name != manifest.name) {
    refuse(file, "comparing the name", fmt::format("the library says it is {}/{}", manifest.kind, manifest.name),
           "folder and file must be named like the plugin");
  }
  return manifest;
}

/// A plugin has refused its options: tells where in the config they, or the one that it names, were written.
[[noreturn]] void refuse_options(const Error& refusal, const PluginChoice& choice) {
  const Tree* option = choice.options->find(refusal.where());
  if (option == nullptr && !refusal.where().empty()) {
    throw Error(refusal.where(), refusal.reason(), refusal.hint(), refusal.kind());
  }
  const std::string who = option != nullptr ? choice.kind + "." + refusal.where() : choice.kind + "/" + choice.type;
  const Place place = option != nullptr && option->place.file ? option->place : choice.options->place;
  const std::string where = place.text();
  if (where.empty()) throw Error(who, refusal.reason(), refusal.hint(), refusal.kind());
  throw Error(where, who + ": " + refusal.reason(), refusal.hint(), refusal.kind());
}

}  // namespace

/// One loaded library. Closed when the last object made by it is gone.
class PluginHost::Library {
 public:
  Library(const fs::path& file, const std::string& kind, const std::string& name) : file_(file) {
    std::error_code trouble;
    if (!fs::is_regular_file(file, trouble)) refuse(file, "opening", "not a regular file");
    check_sections(file);
    try {
      library_.load(fs::absolute(file).string(), boost::dll::load_mode::rtld_now | boost::dll::load_mode::rtld_local);
    } catch (const std::exception& failure) {
      refuse(file, "loading", dlerror_part(failure.what()));
    }
    manifest_ = &check_manifest(library_, file, kind, name);
    hash_ = hash_of_file(file);
  }

  const PluginManifest& manifest() const { return *manifest_; }
  const fs::path& file() const { return file_; }
  const std::string& hash() const { return hash_; }

 private:
  fs::path file_;
  std::string hash_;
  boost::dll::shared_library library_;
  const PluginManifest* manifest_ = nullptr;
};

PluginHost::PluginHost(std::vector<fs::path> folders) : folders_(std::move(folders)) {}
PluginHost::~PluginHost() = default;

std::vector<fs::path> PluginHost::search_path(const fs::path& shipped) {
  std::vector<fs::path> out;
  if (const char* variable = std::getenv("PALPATE_PLUGIN_PATH")) {
    const std::string text = variable;
    for (std::size_t begin = 0; begin <= text.size();) {
      const auto end = std::min(text.find(':', begin), text.size());
      if (end > begin) out.emplace_back(text.substr(begin, end - begin));
      begin = end + 1;
    }
  }
  out.push_back(shipped);
  return out;
}

std::vector<std::string> PluginHost::kinds() {
  return {Kernel::kKind, Acquisition::kKind, Fitting::kKind, Backend::kKind};
}

std::vector<std::pair<std::string, fs::path>> PluginHost::files(const std::string& kind) const {
  std::vector<std::pair<std::string, fs::path>> out;
  for (const fs::path& folder : folders_) {
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder / kind, none)) {
      if (entry.path().extension() == ".so") out.emplace_back(entry.path().stem().string(), entry.path());
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::shared_ptr<const PluginHost::Library> PluginHost::library(const std::string& kind, const std::string& name) const {
  const std::lock_guard lock(mutex_);
  auto& slot = libraries_[{kind, name}];
  if (slot) return slot;
  const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '_' || c == '-';
  });
  if (!plain) {
    throw Error("", fmt::format("'{}' is not the name of a plugin", name),
                "a name has letters, digits, '_' and '-', and no path");
  }
  std::vector<fs::path> found;
  for (const fs::path& folder : folders_) {
    std::error_code none;
    fs::path file = folder / kind / (name + ".so");
    if (fs::exists(fs::symlink_status(file, none))) found.push_back(std::move(file));
  }
  if (found.empty()) {
    std::vector<std::string> names;
    for (const auto& [other, file] : files(kind)) names.push_back(other);
    throw Error("", fmt::format("no plugin {}/{}", kind, name), suggestion(name, names));
  }
  if (found.size() > 1) {
    throw Error("", fmt::format("plugin {}/{} is there twice: {} and {}", kind, name, found[0].string(), found[1].string()),
                "remove or rename one");
  }
  slot = std::make_shared<const Library>(found.front(), kind, name);
  return slot;
}

void PluginHost::describe(const std::string& kind, const std::string& name, Fields& fields) const {
  library(kind, name)->manifest().describe(fields);
}

std::shared_ptr<void> PluginHost::create(const PluginChoice& choice, const Context& context) const {
  const std::shared_ptr<const Library> holder = library(choice.kind, choice.type);
  const PluginManifest& manifest = holder->manifest();
  const std::string who = choice.kind + "/" + choice.type;
  void* object = nullptr;
  // An exception thrown by a plugin has its code in the plugin: only copies of its text may leave.
  try {
    fill(*choice.options, *this, choice.kind, [&](Fields& fields) { object = manifest.create(fields, context); });
  } catch (const Error& refusal) {
    refuse_options(refusal, choice);
  } catch (const std::exception& failure) {
    throw Error(who, fmt::format("cannot be created: {}", failure.what()));
  } catch (...) {
    throw Error(who, "cannot be created: it threw something that is no exception");
  }
  // The deleter owns the library, which therefore outlives the object.
  return {object, [holder](void* gone) { holder->manifest().destroy(gone); }};
}

std::vector<PluginListing> PluginHost::list(const std::string& kind, const std::string& name) const {
  std::vector<PluginListing> out;
  for (const std::string& one : kinds()) {
    if (!kind.empty() && one != kind) continue;
    for (const auto& [stem, file] : files(one)) {
      if (!name.empty() && stem != name) continue;
      PluginListing row{one, stem, file, {}, {}};
      try {
        row.summary = library(one, stem)->manifest().summary;
      } catch (const Error& trouble) {
        row.trouble = trouble.what();
      }
      out.push_back(std::move(row));
    }
  }
  return out;
}

std::vector<LoadedPlugin> PluginHost::loaded() const {
  const std::lock_guard lock(mutex_);
  std::vector<LoadedPlugin> out;
  for (const auto& [key, holder] : libraries_) {
    if (holder) out.push_back({key.first, key.second, holder->file(), holder->hash()});
  }
  return out;
}

}  // namespace palpate
