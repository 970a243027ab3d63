// SPDX-License-Identifier: MIT
// What a shell offers while one types a command, asked of the program and of the shells themselves.
#include "record/json.hpp"
#include "support/terminal.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

namespace palpate {
namespace {

using test::Terminal;
using testing::Contains;
using testing::IsSupersetOf;
using testing::Key;
using testing::Pair;
using testing::UnorderedElementsAre;

class Completion : public Shell {
 protected:
  Completion() { fs::create_directory_symlink(test::source_folder() / "configs", here() / "configs"); }

  /// Words with their meanings.
  std::map<std::string, std::string> offered(const Words& words) const {
    const Ended ended = palpate(Words{"--complete"} + words);
    EXPECT_EQ(ended.status, 0);
    EXPECT_EQ(ended.err, "");
    std::map<std::string, std::string> out;
    for (const std::string& line : lines_of(ended.out)) {
      out.emplace(line.substr(0, line.find('\t')), line.substr(line.find('\t') + 1));
    }
    return out;
  }
  /// To an override of the paper's config, behind `before`.
  std::map<std::string, std::string> keys(const std::string& typed, const Words& before = {}) const {
    return offered(Words{"run", "configs/paper/object_i.yaml"} + before + Words{typed});
  }
  static std::string script(const std::string& name) {
    return (test::source_folder() / "framework/cli/shells" / name).string();
  }
  /// So that shells find this program by its name.
  static std::string path() { return "PATH=" + test::program_file().parent_path().string() + ":/usr/bin:/bin"; }
};

TEST_F(Completion, OfCommandsAndOptionsSaysWhatTheyAreFor) {
  EXPECT_THAT(offered({"re"}), UnorderedElementsAre(Key("resume"), Key("replay"), Key("report"), Key("rerun")));
  EXPECT_THAT(offered({""}), Contains(Pair("run", "Run one experiment")));
  EXPECT_THAT(offered({"run", "--dry"}),
              Contains(Pair("--dry-run", "print the planned run, its directory and its models; nothing moves")));
  EXPECT_THAT(offered({"resume", "x", "--launcher", ""}), UnorderedElementsAre(Key("local"), Key("slurm")));
  EXPECT_THAT(offered({"resume", "x", "--launcher=s"}), UnorderedElementsAre(Key("--launcher=slurm")));
  EXPECT_THAT(offered({"nonsense", ""}), IsEmpty());
}

TEST_F(Completion, OfConfigsGoesFolderByFolderAndSaysWhatEachIsFor) {
  write("mine.yaml", "# Mine alone. And more.\nseed: 1\n");
  write("notes.txt", "");
  EXPECT_THAT(offered({"run", ""}), UnorderedElementsAre(Pair("configs/", ""), Pair("mine.yaml", "Mine alone")));
  EXPECT_THAT(offered({"validate", "mine.yaml", "configs/paper/object_ii"}),
              UnorderedElementsAre(Key("configs/paper/object_ii.yaml")));
}

TEST_F(Completion, OfAGroupHasItsConfigsAndItsPlugins) {
  write("kernel/wool.yaml", "# Rough as wool.\nkernel: {type: matern12}\n");
  write("mine.yaml", "strategy: weighted\n");
  EXPECT_THAT(offered({"run", "mine.yaml", "kernel="}), Contains(Pair("kernel=wool", "Rough as wool")));
  EXPECT_THAT(keys("kernel=m"),
              UnorderedElementsAre(Key("kernel=matern12"), Key("kernel=matern32"), Key("kernel=matern52")));
  EXPECT_THAT(keys("kernel=p"), UnorderedElementsAre(Key("kernel=product"))) << "a plugin without a config";
  EXPECT_THAT(keys("scene.effects="), IsSupersetOf({Key("scene.effects=none"), Key("scene.effects=standard")}));
}

TEST_F(Completion, OfTopLevelKeysLeavesNoneOutThatTheSchemaHas) {
  const Tree schema = read_json(write("schema.json", palpate("schema").out));
  const auto found = keys("");
  for (const Tree::Entry& entry : schema.find("properties")->entries) {
    // Those are lists and maps that no one types behind a command.
    if (is_one_of({"defaults", "sweep", "tune", "compare", "expect"}, entry.key)) continue;
    EXPECT_TRUE(found.count(entry.key + "=") + found.count(entry.key + ".") != 0) << entry.key;
  }
}

TEST_F(Completion, OfAPluginsOptionsIsThatOfThePluginThatIsChosen) {
  EXPECT_THAT(keys("kernel.length_scale="), UnorderedElementsAre(Key("kernel.length_scale=1.7cm")));
  EXPECT_THAT(keys("kernel.len")["kernel.length_scale="],
              AllOf(HasSubstr("distance over which"), HasSubstr("length > 0 m")));
  EXPECT_THAT(keys("kernel.al"), IsEmpty());
  EXPECT_THAT(keys("kernel.al", {"kernel=rational_quadratic"}), UnorderedElementsAre(Key("kernel.alpha=")));
  EXPECT_THAT(keys("belief.height.kernel.al", {"kernel=rational_quadratic"}),
              UnorderedElementsAre(Key("belief.height.kernel.alpha=")))
      << "what it does not say, the shared kernel says";
  EXPECT_THAT(keys("kernel.type=rb"), UnorderedElementsAre(Key("kernel.type=rbf")));
}

TEST_F(Completion, OfValuesHasChoicesFlagsAndTheItemsOfLists) {
  EXPECT_THAT(keys("belief.surface="),
              UnorderedElementsAre(Key("belief.surface=single"), Key("belief.surface=two_part")));
  EXPECT_THAT(keys("log.maps="), UnorderedElementsAre(Key("log.maps=true"), Key("log.maps=false")));
  EXPECT_THAT(keys("scene.objects."), UnorderedElementsAre(Key("scene.objects.0.")));
  EXPECT_THAT(keys("scene.objects.0.amp"), UnorderedElementsAre(Key("scene.objects.0.amplitude=")));
  EXPECT_THAT(keys("motion."), Contains(Key("motion.step=")));
  for (const char* before : {"", "["}) {
    const std::string axis = std::string("acquisition=") + before + "weighted,";
    EXPECT_THAT(offered({"sweep", "configs/paper/object_i.yaml", axis + "unc"}),
                UnorderedElementsAre(Key(axis + "uncertainty")));
  }
}

TEST_F(Completion, OfPluginsRunsAndColumns) {
  EXPECT_THAT(offered({"plugins", "ker"}), IsSupersetOf({Key("kernel"), Key("kernel/rbf")}));
  EXPECT_THAT(offered({"new", "f"}), UnorderedElementsAre(Key("fitting"), Key("footprint")));
  EXPECT_THAT(offered({"plugins", "kernel/rb"}), UnorderedElementsAre(Key("kernel/rbf")));
  const std::string run = ran("taps=3").lexically_relative(here()).string();
  write("runs/many/0123456789ab/manifest.jsonl", "");
  EXPECT_THAT(offered({"report", ""}),
              UnorderedElementsAre(Pair(run, "a run, ended"), Pair("runs/many/0123456789ab", "a sweep")));
  EXPECT_THAT(offered({"explain", ""}), UnorderedElementsAre(Key(run)));
  EXPECT_THAT(offered({"compare", ""}), UnorderedElementsAre(Key("runs/many/0123456789ab")));
  EXPECT_THAT(offered({"compare", "x", "--metric", "taps,footprint_i"}),
              UnorderedElementsAre(Key("taps,footprint_iou")));
}

TEST_F(Completion, IsSilentAboutWhatIsBroken) {
  write("mine.yaml", "kernel: {type: [\n");
  write("runs/x", "no folder");
  environment_ = {test::with_plugin("throws_in_list")};
  EXPECT_THAT(offered({"run", "mine.yaml", "see"}), UnorderedElementsAre(Key("seed=")));
  EXPECT_THAT(offered({"run", "missing.yaml", "kernel=rb"}), UnorderedElementsAre(Key("kernel=rbf")));
  EXPECT_THAT(keys("kernel.", {"kernel.type=nonsense"}), UnorderedElementsAre(Key("kernel.type=")));
  EXPECT_THAT(keys("seed.x=1"), IsEmpty());
  EXPECT_THAT(offered({"status", "runs/x/"}), IsEmpty());
  EXPECT_THAT(offered(Words{}), Not(IsEmpty()));
  EXPECT_THAT(offered({"export", "x", "--to", ""}), IsEmpty()) << "shells complete files";
}

TEST_F(Completion, OpensNoPluginButThoseWhoseOptionsAreAskedFor) {
  environment_ = {"LD_DEBUG=files"};
  const auto opened = [&](const Words& words) {
    std::vector<std::string> out;
    for (const std::string& line : lines_of(palpate(Words{"--complete"} + words).err)) {
      if (line.find("calling init: ") != std::string::npos && line.find("lib/palpate/") != std::string::npos) {
        out.push_back(fs::path(line).filename().string());
      }
    }
    return out;
  };
  EXPECT_THAT(opened({""}), IsEmpty());
  EXPECT_THAT(opened({"run", "configs/default.yaml", "kernel="}), IsEmpty());
  EXPECT_THAT(opened({"run", "configs/default.yaml", "kernel=rbf", "kernel."}), ElementsAre("rbf.so"));
}

TEST_F(Completion, InBashItselfEndsAWordAndLeavesAKeyOpen) {
  if (!fs::exists("/usr/bin/bash")) GTEST_SKIP() << "bash is not installed";
  write("rc", "PS1='ready> '\nbind 'set enable-bracketed-paste off'\nsource '" + script("palpate.bash") + "'\n");
  Terminal bash({"/usr/bin/bash", "--noprofile", "--rcfile", "rc", "-i"}, here(), {path(), "TERM=dumb", "COLUMNS=200"});
  ASSERT_TRUE(bash.shows("ready> "));
  bash.type("echo ok; palpate ru\tconfigs/paper/object_i.y\tkernel=matern5\tkernel.t\trb\t#");
  EXPECT_TRUE(bash.shows("palpate run configs/paper/object_i.yaml kernel=matern52 kernel.type=rbf #"));
  bash.type("\025palpate run configs/paper/object_i.yaml \"kernel=matern5\t#");
  EXPECT_TRUE(bash.shows("palpate run configs/paper/object_i.yaml \"kernel=matern52\" #"));
  bash.type("\025palpate export x --to r\t#");
  EXPECT_TRUE(bash.shows("palpate export x --to rc #")) << "files where the program knows nothing";
  bash.type("\025exit\n");
  EXPECT_EQ(bash.wait() & 1, 0) << bash.screen();
}

TEST_F(Completion, InZshItselfEndsAWordAndLeavesAKeyOpen) {
  if (!fs::exists("/usr/bin/zsh")) GTEST_SKIP() << "zsh is not installed";
  write(".zshrc", "PS1='ready> '\nunsetopt zle_bracketed_paste\nautoload -Uz compinit && compinit -u -D\nsource '" +
                      script("_palpate") + "'\n");
  Terminal zsh({"/usr/bin/zsh", "-d", "-i"}, here(),
               {path(), "TERM=dumb", "COLUMNS=200", "ZDOTDIR=" + here().string()});
  ASSERT_TRUE(zsh.shows("ready> "));
  zsh.type("palpate ru\tconfigs/paper/object_i.y\tkernel=matern5\tkernel.t\trb\t>seen\nfc -ln -1\nexit\n");
  zsh.wait();
  EXPECT_THAT(zsh.screen(), HasSubstr("configs/paper/object_i.yaml kernel=matern52 kernel.type=rbf >seen"));
}

TEST_F(Completion, InFishItselfHasWordsWithTheirMeaningAndElseFiles) {
  if (!fs::exists("/usr/bin/fish")) GTEST_SKIP() << "fish is not installed";
  const auto asked = [&](const std::string& line) {
    return test::run_program(
        {"/usr/bin/fish", "--no-config", "-c", "source '" + script("palpate.fish") + "'; complete -C '" + line + "'"},
        here(), {path(), "HOME=" + here().string()});
  };
  EXPECT_EQ(asked("palpate sta").out, "status\tShow the state of a run or sweep\n");
  EXPECT_THAT(asked("palpate run configs/default.yaml kernel=rb").out, StartsWith("kernel=rbf\tSquared exponential: "));
  EXPECT_THAT(asked("palpate export x --to con").out, StartsWith("configs"));
}

TEST_F(Completion, ScriptsAreCleanToShellcheck) {
  if (!fs::exists("/usr/bin/shellcheck")) GTEST_SKIP() << "shellcheck is not installed";
  const Ended ended = test::run_program({"/usr/bin/shellcheck", script("palpate.bash")}, here());
  EXPECT_EQ(ended.status, 0) << ended.out;
}

}  // namespace
}  // namespace palpate
