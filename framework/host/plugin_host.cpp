// SPDX-License-Identifier: MIT
#include "host/plugin_host.hpp"

#include "config/describe.hpp"
#include "config/tree.hpp"
#include "host/builtin.hpp"
#include "host/loaded_hash.hpp"
#include "host/plugin_calls.hpp"
#include "reading/read_file.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/backend.hpp>
#include <palpate/belief.hpp>
#include <palpate/fitting.hpp>
#include <palpate/footprint.hpp>
#include <palpate/kernel.hpp>
#include <palpate/shape.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <set>
#include <sstream>

#include <boost/algorithm/string/split.hpp>
#include <boost/dll/shared_library.hpp>

#include <link.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void refuse(const fs::path& file, const std::string& step, const std::string& reason,
                         const std::string& hint = {}) {
  throw Error("", fmt::format("{}: {}: {}", file.string(), step, reason), hint);
}

/// Extracts the text of dlerror from a message of Boost, which has the form "<function> failed (dlerror system message:
/// <text>): <unrelated errno text>".
std::string dlerror_part(const std::string& what) {
  const std::string mark = "dlerror system message: ";
  const auto begin = what.find(mark);
  if (begin == std::string::npos) return what;
  const auto end = what.rfind("):");
  const auto from = begin + mark.size();
  return what.substr(from, end == std::string::npos || end < from ? std::string::npos : end - from);
}

/// Splits a text at each `separator`.
std::vector<std::string> parts_of(const std::string& text, char separator) {
  std::vector<std::string> out;
  return boost::split(out, text, [separator](char c) { return c == separator; });
}

/// Returns for example "built with ..., the program with ...", with the first part in which the build stamps `theirs`
/// and `ours` differ.
std::string stamp_difference(const std::string& theirs, const std::string& ours) {
  const std::vector<std::string> other = parts_of(theirs, ';');
  const std::vector<std::string> own = parts_of(ours, ';');
  const auto [there, here] = std::mismatch(other.begin(), other.end(), own.begin(), own.end());
  return fmt::format("built with {}, the program with {}", there != other.end() ? *there : "",
                     here != own.end() ? *here : "");
}

std::string read_library(const fs::path& file) {
  FileReading reading = read_bounded(file, kMostLibraryBytes, FileOrigin::user);
  if (!reading)
    refuse(file, "opening", reading.reason ? reading.reason.message() : words_of(reading, kMostLibraryBytes).reason);
  return std::move(reading.text);
}

/// Throws Error for an incomplete library. dlopen maps the segments listed in the headers of a file; if the file ends
/// earlier, the process is killed (SIGBUS). dlopen itself reports other faults of the headers.
void check_complete(const fs::path& file, const std::string& bytes) {
  const auto size = std::uint64_t{bytes.size()};
  const auto holds = [size](std::uint64_t offset, std::uint64_t count) {
    return offset <= size && count <= size - offset;
  };
  const auto incomplete = [&] {
    refuse(file, "reading the header", "not a complete shared library", "build or copy it again");
  };

  ElfW(Ehdr) header{};
  const auto known = std::min<std::uint64_t>(size, sizeof header);
  std::memcpy(&header, bytes.data(), known);
  if (std::memcmp(header.e_ident, ELFMAG, std::min<std::uint64_t>(known, SELFMAG)) != 0)
    refuse(file, "reading the header", "not a shared library", "build it with palpate_add_plugin()");
  if (known < EI_NIDENT) incomplete();
  constexpr char kNativeClass = sizeof(void*) == 8 ? ELFCLASS64 : ELFCLASS32;
  if (header.e_ident[EI_CLASS] != kNativeClass) return;
  // Linkers write the section headers last, so a file that contains all section headers is complete.
  const bool sections = holds(header.e_shoff, std::uint64_t{header.e_shnum} * header.e_shentsize);
  if (known < sizeof header || !sections) incomplete();
  std::vector<ElfW(Phdr)> segments(header.e_phnum);
  if (!holds(header.e_phoff, segments.size() * sizeof(ElfW(Phdr)))) incomplete();
  std::memcpy(segments.data(), bytes.data() + header.e_phoff, segments.size() * sizeof(ElfW(Phdr)));
  for (const ElfW(Phdr) & segment : segments) {
    if (!holds(segment.p_offset, segment.p_filesz)) incomplete();
  }
}

const PluginManifest& check_manifest(const boost::dll::shared_library& library, const fs::path& file,
                                     const std::string& kind, const std::string& name) {
  if (!library.has("palpate_plugin"))
    refuse(file, "finding the symbol", "no symbol 'palpate_plugin'", "end the source with PALPATE_PLUGIN(...)");
  const auto& manifest = library.get<const PluginManifest>("palpate_plugin");
  if (std::memcmp(manifest.magic, "palpate", sizeof manifest.magic) != 0)
    refuse(file, "reading the manifest", "the symbol 'palpate_plugin' is not a plugin manifest");
  if (manifest.abi != kPluginAbi || manifest.size != sizeof(PluginManifest))
    refuse(file, "comparing the ABI", fmt::format("built for ABI {}, the program has {}", manifest.abi, kPluginAbi),
           "build it again with the headers of this program");
  if (std::string_view(manifest.stamp) != PALPATE_BUILD_STAMP)
    refuse(file, "comparing the build", stamp_difference(manifest.stamp, PALPATE_BUILD_STAMP),
           "build it with the same compiler flags (-march, -mavx and their like) as the program");
  if (kind != manifest.kind || name != manifest.name)
    refuse(file, "comparing the name",
           fmt::format("the library contains the plugin {}/{}", manifest.kind, manifest.name),
           "name folder and file like the plugin");
  return manifest;
}

/// Calls a function of a plugin, and converts exceptions to Error. The code of an exception from a plugin belongs to
/// its library, so the Error contains only copies of the texts. `options` may be null; an error about an option gets
/// the place of that option.
template <class Call>
void guarded(const Tree* options, const std::string& plugin, const char* failure, Call call) {
  const std::string place = options != nullptr ? options->place.text() : std::string();
  try {
    call();
  } catch (const Error& refusal) {
    const bool names_option = options != nullptr && !refusal.where().empty();
    if (const Tree* option = names_option ? options->find_path(refusal.where()) : nullptr)
      throw Error(option->place.file ? option->place.text() : place,
                  fmt::format("{}: {}: {}", plugin, refusal.where(), refusal.reason()), refusal.hint(), refusal.kind());
    // If the plugin gives a place, such as a file that it reads, this place is nearer to the cause than the config.
    if (!refusal.where().empty()) throw Error(refusal.where(), refusal.reason(), refusal.hint(), refusal.kind());
    throw Error(place, fmt::format("{}: {}", plugin, refusal.reason()), refusal.hint(), refusal.kind());
  } catch (const std::exception& trouble) {
    throw Error(place, fmt::format("{} {}: {}", plugin, failure, trouble.what()));
  } catch (...) {
    throw Error(place, fmt::format("{} {}: it threw an object that is not a std::exception", plugin, failure));
  }
}

/// Returns the manifest of a plugin that the program contains; null if it contains no plugin with this name.
const PluginManifest* builtin(const std::string& kind, const std::string& name) {
  for (const PluginManifest& one : builtin_plugins()) {
    if (one.kind == kind && one.name == name) return &one;
  }
  return nullptr;
}

/// Returns the reason why a folder has no plugins; "" if it has some.
std::string trouble_of_folder(const fs::path& folder) {
  std::error_code none;
  if (!fs::exists(folder, none)) return "does not exist";
  if (!fs::is_directory(folder, none)) return "is a file";
  if (!plugins_of_build(folder).empty()) return "";
  const std::vector<std::string> all = PluginHost::kinds();
  const bool any = std::any_of(all.begin(), all.end(), [&](const std::string& kind) {
    const std::vector<fs::path> files = list_folder(folder / kind);
    return std::any_of(files.begin(), files.end(), [](const fs::path& file) { return file.extension() == ".so"; });
  });
  return any ? "" : "contains no plugin KIND/NAME.so";
}

}  // namespace

PluginNames plugins_of_build(const fs::path& folder) {
  PluginNames out;
  std::istringstream in(read_bounded(folder / "plugins.txt", kMostConfigBytes, FileOrigin::user).text);
  for (std::string line; std::getline(in, line);) {
    const auto slash = line.find('/');
    if (slash != std::string::npos) out.emplace(line.substr(0, slash), line.substr(slash + 1));
  }
  return out;
}

/// A loaded library, which is closed after the end of the last object that it created; or a plugin that the program
/// itself contains.
class PluginHost::Library {
 public:
  explicit Library(const PluginManifest& own) : manifest(&own) {}
  Library(const fs::path& from, const std::string& kind, const std::string& name) : file(from) {
    std::error_code trouble;
    if (!fs::exists(file, trouble)) refuse(file, "opening", "a link to a missing file");
    if (!fs::is_regular_file(file, trouble)) refuse(file, "opening", "not a regular file");
    const std::string bytes = read_library(file);
    check_complete(file, bytes);
    try {
      library.load(fs::absolute(file).string(), boost::dll::load_mode::rtld_now | boost::dll::load_mode::rtld_local);
    } catch (const std::exception& failure) {
      refuse(file, "loading", dlerror_part(failure.what()), "link the plugin with all libraries that it uses");
    }
    manifest = &check_manifest(library, file, kind, name);
    hash = hash_of_loaded(bytes);
  }

  fs::path file;
  std::string hash;
  boost::dll::shared_library library;
  const PluginManifest* manifest = nullptr;
};

PluginHost::PluginHost(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) {
    // A folder that is named twice counts once, so that its plugins are not ambiguous.
    const bool known = std::any_of(folders_.begin(), folders_.end(), [&](const fs::path& other) {
      std::error_code none;
      return fs::equivalent(folder, other, none);
    });
    if (!known) folders_.push_back(folder);
  }
}
PluginHost::~PluginHost() = default;

std::vector<fs::path> PluginHost::search_path(const fs::path& shipped) {
  std::vector<fs::path> out;
  if (const char* variable = std::getenv("PALPATE_PLUGIN_PATH")) {
    for (const std::string& folder : parts_of(variable, ':')) {
      if (!folder.empty()) out.emplace_back(folder);
    }
  }
  out.push_back(shipped);
  return out;
}

bool PluginHost::one_at_a_time(const PluginNames& plugins) const {
  return std::any_of(plugins.begin(), plugins.end(),
                     [this](const auto& one) { return library(one.first, one.second)->manifest->one_at_a_time; });
}

bool PluginHost::has(const std::string& kind, const std::string& name) const {
  std::error_code none;
  return builtin(kind, name) != nullptr || std::any_of(folders_.begin(), folders_.end(), [&](const fs::path& folder) {
           return fs::exists(folder / kind / (name + ".so"), none);
         });
}

std::vector<std::string> PluginHost::kinds() {
  return {Kernel::kKind, Acquisition::kKind, Fitting::kKind, Footprint::kKind,
          Belief::kKind, Backend::kKind,     Shape::kKind};
}

std::vector<std::pair<std::string, fs::path>> PluginHost::files(const std::string& kind) const {
  std::vector<std::pair<std::string, fs::path>> out;
  for (const fs::path& folder : folders_) {
    for (const fs::path& file : list_folder(folder / kind)) {
      if (file.extension() == ".so") out.emplace_back(file.stem().string(), file);
    }
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<std::string> PluginHost::names(const std::string& kind) const {
  std::set<std::string> out;
  for (const PluginManifest& one : builtin_plugins()) {
    if (one.kind == kind) out.insert(one.name);
  }
  for (const auto& [name, file] : files(kind)) out.insert(name);
  for (const fs::path& folder : folders_) {
    for (const auto& [of, name] : plugins_of_build(folder)) {
      if (of == kind) out.insert(name);
    }
  }
  return {out.begin(), out.end()};
}

std::shared_ptr<const PluginHost::Library> PluginHost::library(const std::string& kind, const std::string& name) const {
  const std::lock_guard lock(mutex_);
  auto& slot = libraries_[{kind, name}];
  if (slot) return slot;
  if (const PluginManifest* const own = builtin(kind, name)) return slot = std::make_shared<const Library>(*own);
  if (!is_name(name)) throw Error("", fmt::format("'{}' is not a valid name of a plugin", name), kNameHint);
  std::vector<fs::path> found;
  for (const fs::path& folder : folders_) {
    std::error_code none;
    fs::path file = folder / kind / (name + ".so");
    if (fs::exists(fs::symlink_status(file, none))) found.push_back(std::move(file));
  }
  if (found.empty()) {
    for (const fs::path& folder : folders_) {
      if (plugins_of_build(folder).count({kind, name}) != 0)
        throw Error("", fmt::format("plugin {}/{} is not built", kind, name),
                    fmt::format("build it with ./palpate, or with 'cmake --build {} --target palpate_{}_{}'",
                                (folder / ".." / "..").lexically_normal().string(), kind, name));
      const std::string trouble = trouble_of_folder(folder);
      if (!trouble.empty())
        throw Error("", fmt::format("no plugin {}/{}", kind, name),
                    fmt::format("the folder {} {}, see PALPATE_PLUGIN_PATH", folder.string(), trouble));
    }
    std::vector<std::string> known = group_names_ ? group_names_(kind) : std::vector<std::string>();
    for (const std::string& one : names(kind)) {
      if (std::find(known.begin(), known.end(), one) == known.end()) known.push_back(one);
    }
    std::sort(known.begin(), known.end());
    throw Error("", fmt::format("no plugin {}/{}", kind, name), suggestion(name, known));
  }
  if (found.size() > 1)
    throw Error("",
                fmt::format("plugin {}/{} exists twice: {} and {}", kind, name, found[0].string(), found[1].string()),
                "remove one, or build it under another name");
  slot = std::make_shared<const Library>(found.front(), kind, name);
  return slot;
}

void PluginHost::describe(const std::string& kind, const std::string& name, Fields& fields) const {
  const std::shared_ptr<const Library> holder = library(kind, name);
  guarded(nullptr, kind + "/" + name, "cannot list its options", [&] { holder->manifest->describe(fields); });
}

std::shared_ptr<void> PluginHost::create(const PluginChoice& choice, const Context& context) const {
  const std::shared_ptr<const Library> holder = library(choice.kind, choice.type);
  void* object = nullptr;
  guarded(choice.options.get(), choice.kind + "/" + choice.type, "cannot be created", [&] {
    fill(*choice.options, *this, choice.kind,
         [&](Fields& fields) { object = holder->manifest->create(fields, context); });
  });
  if (holder->file.empty()) return {object, holder->manifest->destroy};
  // The deleter holds the library, so that the library outlives the object.
  return wrap_plugin(choice.kind, choice.type, {object, [holder](void* gone) { holder->manifest->destroy(gone); }});
}

std::shared_ptr<const Motions> PluginHost::motions(const PluginChoice& choice, const Scene& scene) const {
  const std::shared_ptr<const Library> holder = library(choice.kind, choice.type);
  if (holder->manifest->motions == nullptr) return nullptr;
  Motions* made = nullptr;
  guarded(choice.options.get(), choice.kind + "/" + choice.type, "has no motions", [&] {
    fill(*choice.options, *this, choice.kind, [&](Fields& fields) { made = holder->manifest->motions(fields, scene); });
  });
  if (made == nullptr) return nullptr;
  // As in create(), the deleter holds the library, so that the library outlives the object.
  return wrap_plugin(choice.kind + "/" + choice.type,
                     std::shared_ptr<Motions>(made, [holder](const Motions* gone) { delete gone; }));
}

std::string PluginHost::look(const std::string& kind, const std::string& name) const {
  std::string summary = library(kind, name)->manifest->summary;
  describe_fields([&](Fields& fields) { describe(kind, name, fields); });
  libraries_.clear();  // closing a broken library may crash, too
  return summary;
}

std::vector<LoadedPlugin> PluginHost::loaded(const PluginNames& plugins) const {
  std::vector<LoadedPlugin> out;
  for (const auto& [kind, name] : plugins) {
    const std::shared_ptr<const Library> holder = library(kind, name);
    if (!holder->file.empty()) out.push_back({kind, name, holder->file, holder->hash});
  }
  return out;
}

}  // namespace palpate
