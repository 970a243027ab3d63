// SPDX-License-Identifier: MIT
// Bad configs as people write them, sent through the program: one line on stderr with place, reason and remedy, exit
// status 2, and nothing left behind.
#include "system/shell.hpp"

#include <gtest/gtest.h>

#include <ostream>
#include <utility>
#include <vector>

namespace palpate {
namespace {

/// Nine good lines; what a case adds begins at line 10.
const std::string kGood =
    "name: bad\n"
    "defaults:\n"
    "  - kernel: rbf\n"
    "  - acquisition: weighted\n"
    "  - fitting: fixed\n"
    "  - backend: simulator\n"
    "  - scene: object_i\n"
    "taps: 5\n"
    "candidates: {count: 8}\n";

struct Case {
  const char* name;
  std::string config;  ///< of bad.yaml
  Words words;         ///< the command line behind `palpate`
  std::string message;
  std::vector<std::pair<std::string, std::string>> files = {};  ///< beside bad.yaml: name and text
};

void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

// Messages are told from the place on: behind "bad.yaml:", and of what is typed behind "command line: ".

Case whole(const char* name, const std::string& config, const std::string& message) {
  return {name, config, {"run", "bad.yaml"}, "bad.yaml:" + message};
}

Case line(const char* name, const std::string& added, const std::string& message) {
  return whole(name, kGood + added + "\n", message);
}

Case typed(const char* name, const Words& overrides, const std::string& message) {
  return {name, kGood, Words{"run", "bad.yaml"} + overrides, "command line: " + message};
}

Case sweep(const char* name, const std::string& added, const Words& axes, const std::string& message) {
  return {name, kGood + added, Words{"sweep", "bad.yaml"} + axes, message};
}

Case group(const char* name, const std::string& file, const std::string& text, const std::string& message) {
  return {name, kGood, {"run", "bad.yaml"}, message, {{file, text}}};
}

/// kGood without the line that begins with `beginning`.
std::string without(const std::string& beginning) {
  std::string text = kGood;
  const auto at = text.find(beginning);
  return text.erase(at, text.find('\n', at) + 1 - at);
}

const char* const kRangeHint =
    ", write range(0,10), range(0,10,2) or logspace(1cm,5cm,8), both ends with the same unit";

std::vector<Case> cases() {
  return {
      // Names
      line("TypoInAKey", "sed: 1", "10:1: unknown option 'sed', did you mean 'seed'?"),
      line("TypoInANestedKey", "initial: {desing: grid}", "10:11: unknown option 'desing', did you mean 'design'?"),
      line("UnknownTopLevelKey", "colour: red",
           "10:1: unknown option 'colour', known: complete, name, seed, taps, initial, candidates, kernel, fitting, "
           "acquisition, choice, belief, backend, motion, scene, stop, log, defaults, strategy, sweep, "
           "tune, compare, expect"),
      line("DottedKeyInAFile", "belief.label.clip: yes",
           "10:1: unknown option 'belief.label.clip', write belief: {label: {clip: yes}}"),
      whole("DottedKeyWhereItsGroupIsNeeded", without("  - backend") + "backend.type: simulator\n",
            "9:1: unknown option 'backend.type', write backend: {type: simulator}"),
      group("TypoInAGroupFile", "configs/kernel/rbf.yaml", "kernel:\n  type: rbf\n  length_scal: 1.7 cm\n",
            "configs/kernel/rbf.yaml:3:3: unknown option 'length_scal', did you mean 'length_scale'?"),
      typed("TypoInAnOverride", {"kernel.length_scal=2cm"},
            "unknown option 'length_scal', did you mean 'length_scale'?"),
      whole("TypoInAGroupThatIsNeeded", without("  - backend") + "backnd: {type: simulator}\n",
            "9:1: unknown option 'backnd', did you mean 'backend'?"),
      typed("OptionThatTheGroupsFileHasToo", {"motion=per_tap", "motion.speed=6cm/s"},
            "unknown option 'speed' of motion, known: type, of"),
      line("OptionThatTheGroupsFileHadForAnotherType",
           "motion: {type: per_tap, of: [{type: paper}, {type: paper}], pause: 1 s}",
           "10:61: unknown option 'pause' of motion, known: type, of"),
      line("OptionOfAnotherPlugin", "acquisition: {type: weighted, count: 4}",
           "10:31: unknown option 'count' of acquisition/weighted, known: type"),

      // Quantities
      line("MissingUnit", "kernel: {length_scale: 0.017}",
           "10:24: kernel.length_scale: '0.017' has no unit, write a length like '1.7 cm'"),
      line("UnitWhereNoneBelongs", "belief: {label: {noise: 1 mm}}",
           "10:25: belief.label.noise: '1 mm' is not a plain number, write it without a unit"),
      line("NegativeLength", "kernel: {length_scale: -1.7 cm}",
           "10:24: kernel.length_scale: -1.7 cm is out of range, it must be above 0 m"),
      line("NegativeSeed", "seed: -1", "10:7: seed: -1 is out of range, it must be at least 0"),

      // Shapes
      line("KeyWithoutValue", "seed:", "10:1: seed: has no value, write a plain number"),
      whole("EmptyFile", "", " no kernel is chosen, write kernel: {type: ...} or name a group under 'defaults'"),

      // YAML
      line("DuplicateKey", "taps: 6", "10:1: duplicate key 'taps', it is already at line 8, column 1"),
      line("BadSyntax", "initial: {design: random",
           "11:1: not valid YAML: end of map flow not found, look here or above for a missing bracket or quote, a "
           "wrong indent or a tab"),

      // Overrides
      typed("CommentInAnOverride", {"name=a #b"},
            "name: '#b' is a comment, put the value in its own quotes: KEY='\"a #b\"'"),
      typed("KeyGivenTwice", {"taps=6", "seed=2", "taps=7"}, "taps is given twice, leave one of them out"),
      sweep("KeySweptTwice", "", {"taps=6", "seed=2", "taps=7"},
            "command line: taps is given twice, leave one of them out"),
      typed("MotionThatIsNotThere", {"motion=per_tip"}, "no file motion/per_tip.yaml, did you mean 'per_tap'?"),
      {"MotionOfABackendWithoutOne",
       without("  - backend") + "backend: caller\n",
       {"run", "bad.yaml", "motion=gentle"},
       "command line: backend/caller has no motion, remove 'motion'"},
      {"OptionOfAMotionOfABackendWithoutOne",
       without("  - backend") + "backend: caller\nmotion: {type: paper}\n",
       {"run", "bad.yaml", "motion.step=1cm"},
       "command line: backend/caller has no motion, remove 'motion'"},
      line("ListOfOneMotion", "motion: {type: per_tap, of: [{type: paper}]}",
           "10:29: motion.of: must name at least two motions to choose from"),
      line("MotionWithinTheBackend", "backend: {motion: {speed: 1 cm/s}}",
           "10:11: unknown option 'motion' of backend, write motion: {...} beside backend, not inside it"),

      // Files, groups and plugins
      line("MeshThatIsNotThere", "scene: {objects: [{type: mesh, file: /nowhere.stl, unit: 1 mm}]}",
           "10:38: scene.objects.0.file: /nowhere.stl: no such file"),
      line("ViewThatIsNotThere", "belief: {prior: {depth: /nowhere.ply}}",
           "10:25: belief.prior.depth: /nowhere.ply: no such file, a relative path starts in the current folder"),
      {"MissingFile", kGood, {"run", "bat.yaml"}, "bat.yaml: no such file, did you mean 'bad.yaml'?"},
      {"DirectoryInsteadOfAFile",
       kGood,
       {"run", "configs"},
       "configs: not a regular file, name a YAML file",
       {{"configs/x", ""}}},
      whole("MissingGroupFile", without("  - scene") + "scene: object_j\n",
            "9:8: no file scene/object_j.yaml, did you mean 'object_i'?"),
      line("PluginNameWithAPath", "kernel: {type: ../kernel/rbf}",
           "10:16: '../kernel/rbf' is not a valid name of a plugin, a name has letters, digits, '_' and '-', and no "
           "path"),
      line("UnknownPlugin", "kernel: {type: matern53}", "10:16: no plugin kernel/matern53, did you mean 'matern52'?"),
      typed("UnknownPluginOnTheCommandLine", {"kernel=periodic"},
            "no plugin kernel/periodic, known: matern12, matern32, matern52, product, rational_quadratic, rbf, scale, "
            "sum, swell_and_texture"),
      typed("TypoInTheNameOfAGroup", {"acquisition=footprint_then_heigh"},
            "no plugin acquisition/footprint_then_heigh, did you mean 'footprint_then_height'?"),
      whole("NoBackend", without("  - backend"),
            "1:1: no backend is chosen, write backend: {type: ...} or name a group under 'defaults'"),
      line("PluginWithoutType", "belief: {height: {kernel: }}",
           "10:19: no kernel is chosen, write kernel: {type: ...} or name a group under 'defaults'"),
      whole("NoScene", without("  - scene"),
            "1:1: 'scene.area' is missing, set it: rectangle of the desk in which taps are allowed"),
      line("ObjectWithoutType", "scene: {objects: [{height: 5 cm}]}",
           "10:19: 'scene.objects.0.type' is missing, set it: shape of the object"),

      // Laws between options
      whole("BothCountAndSpacing", without("candidates") + "candidates: {count: 8, spacing: 5 mm}\n",
            "9:33: candidates.spacing: is given together with count, set one of them to none"),
      whole("TooFineASpacing", without("candidates") + "candidates: {spacing: 1 um}\n",
            "9:23: candidates.spacing: cuts the area into more than 2000 cells along a side, use larger cells"),
      line("FewerTapsThanInitialOnes", "initial: {count: 6}",
           "8:7: taps: the budget is smaller than the 6 initial taps, raise it or lower initial.count"),
      whole("MoreInitialTapsThanCandidates", without("candidates") + "candidates: {count: 1}\ninitial: {count: 2}\n",
            "10:18: initial.count: 2 taps, but there are only 1 candidates, use fewer initial taps or more candidates"),
      line("ASearchOfSomeTaps", "initial: {design: search, count: 3}",
           "10:27: unknown option 'count' of initial, known: design, smallest"),
      line("ASearchForWhatIsTooLarge", "initial: {design: search, smallest: 23 cm}",
           "10:37: initial.smallest: is not smaller than the sides of the area, give the least width of the object"),
      line("ASearchForNothing", "initial: {design: search, smallest: 0 cm}",
           "10:37: initial.smallest: 0 cm is out of range, it must be above 0 m"),
      line("WaveBelowTheDesk", "scene: {objects: [{type: wave, height: 1 cm, amplitude: 2 cm}]}",
           "10:57: scene.objects.0.amplitude: is larger than the mean height, so the top would be below the desk"),
      line("ObjectTooBigForRandomPlacement", "scene: {placement: random, objects: [{type: wave, length: 50 cm}]}",
           "10:38: scene.objects.0: does not fit into the area, make the object smaller or the area larger"),
      line("HoverBelowTheObject", "motion: {hover: 5 cm}",
           "10:17: backend/simulator: motion.hover: an object is 11 cm high, but the arm travels at 5 cm, raise "
           "motion.hover or lower the object"),

      line("LabelsOfTheirOwnKernelThatShare", "belief: {label: {hyperparameters: shared, kernel: {type: rbf}}}",
           "10:51: belief.label.kernel: has no effect with belief.label.hyperparameters: shared, remove it or set "
           "belief.label.hyperparameters: own"),
      line("LabelsOfTheirOwnFittingThatShare", "belief: {label: {hyperparameters: shared, fitting: {type: fixed}}}",
           "10:52: belief.label.fitting: has no effect with belief.label.hyperparameters: shared, remove it or set "
           "belief.label.hyperparameters: own"),

      // Plugins inside plugins, and how the surface is made
      line("TypoInAKernelOfAProduct",
           "kernel: {type: product, kernels: [{type: scale, kernel: {type: rbf, lenght_scale: 2 cm}}]}",
           "10:69: unknown option 'lenght_scale', did you mean 'length_scale'?"),
      line("FactorOfZero", "kernel: {type: scale, factor: 0, kernel: {type: rbf}}",
           "10:31: kernel.factor: 0 is out of range, it must be at least 1e-12"),
      line("AlphaOutOfRange", "kernel: {type: rational_quadratic, alpha: 1e-5}",
           "10:43: kernel.alpha: 1e-5 is out of range, it must be at least 0.0001"),

      line("GridPosteriorWithANonSeparableKernel", "belief: {engine: {type: grid}}\nkernel: {type: matern32}",
           "10:25: belief/height_map: engine.type: grid cannot be used with the kernel matern32: the kernel is not a "
           "product of a "
           "factor "
           "along "
           "x and a factor along y, engine: {type: dense} serves every kernel"),
      line("LowrankPosteriorWithASum",
           "belief: {engine: {type: lowrank}, height: {kernel: {type: sum, kernels: [{type: rbf}]}}}",
           "10:25: belief/height_map: engine.type: lowrank cannot be used with the kernel sum: the kernel is not a "
           "product of a "
           "factor "
           "along x "
           "and a factor along y, engine: {type: dense} serves every kernel"),
      line("NoThreads", "belief: {engine: {threads: 0}}",
           "10:28: belief.engine.threads: 0 is out of range, it must be at least 1"),
      line("LowrankThatKeepsNothing", "belief: {engine: {tolerance: 0}}",
           "10:30: belief.engine.tolerance: 0 is out of range, it must be above 0"),

      // The command line
      typed("OverrideWithABadValue", {"seed=none"}, "seed: 'none' is not a number, write a plain number"),
      typed("GroupNameWithAPathOnTheCommandLine", {"kernel=../rbf"},
            "'../rbf' is not a valid name in the group kernel, a name has letters, digits, '_' and '-', and no path"),

      typed("NameThatIsNotUtf8SoThatNoRecordCouldHoldIt", {"name=a\xff"}, "not UTF-8, write it in UTF-8"),
      typed("ManyNamesOfAGroup", {"acquisition=weighted,random"},
            "acquisition has several values, but a run takes one, run all of them with 'palpate sweep'"),
      typed("ManyValues", {"belief.engine.type=dense,grid"},
            "belief.engine.type has several values, but a run takes one, run all of them with 'palpate sweep'"),

      // Sweeps
      sweep("BadSweepRange", "sweep:\n  grid:\n    seed: range(0)\n", {},
            std::string("bad.yaml:12:11: seed: 'range(0)' is not understood") + kRangeHint),
      sweep("SweepOfMixedUnits", "", {"kernel.length_scale=logspace(1cm,5mm,8)"},
            std::string("command line: kernel.length_scale: 'logspace(1cm,5mm,8)' is not understood") + kRangeHint),
      sweep("SweepOfAnUnknownKey", "sweep:\n  grid:\n    kernel.length_scal: [1 cm, 2 cm]\n", {},
            "bad.yaml:12:26: unknown option 'length_scal', did you mean 'length_scale'?"),
      sweep("SweepWithABadValue", "sweep:\n  grid:\n    seed: [1, -2]\n", {},
            "bad.yaml:12:15: seed: -2 is out of range, it must be at least 0"),
      sweep("NothingToSweep", "", {}, "bad.yaml: nothing to sweep, give KEY=V1,V2 or a 'sweep:' in the config"),
      sweep("SweepOfOneValueTwice", "", {"seed=1,1"},
            "bad.yaml: jobs 0 and 1 of the sweep are the same run, a value occurs twice: write it once"),
  };
}

class BadConfig : public Shell, public testing::WithParamInterface<Case> {};

TEST_P(BadConfig, IsRefusedInOneLineAndLeavesNothing) {
  const Case& bad = GetParam();
  write("bad.yaml", bad.config);
  for (const auto& [name, text] : bad.files) write(name, text);
  EXPECT_EQ(refused(bad.words), bad.message + "\n");
  EXPECT_TRUE(left_nothing());
}

INSTANTIATE_TEST_SUITE_P(All, BadConfig, testing::ValuesIn(cases()),
                         [](const auto& one) { return std::string(one.param.name); });

using GoodConfig = Shell;

TEST_F(GoodConfig, OfTheseTestsRunsAndAmongBadOnesIsToldToBeValid) {
  write("good.yaml", kGood);
  ran({}, "good.yaml");
  write("one.yaml", kGood + "sed: 1\n");
  write("two.yaml", kGood + "seed: -1\n");
  const Ended ended = palpate("validate one.yaml good.yaml two.yaml");
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.err,
            "one.yaml:10:1: unknown option 'sed', did you mean 'seed'?\ntwo.yaml:10:7: seed: -1 is out of range, it "
            "must be at least 0\n");
  EXPECT_THAT(ended.out, StartsWith("good.yaml: valid, id "));
}

}  // namespace
}  // namespace palpate
