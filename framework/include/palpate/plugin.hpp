// SPDX-License-Identifier: MIT
// How a shared library becomes a plugin. An author writes a class, an options struct and one line:
//
//     PALPATE_PLUGIN(Kernel, Rbf, "rbf", "squared-exponential kernel")
//
// where Rbf implements one of the interfaces (Kernel, Acquisition, Fitting, Footprint, Backend, Shape), has a type
// `Options`, and is constructed as Rbf(options, context). The library is <kind>/<name>.so; palpate_add_plugin() of the
// CMake package names and places it.
#pragma once

#include <palpate/error.hpp>
#include <palpate/instructions.hpp>
#include <palpate/motions.hpp>
#include <palpate/options.hpp>
#include <palpate/random.hpp>
#include <palpate/scene.hpp>
#include <palpate/types.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>

namespace palpate {

/// Rises when anything that crosses the plugin boundary changes its meaning or its layout.
constexpr std::uint32_t kPluginAbi = 22;

struct Context;

/// Makes plugin objects from their resolved options; implemented by the plugin host.
class PluginFactory {
 public:
  virtual ~PluginFactory() = default;
  /// An object of the interface of `choice.kind`, as a pointer to that interface.
  virtual std::shared_ptr<void> create(const PluginChoice& choice, const Context& context) const = 0;
  /// The motions of a backend, null of one that has but one.
  virtual std::shared_ptr<const Motions> motions(const PluginChoice& /*choice*/, const Scene& /*scene*/) const {
    return nullptr;
  }
};

/// What a plugin is born with. Outlives the plugin.
struct Context {
  const PluginFactory& factory;
  const Scene& scene;                    ///< area, desk, and for simulators the objects
  std::uint64_t seed;                    ///< of the run; draw from it only through random()
  const std::atomic<bool>* interrupted;  ///< set when the user wants to stop: long motions watch it; may be null
  /// The folder of the run's record, for files that a plugin leaves beside it; empty where none is kept. It exists from
  /// the first tap on, not before.
  std::string directory = {};
  Instructions instructions = instructions_in_use();  ///< of the loops of palpate/math.hpp

  /// The stream of this run for one purpose, for example "acquisition/random" at tap `number`.
  Random random(const std::string& purpose, std::uint64_t number = 0) const { return {seed, purpose, number}; }

  /// The plugin that an option named (Fields::plugin). The pointer also keeps its library loaded, which is why it is
  /// shared: the deleter carries the library.
  template <class Interface>
  std::shared_ptr<Interface> create(const PluginChoice& choice) const {
    return std::static_pointer_cast<Interface>(factory.create(choice, *this));
  }
};

/// The table behind the exported symbol. The first four members never change their place: a host compares them before
/// it looks at anything else, so that a library of another age or of other compiler flags is refused, not run.
struct PluginManifest {
  char magic[8];       ///< "palpate"
  std::uint32_t abi;   ///< kPluginAbi
  std::uint32_t size;  ///< sizeof(PluginManifest)
  const char* stamp;   ///< PALPATE_BUILD_STAMP

  const char* kind;     ///< the folder of the library
  const char* name;     ///< its file name without .so
  const char* summary;  ///< one line, for `palpate plugins`
  bool one_at_a_time;   ///< what it moves exists once: runs that use it wait for each other (Backend::kOneAtATime)
  /// Lists the fields of a default options struct to `fields`.
  void (*describe)(Fields& fields);
  /// Fills an options struct from `fields` and makes the object: a pointer to the kind's interface.
  void* (*create)(Fields& fields, const Context& context);
  void (*destroy)(void* object);
  /// Makes the motions that these options leave open, null for one alone; itself null of a plugin that has no such
  /// thing.
  Motions* (*motions)(Fields& fields, const Scene& scene);
};

#define PALPATE_TEXT_(x) #x
#define PALPATE_TEXT(x) PALPATE_TEXT_(x)
#ifdef _GLIBCXX_DEBUG
#define PALPATE_DEBUG_CONTAINERS 1
#else
#define PALPATE_DEBUG_CONTAINERS 0
#endif

/// All that must be equal on both sides of the boundary. Eigen's alignment is here because it follows -march: a
/// library of another alignment frees memory that it did not allocate in the same way, and corrupts the heap.
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

/// Whether `Plugin` says kOneAtATime, which only backends have.
template <class Plugin, class = void>
struct OneAtATime : std::false_type {};
template <class Plugin>
struct OneAtATime<Plugin, std::enable_if_t<Plugin::kOneAtATime>> : std::true_type {};

/// The motions of a plugin that has a function of that name, which only backends have.
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

/// Fills the manifest of `Plugin`, which implements `Interface`.
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
