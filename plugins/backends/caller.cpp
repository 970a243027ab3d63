// SPDX-License-Identifier: MIT
// No arm: whoever runs the experiment makes the taps and tells what came of them, as Experiment of the Python module
// does. Of the scene only the area and the desk count.
#include <palpate/backend.hpp>
#include <palpate/error.hpp>
#include <palpate/plugin.hpp>

namespace palpate::backends {

class Caller final : public Backend {
 public:
  using Options = NoOptions;
  Caller(const Options&, const Context&) {}

  /// Nobody asks: see CallersRun.
  Contact tap(const TapRequest&) override {
    throw Error("", "makes no taps: the caller does", "ask and tell from Python", Error::Kind::run);
  }
  /// What is at the caller's end, nobody knows.
  bool repeatable() const override { return false; }
  bool scene_is_truth() const override { return false; }
};

PALPATE_PLUGIN(Backend, Caller, "caller",
               "taps that a program of one's own makes, which asks where and tells what came of it")

}  // namespace palpate::backends
