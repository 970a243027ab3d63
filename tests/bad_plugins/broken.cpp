// SPDX-License-Identifier: MIT
// A kernel library with one defect per build, selected in CMakeLists.txt. The kernel itself is correct.
#ifdef OTHER_ALIGNMENT
// Has the effect of -mavx512f on any machine and in any preset.
#define EIGEN_MAX_ALIGN_BYTES 128
#endif
#include <palpate/kernel.hpp>
#include <palpate/plugin.hpp>

#include <csignal>
#include <stdexcept>
#include <string>

#include <unistd.h>

namespace broken {

/// Undefined function: a library that calls it cannot be loaded.
double defined_nowhere();

/// Exception type whose code is in this library.
struct OwnException final : std::exception {
  const char* what() const noexcept override { return "an exception of its own"; }
};

#ifdef CRASHES_WHEN_LOADED
[[gnu::constructor]] void crash() { std::raise(SIGSEGV); }
#elif defined(HANGS_WHEN_LOADED)
[[gnu::constructor]] void hang() {
  while (::pause() != 0) {
  }
}
#elif defined(ENDS_WHEN_LOADED)
[[gnu::constructor]] void end() { ::_exit(0); }
#endif

struct NoOptions : palpate::Options {
  void list(palpate::Fields&) override {
#ifdef THROWS_IN_LIST
    throw OwnException();
#endif
  }
};

class Kernel final : public palpate::Kernel {
 public:
  using Options = NoOptions;

  Kernel(const Options&, const palpate::Context&) {
#if defined(THROWS_ERROR)
    throw palpate::Error("", "this kernel refuses its options", "choose another");
#elif defined(THROWS_ERROR_WITH_PLACE)
    throw palpate::Error("table.csv:7", "this kernel refuses its table");
#elif defined(THROWS_RUNTIME_ERROR)
    throw std::runtime_error("two\nlines");
#elif defined(THROWS_OWN_EXCEPTION)
    throw OwnException();
#elif defined(THROWS_NUMBER)
    throw 42;
#endif
  }

  void covariance(const palpate::PointsView&, const palpate::PointsView&, palpate::MatrixOut out) const override {
    out.setOnes();
#ifdef UNDEFINED_SYMBOL
    out(0, 0) = defined_nowhere();
#endif
  }
  void variance(const palpate::PointsView&, palpate::VectorOut out) const override { out.setOnes(); }
  std::vector<palpate::KernelParameter> parameters() const override { return {}; }
};

#if defined(NO_SYMBOL)
// Referenced so that the class is compiled in all builds.
std::string unused(const palpate::Context& context) { return Kernel({}, context).parameters().empty() ? "" : "x"; }
#elif defined(WRONG_MAGIC) || defined(OTHER_ABI)
constexpr palpate::PluginManifest changed() {
  palpate::PluginManifest manifest = palpate::manifest_of<palpate::Kernel, Kernel>(PLUGIN_NAME, "broken");
#ifdef WRONG_MAGIC
  manifest.magic[0] = 'P';
#else
  manifest.abi += 41;
  // Invalid content after another ABI number, which the host must not read.
  manifest.stamp = nullptr;
#endif
  return manifest;
}
extern "C" __attribute__((visibility("default"))) const palpate::PluginManifest palpate_plugin;
const palpate::PluginManifest palpate_plugin = changed();
#else
PALPATE_PLUGIN(palpate::Kernel, Kernel, PLUGIN_NAME, "broken on purpose")
#endif

}  // namespace broken
