// SPDX-License-Identifier: MIT
// What the program says of itself: `--help` and the manual, which come from one list.
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

namespace palpate {
namespace {

/// The lines below `heading`, up to an empty one.
std::vector<std::string> below(const std::string& heading, const std::string& help) {
  std::vector<std::string> out;
  bool inside = false;
  for (const std::string& line : lines_of(help)) {
    if (inside && line.empty()) break;
    if (inside) out.push_back(line);
    if (line == heading) inside = true;
  }
  return out;
}

class HelpOf : public Shell {
 protected:
  /// Every command, and "" for the program itself.
  std::vector<std::string> commands() const {
    std::vector<std::string> out{""};
    for (const std::string& line : below("Commands:", palpate("--help").out)) {
      if (line[2] != ' ') out.push_back(Words(line).front());
    }
    return out;
  }
  std::string help(const std::string& command) const { return palpate(Words(command) + "--help").out; }
};

TEST_F(HelpOf, EveryCommandIsInPlainWords) {
  EXPECT_THAT(commands(), testing::IsSupersetOf({"run", "sweep", "schema", "export"}));
  for (const std::string& command : commands()) {
    const std::string text = help(command);
    for (const char* jargon :
         {"TEXT", "INT", "FLOAT", "[OPTIONS]", "REQUIRED", "Positionals", "SUBCOMMAND", "Excludes", "Needs:", ":{"}) {
      EXPECT_THAT(text, Not(HasSubstr(jargon))) << command;
    }
    for (const std::string& line : lines_of(text)) EXPECT_LE(line.size(), 105U) << command;
  }
  const auto flat = [&](const char* command) {
    std::string out;
    for (const std::string& word : Words(help(command))) out += word + " ";
    return out;
  };
  EXPECT_THAT(flat("resume"), AllOf(HasSubstr("local or slurm; default: local"), HasSubstr("1 to 1024")));
  EXPECT_THAT(flat("run"), AllOf(HasSubstr("not with --quiet"), HasSubstr("only with --print-config")));
}

TEST_F(HelpOf, EveryCommandHasTwoExamplesThatTheProgramItselfUnderstands) {
  fs::create_directory_symlink(test::source_folder() / "configs", here() / "configs");
  const std::string program = test::program_file().string();
  ASSERT_EQ(palpate("--needs run --nonsense").status, 2) << "what is not understood is told";
  for (const std::string& command : commands()) {
    const std::vector<std::string> examples = below("Examples:", help(command));
    EXPECT_GE(examples.size(), 2U) << command;
    for (const std::string& example : examples) {
      EXPECT_THAT(example, StartsWith("  palpate " + command));
      const std::string asks = "palpate() { : >called; '" + program + "' --needs \"$@\" || : >refused; }; ";
      const Ended ended = test::run_program({"/bin/sh", "-c", asks + example}, here());
      EXPECT_EQ(ended.err, "") << example;
      EXPECT_TRUE(fs::remove(here() / "called")) << example;
      EXPECT_FALSE(fs::remove(here() / "refused")) << example;
    }
  }
}

TEST_F(HelpOf, EachCommandIsNamedWhereOneOfItsOptionsIsUnknown) {
  for (const std::string& command : commands()) {
    const Ended ended = palpate(Words(command) + "--title");
    EXPECT_EQ(ended.status, 2) << command;
    EXPECT_THAT(ended.err, testing::EndsWith("see palpate " + (command.empty() ? "" : command + " ") + "--help\n"));
  }
}

TEST_F(HelpOf, TheProgramIsShownWhereNoCommandIsGiven) {
  const Ended ended = palpate(Words{});
  EXPECT_EQ(ended.status, 2);
  EXPECT_EQ(ended.out, "");
  EXPECT_EQ(ended.err, help(""));
}

using Manual = HelpOf;

TEST_F(Manual, HasAPageForEachCommandWithAllThatItsHelpSays) {
  ASSERT_EQ(palpate("--manual man1").status, 0);
  for (const std::string& command : commands()) {
    std::string page = text_of(here() / "man1" / ("palpate" + (command.empty() ? "" : "-" + command) + ".1"));
    page.erase(std::remove(page.begin(), page.end(), '\\'), page.end());
    for (const char* heading : {"Commands:", "Arguments:", "Options:", "With --launcher slurm:", "Examples:"}) {
      for (const std::string& line : below(heading, help(command))) {
        for (const std::string& word : Words(line)) EXPECT_THAT(page, HasSubstr(word)) << command;
      }
    }
  }
}

TEST_F(Manual, IsCleanToTheProgramsThatShowIt) {
  ASSERT_EQ(palpate("--manual man1").status, 0);
  const bool man = fs::exists("/usr/bin/man");
  const bool mandoc = fs::exists("/usr/bin/mandoc");
  if (!man && !mandoc) GTEST_SKIP() << "neither man nor mandoc is installed";
  for (const auto& page : fs::directory_iterator(here() / "man1")) {
    const std::string file = page.path();
    if (man) {
      const Ended shown = test::run_program({"/usr/bin/man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", file},
                                            here(), {"LC_ALL=C.UTF-8"});
      EXPECT_EQ(shown.err, "") << file;
      EXPECT_EQ(shown.status, 0) << file;
    }
    if (!mandoc) continue;
    // No page says when it was made, so that equal sources give equal pages.
    const Ended read = test::run_program({"/usr/bin/mandoc", "-Tlint", "-Wwarning", file}, here());
    for (const std::string& line : lines_of(read.out)) EXPECT_THAT(line, HasSubstr("missing date"));
  }
}

}  // namespace
}  // namespace palpate
