// SPDX-License-Identifier: MIT
#include "unit/compose_fixture.hpp"

#include <fmt/format.h>

#include <unistd.h>

namespace palpate::test {
namespace {

/// Files in a folder of their own, and what composing them gives.
class Compose : public test::ComposeFixture {
 protected:
  Compose() {
    folder_.write("scene/desk.yaml", "scene:\n  desk: 0 cm\n  objects: [{type: wave, height: 9 cm}, {type: slope}]\n");
    folder_.write("scene/table.yaml", "scene:\n  desk: 70 cm\n");
  }
};

TEST_F(Compose, ReadsTheGroupsThatDefaultsNameAndLeavesNoTraceOfDefaults) {
  const std::string text = "defaults:\n  - kernel: rbf\n  - scene: desk\n";
  EXPECT_EQ(value(text, "kernel.length_scale"), "1.7 cm");
  EXPECT_EQ(value(text, "scene.desk"), "0 cm");
  EXPECT_EQ(value(text, "defaults"), "-");
}

TEST_F(Compose, TakesTheProgramsOwnConfigOnlyWhereThereIsNoneOfThatName) {
  const TemporaryFolder program;
  program.write("configs/paper/one.yaml", "seed: 7\n");
  program.write("configs/two.yaml", "seed: 8\n");
  Composer composer(program.path() / "configs", config_keys());
  const auto seed = [&](const fs::path& file) { return composer.compose(file, {}).find("seed")->text; };
  const fs::path before = fs::current_path();
  folder_.write("configs/two.yaml", "seed: 1\n");
  fs::current_path(folder_.path());
  EXPECT_EQ(seed("configs/paper/one.yaml"), "7");
  EXPECT_EQ(seed("configs/two.yaml"), "1");
  for (const char* missing : {"configs/three.yaml", "paper/one.yaml"})
    EXPECT_THAT(error_of([&] { seed(missing); }), testing::StartsWith(std::string(missing) + ": no such file"));
  EXPECT_EQ(composer.found("configs/three.yaml"), "configs/three.yaml");
  fs::current_path(before);
}

TEST_F(Compose, LetsLaterDefaultsWin) {
  EXPECT_EQ(value("defaults:\n  - scene: desk\n  - scene: table\n", "scene.desk"), "70 cm");
  EXPECT_EQ(value("defaults:\n  - scene: table\n  - scene: desk\n", "scene.desk"), "0 cm");
}

TEST_F(Compose, LetsTheFileWinOverItsDefaultsWhereverTheyStandAndTheCommandLineOverTheFile) {
  const std::string text = "kernel: {length_scale: 3 cm}\ndefaults:\n  - kernel: rbf\n";
  EXPECT_EQ(value(text, "kernel.length_scale"), "3 cm");
  EXPECT_EQ(value(text, "kernel.length_scale", {"kernel.length_scale=4cm"}), "4cm");
  EXPECT_EQ(value("seed: 1\n", "seed", {"seed=2", "seed=3"}), "3") << "the last override wins";
}

TEST_F(Compose, GivesEveryValueThePlaceThatItCameFrom) {
  const Tree tree = compose("defaults:\n  - kernel: rbf\nseed: 1\n", {"taps=5"});
  const std::string folder = folder_.path().string();
  EXPECT_EQ(tree.find_path("kernel.length_scale")->place.text(), folder + "/kernel/rbf.yaml:3:17");
  EXPECT_EQ(tree.find_path("seed")->place.text(), folder + "/c.yaml:3:7");
  EXPECT_EQ(tree.find_path("taps")->place.text(), "command line");
}

TEST_F(Compose, BlamesTheCommandLineForAKeyThatItAdds) {
  const Tree tree = compose("defaults:\n  - kernel: rbf\n", {"kernel.length_scal=2cm"});
  EXPECT_EQ(tree.find("kernel")->entries.back().key, "length_scal");
  EXPECT_EQ(tree.find("kernel")->entries.back().place.text(), "command line");
}

TEST_F(Compose, ReplacesTheGroupThatAnOverrideNamesButKeepsWhatTheFileSays) {
  const std::string text = "defaults:\n  - kernel: rbf\nkernel: {type: rbf, length_scale: 3 cm}\n";
  EXPECT_EQ(value(text, "kernel.type", {"kernel=rough"}), "matern");
  EXPECT_EQ(value(text, "kernel.length_scale", {"kernel=rough"}), "3 cm");
  EXPECT_EQ(value(text, "kernel.nu", {"kernel=rough"}), "1.5");
}

TEST_F(Compose, LeavesNothingOfTheGroupThatAnOverrideReplaces) {
  EXPECT_EQ(value("defaults:\n  - kernel: rough\n", "kernel.nu", {"kernel=rbf"}), "-");
}

TEST_F(Compose, MarksTheChosenTypeAsTheOverridesWord) {
  const Tree tree = compose("defaults:\n  - kernel: rough\nkernel: {nu: 2.5}\n", {"kernel=rbf"});
  EXPECT_EQ(tree.find_path("kernel.type")->layer, kCommandLineLayer);
  EXPECT_EQ(tree.find_path("kernel.type")->place.text(), "command line");
  EXPECT_LT(tree.find_path("kernel.nu")->layer, kCommandLineLayer) << "older than the type, so it may be dropped";
}

TEST_F(Compose, TakesANameForAGroupAndOneWithoutFileForThePluginItself) {
  EXPECT_EQ(value("kernel: rough\n", "kernel.length_scale"), "2.5 cm");
  EXPECT_EQ(value("kernel: spline\n", "kernel.type"), "spline");
}

TEST_F(Compose, LaysAMapOverAGroup) {
  const Tree tree = compose("kernel: rough\n", {"kernel={length_scale: 9 cm}"});
  EXPECT_EQ(tree.find_path("kernel.nu")->text, "1.5");
  EXPECT_EQ(tree.find_path("kernel.length_scale")->text, "9 cm");
}

TEST_F(Compose, LetsAnOverrideReachAnItemOfAList) {
  const std::string text = "defaults:\n  - scene: desk\n";
  EXPECT_EQ(value(text, "scene.objects.0.height", {"scene.objects.0.height=5cm"}), "5cm");
  EXPECT_EQ(value(text, "scene.objects.1.type", {"scene.objects.0.height=5cm"}), "slope");
}

/// A kernel made of kernels, in a list.
constexpr const char* kNested =
    "kernel:\n  type: sum\n  kernels:\n    - {type: scale, factor: 2, kernel: {type: spline, length_scale: 5 cm}}\n"
    "    - {type: rbf}\n";

TEST_F(Compose, LetsAnOverrideReachAPluginInsideAnother) {
  const char* const path = "kernel.kernels.0.kernel.length_scale";
  EXPECT_EQ(value(kNested, path, {"kernel.kernels.0.kernel.length_scale=3cm"}), "3cm");
  EXPECT_EQ(value(kNested, "kernel.kernels.1.type", {"kernel.kernels.0.kernel.length_scale=3cm"}), "rbf");
  folder_.write("kernel/sum.yaml", kNested);
  EXPECT_EQ(value("kernel: sum\n", path, {"kernel.kernels.0.kernel.length_scale=3cm"}), "3cm");
  EXPECT_EQ(value("belief: {height: {kernel: sum}}\n", std::string("belief.height.") + path,
                  {"belief.height.kernel.kernels.0.kernel.length_scale=3cm"}),
            "3cm");
}

TEST_F(Compose, LetsAnOverrideNameTheGroupOfAPluginInsideAnother) {
  // By the rule for groups everywhere: what the file says stays, what a group said does not.
  const char* const path = "kernel.kernels.0.kernel";
  const Tree tree = compose(kNested, {"kernel.kernels.0.kernel=rough"});
  EXPECT_EQ(tree.find_path(path)->find("type")->text, "matern");
  EXPECT_EQ(tree.find_path(path)->find("type")->layer, kCommandLineLayer);
  EXPECT_EQ(tree.find_path(path)->find("length_scale")->text, "5 cm");
  EXPECT_EQ(tree.find_path(path)->find("nu")->text, "1.5");
  EXPECT_EQ(tree.find_path("kernel.kernels.0.factor")->text, "2");
  folder_.write("kernel/sum.yaml", kNested);
  EXPECT_EQ(value("kernel: sum\n", "kernel.kernels.0.kernel.type", {"kernel.kernels.0.kernel=rough"}), "matern");
  EXPECT_EQ(value("kernel: sum\n", "kernel.kernels.0.kernel.length_scale", {"kernel.kernels.0.kernel=rough"}),
            "2.5 cm");
  EXPECT_EQ(
      value(kNested, "kernel.kernels.0.kernel.type", {"kernel.kernels.0.kernel=rough", "kernel.kernels.0.kernel=rbf"}),
      "rbf")
      << "the last one wins";
}

TEST_F(Compose, RefusesAnItemBeyondTheEndOfAList) {
  EXPECT_EQ(refusal(kNested, {"kernel.kernels.2.length_scale=3cm"}),
            "command line: 'kernel.kernels.2.length_scale': the list has no item '2', its items are 0 to 1");
  EXPECT_EQ(refusal(kNested, {"kernel.kernels.-1.length_scale=3cm"}),
            "command line: 'kernel.kernels.-1.length_scale': the list has no item '-1', its items are 0 to 1");
  EXPECT_EQ(refusal(kNested, {"kernel.kernels.5.kernel=rough"}),
            "command line: 'kernel.kernels.5.kernel': the list has no item '5', its items are 0 to 1");
  EXPECT_EQ(refusal("kernel: {type: sum, kernels: []}\n", {"kernel.kernels.0.length_scale=3cm"}),
            "command line: 'kernel.kernels.0.length_scale': the list has no item '0', it is empty");
}

TEST_F(Compose, BuildsAGroupOnAnotherOfItsKindTwiceToo) {
  folder_.write("kernel/twice.yaml", "defaults:\n  - kernel: rbf\n  - kernel: rbf\n");
  EXPECT_EQ(value("kernel: twice\n", "kernel.type"), "rbf");
  folder_.write("kernel/wide.yaml", "defaults:\n  - kernel: rough\nkernel:\n  length_scale: 5 cm\n");
  EXPECT_EQ(value("kernel: wide\n", "kernel.length_scale"), "5 cm");
  EXPECT_EQ(value("kernel: wide\n", "kernel.nu"), "1.5");
}

TEST_F(Compose, CountsHowDeepAGroupIsThoughPartsOfItWereReadBefore) {
  const int deepest = 20;
  for (int i = 1; i < deepest; ++i)
    folder_.write(fmt::format("kernel/k{}.yaml", i), fmt::format("defaults:\n  - kernel: k{}\n", i + 1));
  folder_.write(fmt::format("kernel/k{}.yaml", deepest), "kernel: {type: rbf}\n");
  const auto deep = [&](Composer& composer, int from) {
    const fs::path file = folder_.write(fmt::format("c{}.yaml", from), fmt::format("kernel: k{}\n", from));
    return error_of([&] { composer.compose(file, {}); });
  };
  Composer composer(folder_.path(), config_keys());
  EXPECT_EQ(deep(composer, 10), "accepted");
  EXPECT_THAT(deep(composer, 1), testing::HasSubstr("groups are nested more than 16 levels deep"));
  Composer another(folder_.path(), config_keys());
  EXPECT_THAT(deep(another, 1), testing::HasSubstr("groups are nested more than 16 levels deep"));
}

TEST_F(Compose, FallsBackToTheShippedGroups) {
  const TemporaryFolder elsewhere;
  const auto file = elsewhere.write("c.yaml", "kernel: rough\n");
  EXPECT_EQ(Composer(folder_.path(), config_keys()).compose(file, {}).find_path("kernel.nu")->text, "1.5");
}

TEST_F(Compose, LetsAProcessInheritWhatItDoesNotSayOfTheSharedKernel) {
  const std::string text = "defaults:\n  - kernel: rough\nbelief:\n  height: {kernel: {length_scale: 4 cm}}\n";
  EXPECT_EQ(value(text, "belief.height.kernel.type"), "matern");
  EXPECT_EQ(value(text, "belief.height.kernel.nu"), "1.5");
  EXPECT_EQ(value(text, "belief.height.kernel.length_scale"), "4 cm");
  EXPECT_EQ(value(text, "kernel.length_scale"), "2.5 cm");
  EXPECT_EQ(value(text, "belief.height.kernel.length_scale", {"kernel.length_scale=9cm"}), "4 cm")
      << "it keeps its word";
  EXPECT_EQ(value(text, "belief.height.kernel.nu", {"kernel.nu=2.5"}), "2.5");
}

TEST_F(Compose, ReadsAGroupForOneProcessAndGivesItNoKernelOfItsOwnUnasked) {
  EXPECT_EQ(value("defaults:\n  - kernel: rbf\nbelief: {height: {signal: 1 m}}\n", "belief.height.kernel"), "-");
  EXPECT_EQ(value("defaults:\n  - kernel: rbf\nbelief: {label: {kernel: rough}}\n", "belief.label.kernel.type"),
            "matern");
  EXPECT_EQ(value("defaults:\n  - kernel: rbf\n", "belief.label.kernel.nu", {"belief.label.kernel=rough"}), "1.5");
}

TEST_F(Compose, LeavesTheNamesOfASweepAlone) {
  EXPECT_EQ(value("sweep:\n  grid:\n    kernel: rbf\n", "sweep.grid.kernel"), "rbf");
}

TEST_F(Compose, RefusesANameWithAPathInIt) {
  for (const char* name : {"../rbf", "a/b", "rbf.yaml", "/etc/passwd", "''"}) {
    const std::string plain = std::string(name) == "''" ? "" : name;
    EXPECT_EQ(refusal(std::string("defaults:\n  - kernel: ") + name + "\n"),
              "c.yaml:2:13: '" + plain +
                  "' is not a valid name in the group kernel, a name has letters, digits, '_' and '-', and no path");
  }
}

TEST_F(Compose, RefusesWhatIsNoConfigOrNamesNoGroupWithItsPlace) {
  const std::pair<const char*, const char*> cases[] = {
      {"defaults:\n  - kernl: rbf\n", "c.yaml:2:5: unknown group 'kernl', did you mean 'kernel'?"},
      {"defaults:\n  - engine: dense\n",
       "c.yaml:2:5: unknown group 'engine', known: kernel, fitting, acquisition, backend, motion, scene, "
       "scene.effects, belief.footprint, strategy, expect"},
      {"defaults:\n  - scene: desc\n", "c.yaml:2:12: no file scene/desc.yaml, did you mean 'desk'?"},
      {"defaults: {kernel: rbf}\n", "c.yaml:1:11: defaults: expects a list, write '- kernel: rbf', one group per line"},
      {"defaults:\n  - rbf\n", "c.yaml:2:5: defaults: expects '- group: name', for example '- kernel: rbf'"},
      {"defaults:\n  - kernel: [rbf]\n", "c.yaml:2:5: defaults: expects '- group: name', for example '- kernel: rbf'"},
      {"seed: 1\ndefualts:\n  - kernel: rbf\n", "c.yaml:2:1: unknown option 'defualts', did you mean 'defaults'?"},
      {"[1, 2]\n", "c.yaml:1:1: a config is a map, write key: value"},
      {"text\n", "c.yaml:1:1: a config is a map, write key: value"}};
  for (const auto& [text, message] : cases) EXPECT_EQ(refusal(text), message) << text;
  EXPECT_EQ(
      refusal("defaults:\n  - kernel: rbf\n", {"kernel.length_scale.x=1"}),
      "command line: 'kernel.length_scale.x': there is no 'x' below a value, the path ends at 'kernel.length_scale'");
}

TEST_F(Compose, RefusesAGroupFileThatHoldsSomethingElseOrLeadsBackToItself) {
  folder_.write("kernel/b.yaml", "defaults:\n  - kernel: odd\n");
  const std::pair<const char*, const char*> cases[] = {
      {"kernel:\n  type: rbf\nseed: 3\n", "3:1: unknown key 'seed', a file in kernel/ holds only 'kernel:'"},
      {"kernel: rbf\n", "1:1: 'kernel' is not a group of options, write key: value below it"},
      {"defaults:\n  - scene: desk\n", "2:12: a kernel may build only on another kernel, write '- kernel: name'"}};
  for (const auto& [text, message] : cases) {
    folder_.write("kernel/odd.yaml", text);
    EXPECT_EQ(refusal("kernel: odd\n"), std::string("kernel/odd.yaml:") + message);
  }
  folder_.write("kernel/odd.yaml", "defaults:\n  - kernel: b\n");
  EXPECT_EQ(refusal("kernel: odd\n"),
            "kernel/b.yaml:2:13: defaults form a cycle, kernel/odd -> kernel/b -> kernel/odd");
}

TEST(ComposeFile, RefusesAnEmptyName) {
  EXPECT_EQ(error_of([] { Composer("", config_keys()).compose("", {}); }),
            "command line: the name of the config is empty, name a YAML file");
}

std::string refused_override(const std::string& text) {
  return error_of([&] { parse_override(text); });
}

TEST(OverrideText, IsSplitAtItsFirstEqualsSign) {
  const Override one = parse_override("name=a=b");
  EXPECT_EQ(one.path, "name");
  EXPECT_EQ(one.value.text, "a=b");
  EXPECT_EQ(one.value.layer, kCommandLineLayer);
}

TEST(OverrideText, IsRefusedWithoutKeyOrEqualsSign) {
  EXPECT_EQ(refused_override("seed"), "command line: 'seed' is not KEY=VALUE, for example kernel.length_scale=2cm");
  EXPECT_EQ(refused_override("=3"), "command line: '=3' is not KEY=VALUE, for example kernel.length_scale=2cm");
  EXPECT_EQ(refused_override(""), "command line: '' is not KEY=VALUE, for example kernel.length_scale=2cm");
}

TEST(OverrideText, IsRefusedWithAnEmptyPartOfItsPath) {
  for (const char* path : {".a", "a.", "a..b"}) {
    EXPECT_EQ(refused_override(std::string(path) + "=1"),
              std::string("command line: '") + path + "' is not a dotted path, write it like kernel.length_scale");
  }
}

/// Folders in which a group of one name lies, and what a config somewhere among them takes.
class GroupFolders : public InFolder {
 protected:
  void kernel(const std::string& folder) {
    folder_.write(folder + "/kernel/mine.yaml", "kernel: {type: rbf, name: " + folder + "}\n");
  }
  void rights(const std::string& folder, unsigned mode) {
    fs::permissions(folder_.path() / folder, static_cast<fs::perms>(mode));
  }
  /// Which folder the config's kernel comes from; what is said if it is refused.
  std::string from(const std::string& config) {
    const fs::path file = folder_.write(config, "kernel: mine\n");
    Composer composer(folder_.path() / "shipped", config_keys());
    std::string folder = "none";
    const std::string error = error_of([&] {
      const Tree tree = composer.compose(file, {});
      const Tree* name = tree.find_path("kernel.name");
      EXPECT_EQ(composer.groups().size(), name == nullptr ? 0U : 1U);
      if (name != nullptr) folder = name->text;
    });
    return error == "accepted" ? folder : error;
  }
};

TEST_F(GroupFolders, AreTheConfigsOwnThenTheNearestNamedConfigsThenTheShippedOnes) {
  kernel("shipped");
  EXPECT_EQ(from("a/configs/b/c/x.yaml"), "shipped");
  kernel("a/configs");
  EXPECT_EQ(from("a/configs/b/c/x.yaml"), "a/configs");
  kernel("a/configs/b/c");
  EXPECT_EQ(from("a/configs/b/c/x.yaml"), "a/configs/b/c");
}

/// Somebody whom rights of files bind, as long as it lives: root is not.
class Anybody {
 public:
  Anybody() : was_(::geteuid()) { EXPECT_EQ(::seteuid(was_ == 0 ? 65534 : was_), 0); }
  ~Anybody() { EXPECT_EQ(::seteuid(was_), 0); }

 private:
  uid_t was_;
};

TEST_F(GroupFolders, ThatMayNotBeSearchedAreNotTakenForEmptyOnes) {
  kernel("shipped");
  kernel("a");
  rights(".", 0755);
  const fs::path config = folder_.write("a/x.yaml", "kernel: mine\n");
  rights("a/kernel", 0600);
  std::string said = "nothing";
  {
    const Anybody anybody;
    if (::euidaccess(config.c_str(), R_OK) != 0) {
      GTEST_SKIP() << "nobody else may enter the folder for temporary files";
    }
    said = error_of([&] { Composer(folder_.path() / "shipped", config_keys()).compose(config, {}); });
  }
  EXPECT_THAT(said, ::testing::EndsWith("a/kernel/mine.yaml: cannot be accessed, check the permissions of its folder"));
  rights("a/kernel", 0755);
  EXPECT_EQ(from("a/x.yaml"), "a");
}

TEST_F(GroupFolders, AreNotAnyOthersAboveTheConfig) {
  kernel(".");
  kernel("a");
  kernel("configs/a/b");
  kernel("configs");
  EXPECT_EQ(from("a/b/x.yaml"), "none");
  EXPECT_EQ(from("configs/a/c/configs/x.yaml"), "configs");
  kernel("shipped");
  EXPECT_EQ(from("configs/a/c/configs/d/x.yaml"), "shipped") << "only the nearest";
}

TEST_F(GroupFolders, ThatAllUsersShareArePassedOverAndNamed) {
  kernel("all");
  rights("all", 01777);
  EXPECT_EQ(from("all/x.yaml"),
            (folder_.path() / "all/x.yaml:1:9: ").string() + (folder_.path() / "all/kernel/mine.yaml").string() +
                " is in a folder where other users can write, move the config and its groups to a folder of your own");
  kernel("shipped");
  EXPECT_EQ(from("all/x.yaml"), "shipped");
  rights("all", 0777);
  EXPECT_EQ(from("all/x.yaml"), "all") << "there the config itself may be another's, as on some mounted disks";
}

}  // namespace
}  // namespace palpate::test
