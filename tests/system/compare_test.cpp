// SPDX-License-Identifier: MIT
// `palpate compare` as a user calls it: tables, the CSV beside results.csv, and what it refuses.
#include "config/tree.hpp"
#include "record/json.hpp"
#include "system/shell.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace palpate {
namespace {

class Compare : public Shell {
 protected:
  /// A sweep of two strategies, two budgets and six seeds.
  fs::path strategies() const {
    return swept("acquisition=uncertainty,weighted taps=8,12 candidates.count=16 seed=range(0,6)");
  }
  Ended compare(const fs::path& sweep, const Words& more) const {
    Ended ended = palpate(Words{"compare", sweep} + more);
    EXPECT_EQ(ended.status, 0) << ended.err;
    return ended;
  }
};

TEST_F(Compare, PrintsGroupsAndPairsAndLeavesTheirNumbersAsCsv) {
  const fs::path directory = strategies();
  const Ended ended = compare(directory, "--by acquisition --metric object_taps");
  EXPECT_THAT(ended.out, StartsWith("object_taps by acquisition; more is better\nacquisition  jobs "));
  EXPECT_THAT(ended.out, HasSubstr("\nweighted - uncertainty     12 "));
  EXPECT_THAT(ended.out, HasSubstr("\n"
                                   "The unit is the seed: all jobs of a seed are resampled together and count as one.\n"
                                   "pair: two jobs with equal taps, seed.\n"));
  EXPECT_THAT(ended.out, HasSubstr("\nonly 6 seeds: "));
  const fs::path file = directory / "compare_acquisition_object_taps.csv";
  EXPECT_EQ(ended.err, "table: " + file.string() + "\n");

  // The same from results.csv, job by job and seed by seed.
  std::map<std::string, std::map<std::string, double>> taps;
  for (const Cells& job : csv_rows(text_of(directory / "results.csv")))
    taps[job.at("acquisition")][job.at("taps") + "/" + job.at("seed")] = std::stod(job.at("object_taps"));
  std::map<std::string, double> of_seed;
  double sum = 0.0;
  int more = 0;
  int less = 0;
  for (const auto& [pairing, value] : taps.at("weighted")) {
    const double difference = value - taps.at("uncertainty").at(pairing);
    sum += difference;
    of_seed[pairing.substr(pairing.find('/'))] += difference;
  }
  for (const auto& [seed, difference] : of_seed) {
    more += difference > 0 ? 1 : 0;
    less += difference < 0 ? 1 : 0;
  }
  const std::vector<Cells> rows = csv_rows(text_of(file));
  ASSERT_EQ(rows.size(), 3U);
  const Cells& pair = rows.back();
  EXPECT_EQ(pair.at("kind"), "pair");
  EXPECT_EQ(pair.at("group"), "weighted");
  EXPECT_EQ(pair.at("minus"), "uncertainty");
  EXPECT_EQ(pair.at("n"), "12");
  EXPECT_EQ(pair.at("seeds"), "6");
  EXPECT_NEAR(std::stod(pair.at("mean")), sum / 12.0, 1e-12);
  EXPECT_EQ(pair.at("higher"), std::to_string(more));
  EXPECT_EQ(pair.at("lower"), std::to_string(less));
  EXPECT_EQ(pair.at("p_exact"), "true");
}

TEST_F(Compare, SaysTheSameEveryTimeAndFailsWhereTheTableCannotBeLeft) {
  const fs::path directory = strategies();
  const Words words = "--by acquisition,taps --metric rmse_m";
  const Ended once = compare(directory, words);
  EXPECT_THAT(once.out, HasSubstr("p (Holm)"));
  EXPECT_EQ(once.out, compare(directory, words).out);
  // A folder in its place keeps out even root, who may write where nobody may.
  EXPECT_TRUE(fs::remove(directory / "compare_acquisition_taps_rmse_m.csv"));
  write(directory / "compare_acquisition_taps_rmse_m.csv" / "x", "");
  const Ended ended = palpate(Words{"compare", directory} + words);
  EXPECT_EQ(ended.out, once.out);
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.err, HasSubstr("compare_acquisition_taps_rmse_m.csv: cannot be renamed to: Is a directory"));
  EXPECT_EQ(lines(ended.err), 1);
}

TEST_F(Compare, ShowsATableForEachMetricNamedInAListOrOneByOne) {
  const fs::path directory = strategies();
  const Ended list = compare(directory, "--by acquisition --metric rmse_m,found");
  EXPECT_EQ(list.out, compare(directory, "--metric rmse_m --metric found --by acquisition").out);
  EXPECT_THAT(list.out, StartsWith("rmse_m [mm] by acquisition; less is better\n"));
  EXPECT_THAT(list.out, HasSubstr("\nfound by acquisition; more is better\n"));
  EXPECT_TRUE(fs::exists(directory / "compare_acquisition_rmse_m.csv"));
  EXPECT_TRUE(fs::exists(directory / "compare_acquisition_found.csv"));
}

TEST_F(Compare, PrintsTheRowsOfItsTableAsCsvAndJsonAndLeavesNothingThen) {
  const fs::path directory = strategies();
  const Words words = "--by acquisition --metric rmse_m,found";
  const Ended csv = compare(directory, words + "--format csv");
  const Ended list = compare(directory, words + "--format json");
  EXPECT_FALSE(fs::exists(directory / "compare_acquisition_rmse_m.csv"));
  const std::vector<Cells> rows = csv_rows(csv.out);
  ASSERT_EQ(rows.size(), 6U) << "two groups and a pair of each metric";
  const std::string object = "{\"rows\": " + list.out + "}";
  const Tree tree = *parse_json(object, "stdout").find("rows");
  ASSERT_EQ(tree.items.size(), rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const char* name : {"kind", "metric", "group", "n", "mean", "low_95", "high_95"})
      EXPECT_EQ(tree.items[i].find(name)->text, rows[i].at(name)) << i << " " << name;
  }
  compare(directory, words);
  const std::vector<Cells> left = csv_rows(text_of(directory / "compare_acquisition_rmse_m.csv"));
  for (std::size_t i = 0; i < left.size(); ++i) EXPECT_EQ(rows[i].at("mean"), left[i].at("mean"));
}

TEST_F(Compare, PrintsATableThatLatexCompilesWithBooktabs) {
  const fs::path directory = strategies();
  const Ended ended = compare(directory, "--by acquisition,taps --metric rmse_m,footprint_iou --format latex");
  EXPECT_THAT(ended.out, HasSubstr("\nuncertainty & 8 & $"));
  EXPECT_THAT(ended.out, HasSubstr("rmse\\_m [mm] & footprint\\_iou & $n$ \\\\\n\\midrule\n"));
  if (std::system("kpsewhich booktabs.sty > /dev/null 2>&1 && command -v pdflatex > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "nothing compiles it: texlive-latex-recommended is not installed";
  write("table.tex",
        "\\documentclass{article}\n\\usepackage{booktabs}\n\\begin{document}\n" + ended.out + "\\end{document}\n");
  const std::string command = "cd '" + here().string() + "' && pdflatex -interaction=nonstopmode -halt-on-error table";
  EXPECT_EQ(std::system((command + " > latex.out 2>&1").c_str()), 0) << text_of(here() / "latex.out");
  EXPECT_THAT(text_of(here() / "table.pdf"), StartsWith("%PDF"));
}

TEST_F(Compare, WithAConditionHasAFileOfItsOwnThatNamesIt) {
  const fs::path directory = strategies();
  const Words words = "--by acquisition --metric rmse_m";
  compare(directory, words);
  const std::string whole = text_of(directory / "compare_acquisition_rmse_m.csv");
  const std::string condition = "taps == 12 and robot_seconds > 1 s";
  const Ended ended = compare(directory, words + Words{"--where", condition});
  EXPECT_THAT(ended.out, HasSubstr("--where excludes 12 of 24 jobs\n"));
  EXPECT_EQ(text_of(directory / "compare_acquisition_rmse_m.csv"), whole);
  const std::string file = ended.err.substr(7, ended.err.size() - 8);
  ASSERT_THAT(file, HasSubstr("compare_acquisition_rmse_m_where_"));
  for (const Cells& row : csv_rows(text_of(file))) {
    EXPECT_EQ(row.at("where"), condition);
    EXPECT_EQ(row.at("n"), "6");
  }
}

TEST_F(Compare, ReachesASweptKeyAndTheResultOfTheSameName) {
  const fs::path directory = strategies();
  const Ended ended = compare(directory, "--by taps --metric taps,summary.taps --until rmse_m=3cm --format csv");
  // The taps that each job needed, as they are kept in its folder.
  std::map<std::string, double> needed;
  int fewer = 0;
  for (const Cells& job : csv_rows(text_of(directory / "results.csv"))) {
    const std::vector<Row> kept = json_rows(directory / "jobs" / job.at("id") / "summaries.jsonl");
    const auto good = [](const Row& row) { return *row.number("rmse_m") <= 0.03; };
    const auto taps = std::find_if(kept.begin(), kept.end(), good) - kept.begin() + 1;
    needed[job.at("taps")] += static_cast<double>(taps) / 12.0;
    fewer += std::to_string(taps) != job.at("taps") ? 1 : 0;
  }
  ASSERT_GT(fewer, 0);
  int groups = 0;
  for (const Cells& row : csv_rows(ended.out)) {
    if (row.at("kind") != "group") continue;
    EXPECT_NEAR(std::stod(row.at("mean")), needed.at(row.at("group")), 1e-12);
    ++groups;
  }
  EXPECT_EQ(groups, 4) << "two budgets, each name";
  const auto kept = [&](const std::string& where) {
    return csv_rows(
               compare(directory,
                       Words("--by acquisition --metric rmse_m --until rmse_m=3cm --format csv --where") + Words{where})
                   .out)
        .front()
        .at("left_out");
  };
  EXPECT_EQ(kept("taps == 8"), "6") << "the budget";
  EXPECT_EQ(kept("summary.taps > 0"), "0") << "what was made";
}

TEST_F(Compare, SplitsTheVarianceBetweenSettingsAmongTheSweptKeys) {
  const fs::path directory = strategies();
  const Ended text = compare(directory, "--importance --metric rmse_m,object_taps");
  EXPECT_THAT(text.out, StartsWith("importance for rmse_m: share of the variance between 4 settings\nkeys "));
  EXPECT_THAT(text.out, HasSubstr("\n\nimportance for object_taps: share of the variance between 4 settings\n"));
  EXPECT_THAT(text.out, HasSubstr("\nexact: every combination of the values has run; 6 of 6 seeds used\nnoise: "));
  const std::vector<Cells> rows = csv_rows(compare(directory, "--importance --metric rmse_m --format csv").out);
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows.back().at("keys"), "acquisition,taps");
  EXPECT_NEAR(std::stod(rows[0].at("share")) + std::stod(rows[1].at("share")) + std::stod(rows[2].at("share")), 1.0,
              1e-12);
  const std::string list = compare(directory, "--importance --metric rmse_m --format json").out;
  const std::string object = "{\"rows\": " + list + "}";
  const Tree tree = *parse_json(object, "stdout").find("rows");
  ASSERT_EQ(tree.items.size(), 3U);
  for (const char* name : {"metric", "keys", "share", "low_95", "high_95", "exact", "noise"})
    EXPECT_EQ(tree.items[0].find(name)->text, rows[0].at(name)) << name;
  EXPECT_THAT(compare(directory, "--importance --metric rmse_m --format markdown").out,
              StartsWith("| keys | share in % [95 % interval] |\n|---|---:|\n"));
  EXPECT_THAT(compare(directory, "--importance --metric rmse_m --format latex").out, HasSubstr("acquisition,taps & "));
}

TEST_F(Compare, RefusesInOneLineWhatCannotBeCompared) {
  const Words compare{"compare", strategies()};
  EXPECT_EQ(refused(compare + "--by acquisition --metric rmse_m,rsme_m"),
            "command line: --metric: results.csv has no column 'rsme_m', did you mean 'rmse_m'?\n");
  EXPECT_THAT(refused(compare + "--by acquisition"), StartsWith("--metric is required"));
  EXPECT_EQ(refused(compare + "--metric rmse_m"), "--by or --importance is required, see palpate compare --help\n");
  for (const char* other : {"--by acquisition", "--baseline weighted", "--at 3", "--until rmse_m=8mm", "--ratio"}) {
    const std::string option = Words(other).front();
    EXPECT_THAT(refused(compare + "--importance --metric rmse_m" + Words(other)),
                AllOf(HasSubstr(option), HasSubstr("excludes"), HasSubstr("--importance")))
        << other;
  }
  EXPECT_EQ(refused(compare + "--importance --metric rmse_m --where" + Words{"seed == 3"}),
            "command line: --importance: no two seeds have values in the same two settings, sweep the seed: "
            "seed=range(0,20)\n");
  EXPECT_THAT(refused(compare + "--by acquisition --metric rmse_m --where" + Words{"taps >"}),
              StartsWith("command line: --where: the condition 'taps >'"));
  fs::create_directory(here() / "empty");
  EXPECT_THAT(refused(Words{"compare", here() / "empty"} + "--by acquisition --metric rmse_m"),
              EndsWith("is neither a run nor a sweep, it has no record of one\n"));
}

}  // namespace
}  // namespace palpate
