// SPDX-License-Identifier: MIT
// Backend without an arm: the caller's program makes the taps and reports the results, for example through Experiment
// of the Python module. The run uses the area and the desk of the scene; it uses the objects only if `scene_is_truth`
// is set. Run::tell() reads the options.
#include <palpate/backend.hpp>
#include <palpate/error.hpp>
#include <palpate/plugin.hpp>

#include <string>

namespace palpate::backends {

/// The defaults equal those of tapping::MotionOptions.
struct CallerOptions : Options {
  double hover = 0.135;
  double overrun = 0.03;
  bool scene_is_truth = false;
  std::string label;

  void list(Fields& fields) override {
    fields.real(hover, Field("hover", "travel height of the caller's arm above the desk. Higher contacts are rejected")
                           .in(Unit::metre)
                           .above(0)
                           .from("as motion.hover of the other backends"));
    fields.real(
        overrun,
        Field("overrun",
              "maximum depth of the caller's arm below the desk. Contacts more than 1 cm below this depth are rejected")
            .in(Unit::metre)
            .at_least(0)
            .from("as motion.overrun of the other backends"));
    fields.flag(scene_is_truth, Field("scene_is_truth",
                                      "whether the caller taps the objects of `scene`, as in a simulation. If true, "
                                      "errors are computed for each tap")
                                    .neutral(false));
    fields.text(
        label,
        Field("label", "name of the caller's strategy. Runs with different names have different ids").neutral(""));
  }
};

class CallerBackend final : public Backend {
 public:
  using Options = CallerOptions;
  CallerBackend(const Options& options, const Context&) : scene_is_truth_(options.scene_is_truth) {}

  /// Never called in a run by a caller, see Run::tell().
  TapResult tap(const TapRequest&) override {
    throw Error("", "makes no taps: the caller's program does", "use ask() and tell() in Python", Error::Kind::run);
  }
  /// The scene of the caller is unknown, so taps count as not repeatable.
  bool repeatable() const override { return false; }
  bool scene_is_truth() const override { return scene_is_truth_; }
  bool taps_any_line() const override { return true; }

 private:
  bool scene_is_truth_;
};

PALPATE_PLUGIN(Backend, CallerBackend, "caller",
               "taps by your own program. The program asks for positions and reports the results")

}  // namespace palpate::backends
