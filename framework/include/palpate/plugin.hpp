// SPDX-License-Identifier: MIT
// Interface between shared libraries and plugins. An author writes a class, an options struct and one line:
//
//     PALPATE_PLUGIN(Kernel, Rbf, "rbf", "squared-exponential kernel")
//
// where Rbf implements one of the interfaces (Kernel, Acquisition, Fitting, Footprint, Belief, Backend, Shape), has a
// type `Options`, and is constructed as Rbf(options, context). The library is <kind>/<name>.so; palpate_add_plugin() of
// the CMake package names and places it.
#pragma once

#include <palpate/error.hpp>
#include <palpate/instruction_sets.hpp>
#include <palpate/motions.hpp>
#include <palpate/options.hpp>
#include <palpate/phase_clock.hpp>
#include <palpate/random.hpp>
#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>

namespace palpate {

/// Version of the plugin interface, increased with every change of its meaning or its memory layout.
constexpr std::uint32_t kPluginAbi = 24;

struct Context;

/// Creates plugin objects from their resolved options. The plugin host implements it.
class PluginFactory {
 public:
  virtual ~PluginFactory() = default;
  /// Returns an object of the interface of `choice.kind`, as a pointer to this interface.
  virtual std::shared_ptr<void> create(const PluginChoice& choice, const Context& context) const = 0;
  /// Returns the motions of a backend; null for a backend with one motion.
  virtual std::shared_ptr<const Motions> motions(const PluginChoice& /*choice*/, const Scene& /*scene*/) const {
    return nullptr;
  }
};

/// Settings of the run that a belief needs in addition to its own options.
struct RunSettings {
  PluginChoice kernel{"kernel", {}, nullptr};         ///< kernel for a GP that sets none itself
  PluginChoice fitting{"fitting", "fixed", nullptr};  ///< fitting for a GP that sets none itself
  /// Number of candidates (for a grid, cells per side), or side length of a grid cell in metres (`spacing`). If both
  /// are absent, the belief uses its own default.
  std::optional<std::int64_t> candidates;
  std::optional<double> spacing;
  std::int64_t taps = 1;        ///< budget
  double tie_tolerance = 1e-8;  ///< relative tolerance of ties between scores
};

/// Data for the construction of a plugin. Outlives the plugin.
struct Context {
  const PluginFactory& factory;
  const Scene& scene;                    ///< area, desk, and for simulators the objects
  std::uint64_t seed;                    ///< seed of the run; use it only through random()
  const std::atomic<bool>* interrupted;  ///< set if the user interrupts: long motions check it; may be null
  /// Folder of the run's record, for files of a plugin; empty without a record. The folder exists from the first tap
  /// on.
  std::string directory = {};
  Instructions instructions = instructions_in_use();  ///< instruction set for the loops of palpate/math.hpp
  PhaseClock* clock = nullptr;                        ///< clock of the run, for fits and inference; may be null
  RunSettings run = {};                               ///< settings for beliefs
  bool from_above = true;                             ///< whether the belief taps straight down only, for backends

  /// Returns the run's random stream for one purpose, for example "acquisition/random" at tap `number`.
  Random random(const std::string& purpose, std::uint64_t number = 0) const { return {seed, purpose, number}; }

  /// Creates the plugin of an option (Fields::plugin). The shared pointer also keeps the plugin's library loaded, by
  /// its deleter.
  template <class Interface>
  std::shared_ptr<Interface> create(const PluginChoice& choice) const {
    return std::static_pointer_cast<Interface>(factory.create(choice, *this));
  }
};

/// Table that a plugin library exports. The first four members keep their position in all versions. A host compares
/// them before it reads other members, and rejects a library of another version or with other compiler flags.
struct PluginManifest {
  char magic[8];       ///< "palpate"
  std::uint32_t abi;   ///< kPluginAbi
  std::uint32_t size;  ///< sizeof(PluginManifest)
  const char* stamp;   ///< PALPATE_BUILD_STAMP

  const char* kind;     ///< folder of the library
  const char* name;     ///< file name without .so
  const char* summary;  ///< one line, for `palpate plugins`
  bool one_at_a_time;   ///< whether only one run at a time may use it (Backend::kOneAtATime)
  /// Lists the fields of an options struct with default values to `fields`.
  void (*describe)(Fields& fields);
  /// Reads an options struct from `fields` and creates the object. Returns a pointer to the kind's interface.
  void* (*create)(Fields& fields, const Context& context);
  void (*destroy)(void* object);
  /// Creates the motions that the options allow; returns null for one motion. The pointer is null for a plugin without
  /// a choice of motions.
  Motions* (*motions)(Fields& fields, const Scene& scene);
};

#define PALPATE_TEXT_(x) #x
#define PALPATE_TEXT(x) PALPATE_TEXT_(x)
#ifdef _GLIBCXX_DEBUG
#define PALPATE_DEBUG_CONTAINERS 1
#else
#define PALPATE_DEBUG_CONTAINERS 0
#endif

/// Properties of a build that host and plugin must share. They include Eigen's alignment, which depends on -march: with
/// different alignments, one side frees memory that the other allocated in another way, which corrupts the heap.
#define PALPATE_BUILD_STAMP \
  "Eigen=" PALPATE_TEXT(EIGEN_WORLD_VERSION) "." PALPATE_TEXT(EIGEN_MAJOR_VERSION) "." PALPATE_TEXT( \
      EIGEN_MINOR_VERSION) ";EIGEN_MAX_ALIGN_BYTES=" PALPATE_TEXT(EIGEN_MAX_ALIGN_BYTES)             \
      ";EIGEN_MAX_STATIC_ALIGN_BYTES=" PALPATE_TEXT(                                                 \
          EIGEN_MAX_STATIC_ALIGN_BYTES) ";_GLIBCXX_USE_CXX11_ABI=" PALPATE_TEXT(_GLIBCXX_USE_CXX11_ABI) \
          ";_GLIBCXX_DEBUG=" PALPATE_TEXT(PALPATE_DEBUG_CONTAINERS)

namespace detail {

template <class Plugin>
void describe(Fields& fields) {
  typename Plugin::Options options;
  options.list(fields);
}

template <class Plugin, class Interface>
void* create(Fields& fields, const Context& context) {
  typename Plugin::Options options;
  options.list(fields);
  use_instructions(context.instructions);
  return static_cast<Interface*>(new Plugin(options, context));
}

/// True if `Plugin` defines kOneAtATime, as only backends do, with the value true.
template <class Plugin, class = void>
struct OneAtATime : std::false_type {};
template <class Plugin>
struct OneAtATime<Plugin, std::enable_if_t<Plugin::kOneAtATime>> : std::true_type {};

/// Creates the motions of a plugin with a function motions(), which only backends have.
template <class Plugin>
Motions* motions(Fields& fields, const Scene& scene) {
  typename Plugin::Options options;
  options.list(fields);
  return Plugin::motions(options, scene).release();
}
using MakeMotions = Motions* (*)(Fields& fields, const Scene& scene);
template <class Plugin, class = void>
struct MotionsOf {
  static constexpr MakeMotions value = nullptr;
};
template <class Plugin>
struct MotionsOf<Plugin, std::void_t<decltype(&Plugin::motions)>> {
  static constexpr MakeMotions value = &motions<Plugin>;
};

template <class Interface>
void destroy(void* object) {
  delete static_cast<Interface*>(object);
}

}  // namespace detail

/// Returns the manifest of `Plugin`, which implements `Interface`.
template <class Interface, class Plugin>
constexpr PluginManifest manifest_of(const char* name, const char* summary) {
  return {{'p', 'a', 'l', 'p', 'a', 't', 'e', '\0'},
          kPluginAbi,
          sizeof(PluginManifest),
          PALPATE_BUILD_STAMP,
          Interface::kKind,
          name,
          summary,
          detail::OneAtATime<Plugin>::value,
          &detail::describe<Plugin>,
          &detail::create<Plugin, Interface>,
          &detail::destroy<Interface>,
          detail::MotionsOf<Plugin>::value};
}

}  // namespace palpate

/// Exports `Class`, which implements `Interface`, as the plugin of this library.
#define PALPATE_PLUGIN(Interface, Class, name, summary)                                             \
  extern "C" __attribute__((visibility("default"))) const ::palpate::PluginManifest palpate_plugin; \
  const ::palpate::PluginManifest palpate_plugin = ::palpate::manifest_of<Interface, Class>(name, summary);
