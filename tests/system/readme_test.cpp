// SPDX-License-Identifier: MIT
// README and the pages of framework/docs tell the truth: their commands run, and what they quote is what comes out.
#include "support/sanitizers.hpp"
#include "system/document.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <utility>

namespace palpate {
namespace {

/// A folder that looks like a checkout: `palpate` is the program of this build, output stays in here.
void imitate_checkout(const fs::path& folder) {
  fs::create_symlink(test::program_file(), folder / "palpate");
  for (const char* name : {"configs", "plugins", "tests", "build"})
    fs::create_symlink(test::source_folder() / name, folder / name);
}

/// Whether a command is left out under the sanitizers, where it would take minutes: those whose work is the same in
/// every build, and those on the runs that were left out so; and what takes a browser, where none is installed.
bool left_out(const std::string& command, const fs::path& folder) {
  if (command.rfind("/usr/bin/python3 tests/report/", 0) == 0 && !fs::exists("/usr/bin/chromedriver")) return true;
#ifdef __SANITIZE_ADDRESS__
  for (const char* begin : {"sh tests/benchmark/", "tests/benchmark/", "build/release/", "./palpate sweep ",
                            "/usr/bin/python3 tests/report/"}) {
    if (command.rfind(begin, 0) == 0) return true;
  }
  const auto at = command.find(" runs/");
  if (at == std::string::npos) return false;
  return !fs::exists(folder / command.substr(at + 1, command.find('/', at + 6) - at - 1));
#else
  static_cast<void>(command);
  static_cast<void>(folder);
  return false;
#endif
}

/// A page, and how many of its blocks, texts and pictures are compared with what its commands print and draw.
struct Page {
  const char* name;
  int compared;
};

/// Returns the words of a text, in their order.
std::vector<std::string> words_of(const std::string& text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

class Pages : public testing::TestWithParam<Page> {};

bool wished(const char* variable) { return std::getenv(variable) != nullptr; }

TEST_P(Pages, ShowCommandsThatRunAndWhatTheyPrintAndDraw) {
  using Kind = test::Document::Part::Kind;
  const std::string name = GetParam().name;
  if (test::kSanitized && (name == "framework/docs/any_side.md" || name == "runs/reference/README.md"))
    GTEST_SKIP() << "the tests of touch from any side have the same commands do less";
  const TemporaryFolder folder;
  imitate_checkout(folder.path());
  test::Document page(test::source_folder() / name);
  int commands = 0;
  int compared = 0;
  bool ran = false;
  bool no_sweep_is_missing = true;
  test::Ended ended;
  for (std::size_t i = 0; i < page.parts().size(); ++i) {
    const test::Document::Part& part = page.parts()[i];
    if (part.kind == Kind::command) {
      ++commands;
      // `NAME@latest` behind a sweep is that sweep.
      ran = !left_out(part.text, folder.path()) && (!part.is_long || wished("PALPATE_LONG")) &&
            (no_sweep_is_missing || part.text.find("@latest") == std::string::npos);
      if (part.text.rfind("./palpate sweep ", 0) == 0) no_sweep_is_missing = ran;
      if (!ran) continue;
      // Python is Debian's own, whose packages the pages name.
      ended = test::run_program({"sh", "-c", "PATH=/usr/bin:$PATH\n" + part.text}, folder.path());
      EXPECT_EQ(ended.status, 0) << part.text << "\n" << ended.err;
    } else {
      ++compared;
      if (!ran) continue;
      EXPECT_EQ(page.difference(i, ended.out, folder.path(), wished("PALPATE_KEEP")), "");
    }
  }
  EXPECT_GE(commands, 2);
  EXPECT_EQ(compared, GetParam().compared) << "a page that shows more, or less, has its number below";
  if (wished("PALPATE_KEEP")) page.write();
}

const std::vector<Page> kPages{{"README.md", 0},
                               {"framework/docs/runs.md", 4},
                               {"framework/docs/results.md", 8},
                               {"framework/docs/sweeps.md", 0},
                               {"framework/docs/comparing.md", 9},
                               {"framework/docs/tuning.md", 0},
                               {"framework/docs/bundles.md", 1},
                               {"framework/docs/scenes.md", 3},
                               {"framework/docs/robots.md", 0},
                               {"framework/docs/ci.md", 0},
                               {"framework/docs/numerics.md", 7},
                               {"framework/docs/clutter.md", 5},
                               {"framework/docs/any_side.md", 4},
                               {"framework/docs/strategies.md", 0},
                               {"framework/docs/beliefs.md", 0},
                               {"framework/docs/stability.md", 0},
                               {"runs/reference/README.md", 11}};

INSTANTIATE_TEST_SUITE_P(Every, Pages, ::testing::ValuesIn(kPages), [](const auto& one) {
  return one.param.name == std::string("runs/reference/README.md") ? "pictures"
                                                                   : fs::path(one.param.name).stem().string();
});

TEST(Documents, AreShortAndEachPageIsTriedAndLinkedFromReadme) {
  const std::string readme = text_of(test::source_folder() / "README.md");
  EXPECT_LE(lines(readme), 200);
  EXPECT_LE(words_of(readme).size(), 1000U);
  int pages = 0;
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "framework/docs")) {
    ++pages;
    const std::string name = "framework/docs/" + entry.path().filename().string();
    EXPECT_LE(lines(text_of(entry.path())), 250) << name;
    EXPECT_THAT(readme, HasSubstr("](" + name + ")"));
  }
  // The examples of python.md run in tests/python.
  EXPECT_EQ(pages, 17) << "a new page needs its test above";
}

TEST(Documents, MapTheCodeOnOnePage) {
  const std::string map = text_of(test::source_folder() / "framework/README.md");
  EXPECT_LE(lines(map), 120);
  const auto changes = map.find("\n| to change | look at |\n");
  ASSERT_NE(changes, std::string::npos);
  EXPECT_LE(lines(map.substr(changes + 1)), 2 + 40) << "the table is last: its head and 40 rows";
}

/// Appends to `text` the scripts of the project that it names, and those that they name.
void append_scripts(std::string& text) {
  static const std::regex script(R"((tests|plugins)/[\w/]+\.(py|sh))");
  std::set<std::string> known;
  for (std::smatch found; std::regex_search(text.cbegin(), text.cend(), found, script);) {
    const std::string name = found[0];
    text.erase(static_cast<std::size_t>(found.position()), name.size());
    if (known.insert(name).second)
      text += (name.back() == 'y' ? " python3\n" : "\n") + text_of(test::source_folder() / name);
  }
}

/// Returns the names of the packages that a page gives in its prose.
std::string packages_of(const std::string& page) {
  static const std::regex install(R"(`(?:sudo )?apt install ([^`]*)`)");
  const std::string prose = std::regex_replace(page, std::regex("\n"), " ");
  std::string out;
  for (std::sregex_iterator at(prose.begin(), prose.end(), install), end; at != end; ++at) out += " " + (*at)[1].str();
  return out;
}

// tests/in_debian.sh runs the commands themselves on a machine which has nothing else.
TEST(Documents, NameThePackagesThatTheirCommandsNeedBesideThoseOfCore) {
  // What a command, the config of its run or a script that it calls contains, and the packages of which one is named.
  const std::vector<std::pair<std::regex, std::regex>> needs = [] {
    std::vector<std::pair<std::regex, std::regex>> out;
    for (const auto& [word, package] : std::vector<std::pair<const char*, const char*>>{
             {R"((^|[ /])python3\b)", R"(\bpython3\b)"},
             {R"((import|from) numpy)", R"(\bpython3-(numpy|sklearn)\b)"},
             {R"((import|from) (sklearn|threadpoolctl))", R"(\bpython3-sklearn\b)"},
             {R"((import|from) selenium)", R"(\bpython3-selenium\b)"},
             {R"(\bchromedriver\b)", R"(\bchromium-driver\b)"},
             {R"(\bbuild/release/tests/)", R"(\blibgtest-dev\b)"},
             {R"(\bjq\b)", R"(\bjq\b)"},
             {R"(\b(sbatch|squeue)\b)", R"(\bslurm-client\b)"},
             {R"(\bpdflatex\b)", R"(\btexlive-)"}})
      out.emplace_back(word, package);
    return out;
  }();
  const TemporaryFolder folder;
  imitate_checkout(folder.path());
  int needed = 0;
  for (const Page& one : kPages) {
    const test::Document page(test::source_folder() / one.name);
    const std::string packages = packages_of(text_of(test::source_folder() / one.name));
    for (const test::Document::Part& part : page.parts()) {
      if (part.kind != test::Document::Part::Kind::command) continue;
      std::string text = part.text;
      // The program of a backend or an acquisition stands in a group of the config.
      if (text.rfind("./palpate run configs/", 0) == 0 && text.find('|') == std::string::npos)
        text += "\n" + test::run_program({"sh", "-c", text + " --print-config"}, folder.path()).out;
      append_scripts(text);
      for (const auto& [word, package] : needs) {
        std::smatch found;
        if (!std::regex_search(text, found, word)) continue;
        ++needed;
        if (!std::regex_search(packages, package))
          ADD_FAILURE() << one.name << ":" << part.line + 1 << ": '" << found[0]
                        << "' needs a package of which the page says no `apt install`: " << part.text;
      }
    }
  }
  EXPECT_GE(needed, 10);
}

TEST(Documents, NameTargetAndPackagesOfTheProgramsOfTestsThatTheyCall) {
  static const std::regex program(R"(build/release/tests/(\w+)(?![\w/]))");
  std::vector<std::string> names{"plugins/README.md"};
  for (const Page& one : kPages) names.emplace_back(one.name);
  std::set<std::string> programs;
  for (const std::string& name : names) {
    const std::string page = text_of(test::source_folder() / name);
    for (std::sregex_iterator at(page.begin(), page.end(), program), end; at != end; ++at) {
      const std::string target = (*at)[1];
      programs.insert(target);
      const std::regex built("(--target|ninja -C build/release)[^`]*\\b" + target + "\\b");
      EXPECT_TRUE(std::regex_search(page, built)) << name << " does not say how " << target << " is built";
      EXPECT_THAT(packages_of(page), HasSubstr("libgtest-dev")) << name << ": " << target;
    }
  }
  EXPECT_GE(programs.size(), 5U);
}

TEST(Documents, ListInTheTablesOfPluginsThoseThatAreBuilt) {
  const std::string page = text_of(test::source_folder() / "plugins/README.md");
  std::map<std::string, std::set<std::string>> built;
  for (const std::string& line : lines_of(text_of(test::program_file().parent_path() / "lib/palpate/plugins.txt")))
    built[line.substr(0, line.find('/'))].insert(line.substr(line.find('/') + 1));
  for (const char* kind : {"kernel", "acquisition", "footprint", "backend"}) {
    std::set<std::string> listed;
    const auto begin = page.find("\n| " + std::string(kind) + " | ");
    ASSERT_NE(begin, std::string::npos) << kind;
    std::istringstream rows(page.substr(begin + 1));
    static const std::regex name("`(\\w+)`");
    for (std::string row; std::getline(rows, row) && !row.empty();) {
      const std::string cell = row.substr(0, row.find('|', 1));
      for (std::sregex_iterator at(cell.begin(), cell.end(), name), end; at != end; ++at) listed.insert((*at)[1]);
    }
    EXPECT_EQ(listed, built.at(kind)) << kind;
  }
  for (const std::string& fitting : built.at("fitting")) EXPECT_THAT(page, HasSubstr("`" + fitting + "`"));
}

TEST(Documents, LinkToFilesThatAreThere) {
  const fs::path root = test::source_folder();
  std::vector<fs::path> documents{root / "README.md",
                                  root / "runs/README.md",
                                  root / "runs/reference/README.md",
                                  root / "plugins/README.md",
                                  root / "framework/README.md",
                                  root / "CONTRIBUTING.md",
                                  root / "CHANGELOG.md",
                                  root / "plugins/backends/baxter/README.md",
                                  root / "plugins/backends/process/UR.md"};
  for (const auto& entry : fs::directory_iterator(root / "framework/docs")) documents.push_back(entry.path());
  int links = 0;
  for (const fs::path& document : documents) {
    const std::string text = text_of(document);
    for (auto at = text.find("]("); at != std::string::npos; at = text.find("](", at + 1)) {
      const std::string link = text.substr(at + 2, text.find_first_of("#)\n", at + 2) - at - 2);
      if (link.empty() || link.find("://") != std::string::npos || link.find_first_of(" &{[") != std::string::npos) {
        continue;  // code, or elsewhere
      }
      ++links;
      EXPECT_TRUE(fs::exists(document.parent_path() / link)) << document << ": " << link;
    }
  }
  EXPECT_GT(links, 40);
}

/// The first command that README shows: what stands before the comment in the first line of its first block.
std::string first_command(const std::string& readme) {
  const auto begin = readme.find("```\n") + 4;
  const std::string line = readme.substr(begin, readme.find('\n', begin) - begin);
  return line.substr(0, line.find_last_not_of(' ', line.find('#') - 1) + 1);
}

/// Returns the lines of README's log, without those that stand for others.
std::vector<std::string> lines_of_log(const std::string& readme) {
  const auto begin = readme.find("\n tap  source");
  std::vector<std::string> out = lines_of(readme.substr(begin + 1, readme.find("\n```", begin) - begin));
  out.erase(std::remove(out.begin(), out.end(), "..."), out.end());
  return out;
}

TEST(Readme, TheFirstCommandPrintsTheLinesOfTheLogAndItsErrorFalls) {
  const TemporaryFolder folder;
  imitate_checkout(folder.path());
  const std::string readme = text_of(test::source_folder() / "README.md");
  ASSERT_EQ(first_command(readme), "./palpate run configs/default.yaml");
  const test::Ended ended = test::run_program({"sh", "-c", first_command(readme)}, folder.path());
  const std::vector<std::string> shown = lines_of_log(readme);
  EXPECT_EQ(shown.size(), 7U);
  const std::vector<std::string> printed = lines_of(ended.out);
  auto at = printed.begin();
  for (const std::string& line : shown) {
    at = std::find(at, printed.end(), line);
    ASSERT_NE(at, printed.end()) << "not printed, or not in this order: " << line << "\n" << ended.out;
  }
  // The picture of a report is of this run: runs/reference/README.md has what stands in it.
  const auto id = ended.out.rfind('/') + 1;
  EXPECT_THAT(text_of(test::source_folder() / "runs/reference/README.md"),
              HasSubstr("\n\"id " + ended.out.substr(id, 12) + ", seed 1, "));
  std::vector<double> errors;  // after tap, source, x, y, height, contact and expected error, millimetres
  for (const std::string& line : printed) {
    const std::vector<std::string> words = words_of(line);
    if (words.size() == 9 && std::isdigit(static_cast<unsigned char>(words[0][0])) != 0)
      errors.push_back(std::stod(words[7]));
  }
  ASSERT_EQ(errors.size(), 30U);
  EXPECT_NEAR(errors.front(), 40.0, 0.5);
  const std::string at_last = "\nerror: ";
  ASSERT_THAT(ended.out, HasSubstr(at_last));
  EXPECT_LT(std::stod(ended.out.substr(ended.out.find(at_last) + at_last.size())), 0.25 * errors.front());
}

TEST(Readme, ExplainsATapThatThePapersStrategyChose) {
  const TemporaryFolder folder;
  imitate_checkout(folder.path());
  const std::string commands = "./palpate run configs/paper/object_i.yaml name=first\n   ./palpate explain first 9\n";
  EXPECT_THAT(text_of(test::source_folder() / "README.md"), HasSubstr(commands));
  const test::Ended ended = test::run_program({"sh", "-c", commands}, folder.path());
  EXPECT_THAT(ended.out, HasSubstr("Tap 9 of 17, run first"));
  EXPECT_THAT(ended.out, HasSubstr("The acquisition chose it: weighted"));
}

/// Returns the cells of the first row that begins so, without blanks around them; none if there is no such row.
std::vector<std::string> cells_of_row(const std::string& page, const std::string& beginning) {
  std::vector<std::string> out;
  for (const std::string& line : lines_of(page)) {
    if (line.rfind(beginning, 0) != 0) continue;
    std::istringstream cells(line.substr(1));
    for (std::string cell; std::getline(cells, cell, '|');) {
      const auto first = std::min(cell.find_first_not_of(' '), cell.size());
      out.push_back(cell.substr(first, cell.find_last_not_of(' ') + 1 - first));
    }
    break;
  }
  return out;
}

TEST(Readme, TakesItsNumbersFromThePagesThatItLinks) {
  const std::string readme = text_of(test::source_folder() / "README.md");
  const std::string unwrapped = std::regex_replace(readme, std::regex("\\s+"), " ");
  const std::string results = text_of(test::source_folder() / "framework/docs/results.md");
  constexpr std::size_t kError = 7;     // columns of the table of results.md: rmse_m [mm],
  constexpr std::size_t kSeconds = 11;  // and robot_seconds [s]
  const auto row = [&](const std::string& strategy, int taps) {
    std::vector<std::string> out =
        cells_of_row(results, "| per_tap | " + strategy + " | standard | " + std::to_string(taps) + " |");
    EXPECT_GT(out.size(), kSeconds) << strategy << ", " << taps << " taps";
    out.resize(kSeconds + 1);
    return out;
  };
  for (const char* strategy : {"default", "uncertainty", "weighted"}) {
    const std::vector<std::string> shown = cells_of_row(readme, "| `" + std::string(strategy) + "`");
    ASSERT_EQ(shown.size(), 4U) << strategy;
    for (const auto& [column, taps] : {std::pair<std::size_t, int>{1, 17}, {2, 30}, {3, 60}})
      EXPECT_EQ(shown[column], row(strategy, taps)[kError] + " mm") << strategy << ", " << taps << " taps";
  }
  const std::vector<std::string> few = row("default", 17);
  EXPECT_THAT(unwrapped, HasSubstr("After 17 taps (" + few[kSeconds] + " s), the default strategy"));
  std::string least_seconds = "10000";
  for (const char* strategy : {"random", "grid", "uncertainty", "weighted", "weighted_two_part"}) {
    const std::vector<std::string> many = row(strategy, 60);
    EXPECT_LT(std::stod(few[kError]), std::stod(many[kError])) << strategy;
    if (std::stod(many[kSeconds]) < std::stod(least_seconds)) least_seconds = many[kSeconds];
  }
  EXPECT_THAT(unwrapped, HasSubstr("60 taps (" + least_seconds + " s or more)"));

  const std::string comparing = text_of(test::source_folder() / "framework/docs/comparing.md");
  const std::vector<std::pair<std::string, std::string>> words{{"uncertainty", "with `uncertainty`"},
                                                               {"weighted", "with `weighted`"},
                                                               {"footprint_then_height", "with the default"}};
  for (const auto& [acquisition, after] : words) {
    const std::vector<std::string> cells = cells_of_row(comparing, "| `" + acquisition + "` |");
    ASSERT_EQ(cells.size(), 4U) << acquisition;
    EXPECT_THAT(unwrapped, HasSubstr(words_of(cells[3]).at(0) + " mm " + after));
  }
  const std::string scenes = text_of(test::source_folder() / "framework/docs/scenes.md");
  EXPECT_THAT(readme, HasSubstr("needs [1.7 to 6.4 s](framework/docs/scenes.md#"));
  EXPECT_THAT(scenes, HasSubstr("| 1.7 s |"));
  EXPECT_THAT(scenes, HasSubstr("| 6.4 s |"));
}

TEST(Readme, TakesItsNextStepsFromThePagesThatItLinks) {
  const std::string readme = text_of(test::source_folder() / "README.md");
  const auto begin = readme.find("\n## Next steps\n");
  ASSERT_NE(begin, std::string::npos);
  std::string page;
  int steps = 0;
  bool is_command = false;
  for (const std::string& line : lines_of(readme.substr(begin + 1, readme.find("\n## ", begin + 1) - begin))) {
    static const std::regex link(R"(\]\(([\w/]+\.md))");
    std::smatch found;
    if (std::regex_search(line, found, link)) {
      ++steps;
      page = "\n" + text_of(test::source_folder() / found[1].str());
    }
    if (is_command && line != "   ```") {
      EXPECT_THAT(page, HasSubstr("\n" + line.substr(3) + "\n"));
    }
    if (line.rfind("   ```", 0) == 0) is_command = line == "   ```sh";
  }
  EXPECT_EQ(steps, 6);
}

using Reference = Shell;

TEST_F(Reference, RunsComeOutTheSameWithinRounding) {
  int runs = 0;
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "runs" / "reference")) {
    if (entry.path().extension() != ".yaml") continue;
    const std::vector<Cells> before = csv_rows(text_of(fs::path(entry.path()).replace_extension("csv")));
    const std::vector<Cells> now =
        csv_rows(text_of(ran("--runs " + std::to_string(++runs), entry.path()) / "taps.csv"));
    ASSERT_EQ(now.size(), before.size());
    for (std::size_t i = 0; i < before.size(); ++i) {
      ASSERT_EQ(now[i].size(), before[i].size());
      for (const auto& [name, cell] : before[i]) {
        const std::string& again = now[i].at(name);
        char* end = nullptr;
        const double value = std::strtod(cell.c_str(), &end);
        if (cell.empty() || *end != '\0') {
          EXPECT_EQ(again, cell);
        } else {
          // Where a number is 0 but for rounding, 1e-9 relative would demand more than double precision holds.
          EXPECT_NEAR(std::strtod(again.c_str(), nullptr), value, 1e-9 * std::abs(value) + 1e-12);
        }
      }
    }
  }
  EXPECT_GE(runs, 2);
}

}  // namespace
}  // namespace palpate
