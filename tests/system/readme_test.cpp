// SPDX-License-Identifier: MIT
// README and the pages of framework/docs tell the truth: their commands run, and what they quote is what comes out.
#include "support/sanitizers.hpp"
#include "system/shell.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <sstream>

namespace palpate {
namespace {

/// The lines of all code blocks marked `sh`, which may be indented.
std::vector<std::string> shown_commands(const std::string& text) {
  std::vector<std::string> out;
  bool inside = false;
  for (std::string line : lines_of(text)) {
    line.erase(0, std::min(line.find_first_not_of(' '), line.size()));
    if (line.rfind("```", 0) == 0) {
      inside = line == "```sh";
    } else if (inside && !line.empty()) {
      out.push_back(line);
    }
  }
  return out;
}

/// A folder that looks like a checkout: `palpate` is the program of this build, output stays in here.
void imitate_checkout(const fs::path& folder) {
  fs::create_symlink(test::program_file(), folder / "palpate");
  for (const char* name : {"configs", "plugins", "tests", "build"})
    fs::create_symlink(test::source_folder() / name, folder / name);
}

/// Compares the page's table with what `palpate sweep` printed: group, runs, dead starts, found, failed, three spreads.
void expect_table(const std::string& page, const std::string& printed) {
  std::string plain = page;
  plain.erase(std::remove(plain.begin(), plain.end(), '*'), plain.end());
  int compared = 0;
  for (const std::string& line : lines_of(printed)) {
    std::istringstream words(line);
    std::string name, runs, dead, found, failed, live, live_spread, all, all_spread, error, error_spread;
    words >> name >> runs >> dead >> found >> failed >> live >> live_spread >> all >> all_spread >> error >>
        error_spread;
    if (runs != "1000") continue;
    ++compared;
    const auto percent = [](std::string text) { return text.insert(text.size() - 1, " "); };
    EXPECT_THAT(plain, HasSubstr(fmt::format("| {} | {} {} | {} {} | {} | {} | {} {} cm |", name, live, live_spread,
                                             all, all_spread, percent(dead), percent(found), error, error_spread)));
  }
  EXPECT_EQ(compared, 4);
}

/// The rows of the table that `printed` is stand in the page, letter by letter.
void expect_rows(const std::string& page, const std::string& printed) {
  for (const std::string& row : lines_of(printed)) EXPECT_THAT(page, HasSubstr(row + "\n"));
  EXPECT_GT(lines(printed), 2 + 5);
}

/// The numbered lines of the front in the page are those that `palpate pareto` printed, in its order.
void expect_front(const std::string& page, const std::string& printed) {
  std::string front;
  for (const std::string& line : lines_of(printed)) {
    if (front.empty() || std::isdigit(static_cast<unsigned char>(line[4])) != 0) front += line + "\n";
  }
  EXPECT_THAT(page, HasSubstr("```\n" + front + "```\n"));
}

/// The tables that `palpate compare` printed stand in the page, and so do the words on how to read them.
void expect_comparison(const std::string& page, const std::string& printed) {
  const auto legend = printed.find("\ninterval:");
  ASSERT_NE(legend, std::string::npos);
  EXPECT_THAT(page, HasSubstr("```\n" + printed.substr(0, legend)));
  EXPECT_THAT(page, HasSubstr(printed.substr(legend) + "```\n"));
}

/// Whether a command is left out under the sanitizers, where it would take minutes: those whose work is the same in
/// every build, and those on the runs that were left out so.
bool left_out(const std::string& command, const fs::path& folder) {
#ifdef __SANITIZE_ADDRESS__
  for (const char* begin : {"sh tests/benchmark/", "tests/benchmark/", "build/release/", "./palpate sweep "}) {
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

/// A page, and how many of its tables come from commands that run here.
struct Page {
  const char* name;
  int tables;
};

class Document : public testing::TestWithParam<Page> {};

TEST_P(Document, ShowsCommandsThatRunAndTablesThatTheyPrint) {
  if (test::kSanitized && GetParam().name == std::string("framework/docs/any_side.md"))
    GTEST_SKIP() << "the tests of touch from any side have the same commands do less";
  const TemporaryFolder folder;
  imitate_checkout(folder.path());
  const std::string page = text_of(test::source_folder() / GetParam().name);
  const std::vector<std::string> commands = shown_commands(page);
  EXPECT_GE(commands.size(), 2U);
  int tables = 0;
  for (const std::string& command : commands) {
    if (left_out(command, folder.path())) continue;
    const test::Ended ended = test::run_program({"sh", "-c", command}, folder.path());
    EXPECT_EQ(ended.status, 0) << command << "\n" << ended.err;
    ++tables;
    if (command == "./palpate sweep configs/paper/comparison.yaml" &&
        page.find("| strategy | taps") != std::string::npos) {
      expect_table(page, ended.out);
    } else if (command == "sh tests/benchmark/fitting.sh" || command == "tests/benchmark/motions.py") {
      expect_rows(page, ended.out);
    } else if (command == "./palpate pareto runs/trade_motion/* --cost robot_seconds --error rmse_m") {
      expect_front(page, ended.out);
    } else if (command.rfind("./palpate compare runs/comparison/", 0) == 0) {
      expect_comparison(page, ended.out);
    } else {
      --tables;
    }
  }
  EXPECT_EQ(tables, left_out("sh tests/benchmark/fitting.sh", folder.path()) ? 0 : GetParam().tables);
}

INSTANTIATE_TEST_SUITE_P(Every, Document,
                         ::testing::Values(Page{"README.md", 0}, Page{"framework/docs/runs.md", 1},
                                           Page{"framework/docs/results.md", 1}, Page{"framework/docs/sweeps.md", 0},
                                           Page{"framework/docs/comparing.md", 3}, Page{"framework/docs/scenes.md", 1},
                                           Page{"framework/docs/robots.md", 0}, Page{"framework/docs/gates.md", 0},
                                           Page{"framework/docs/exactness.md", 0}, Page{"framework/docs/desks.md", 0},
                                           Page{"framework/docs/any_side.md", 0}),
                         [](const auto& one) { return fs::path(one.param.name).stem().string(); });

TEST(Documents, AreShortAndEachPageIsTriedAndLinkedFromReadme) {
  const std::string readme = text_of(test::source_folder() / "README.md");
  EXPECT_LE(lines(readme), 200);
  int pages = 0;
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "framework/docs")) {
    ++pages;
    const std::string name = "framework/docs/" + entry.path().filename().string();
    EXPECT_LE(lines(text_of(entry.path())), 250) << name;
    EXPECT_THAT(readme, HasSubstr("](" + name + ")"));
  }
  // The examples of python.md run in tests/python.
  EXPECT_EQ(pages, 11) << "a new page needs its test above";
}

TEST(Documents, LinkToFilesThatAreThere) {
  const fs::path root = test::source_folder();
  std::vector<fs::path> documents{root / "README.md",
                                  root / "runs/README.md",
                                  root / "runs/reference/README.md",
                                  root / "plugins/README.md",
                                  root / "framework/README.md",
                                  root / "CONTRIBUTING.md",
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

TEST(Readme, TheCaptureIsWhatTheFirstCommandPrintsAndItsErrorFalls) {
  const TemporaryFolder folder;
  imitate_checkout(folder.path());
  const std::string readme = text_of(test::source_folder() / "README.md");
  ASSERT_EQ(first_command(readme), "./palpate run configs/default.yaml");
  const test::Ended ended = test::run_program({"sh", "-c", first_command(readme)}, folder.path());
  EXPECT_THAT(readme, HasSubstr("```\n" + ended.out + "```\n"));
  // "4 cm while nothing is known, 3 mm after 30 taps"
  std::vector<double> errors;  // behind tap, source, x, y, height, contact and deviation, centimetres
  for (const std::string& line : lines_of(ended.out)) {
    std::istringstream cells(line);
    const std::vector<std::string> words{std::istream_iterator<std::string>(cells), {}};
    if (words.size() == 9 && std::isdigit(static_cast<unsigned char>(words[0][0])) != 0)
      errors.push_back(std::stod(words[7]));
  }
  ASSERT_EQ(errors.size(), 30U);
  EXPECT_NEAR(errors.front(), 4.0, 0.05);
  const std::string at_last = "\nerror: ";
  ASSERT_THAT(ended.out, HasSubstr(at_last));
  EXPECT_NEAR(std::stod(ended.out.substr(ended.out.find(at_last) + at_last.size())), 0.26, 0.05);
}

TEST(Readme, SaysOfThePapersExperimentWhatComesOutOfIt) {
  const TemporaryFolder folder;
  imitate_checkout(folder.path());
  const std::string readme = text_of(test::source_folder() / "README.md");
  EXPECT_THAT(readme, HasSubstr("finds it at tap 8, and the rule takes over; its 17 taps leave an error of 3.2 cm."));
  const test::Ended ended = test::run_program({"sh", "-c", "./palpate run configs/paper/object_i.yaml"}, folder.path());
  EXPECT_THAT(ended.out, HasSubstr("first hit at tap 8\nerror: 3.20 cm over the scene"));
  EXPECT_THAT(ended.out, HasSubstr("\ndone: tap budget after 17 taps"));
}

using Reference = Shell;

TEST_F(Reference, RunsComeOutTheSameWithinRounding) {
  int runs = 0;
  for (const auto& entry : fs::directory_iterator(test::source_folder() / "runs" / "reference")) {
    if (!entry.is_directory()) continue;
    const std::vector<Cells> before = csv_rows(text_of(entry.path() / "taps.csv"));
    const std::vector<Cells> now =
        csv_rows(text_of(ran("--runs " + std::to_string(++runs), entry.path() / "config.yaml") / "taps.csv"));
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
