// SPDX-License-Identifier: MIT
// Every extreme case against an oracle with 100 digits; the criterion stands in check.hpp, the cases in cases.cpp.
#include "stability/check.hpp"
#include "stability/oracle.hpp"
#include "stability/reference.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"

#include <fmt/format.h>

#include <cctype>
#include <cstdlib>

namespace palpate::stability {

/// Lists of tests show a case by its name.
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

namespace {

class Extremes : public ::testing::TestWithParam<Case> {};

TEST_P(Extremes, HoldTheBound) {
  if (test::brief() && GetParam().points > 200) GTEST_SKIP() << "./check --all makes it in release";
  for (const Row& row : check(GetParam())) {
    EXPECT_EQ(row.trouble, "") << header() << '\n' << text(row);
    RecordProperty("row_" + row.engine, text(row));
  }
}

INSTANTIATE_TEST_SUITE_P(Cases, Extremes, ::testing::ValuesIn(cases()), [](const auto& one) {
  std::string name = one.param.name;
  for (char& letter : name) letter = std::isalnum(static_cast<unsigned char>(letter)) != 0 ? letter : '_';
  return name;
});

using test::Cells;

/// The table that is kept with the project.
std::vector<Cells> recorded_table() {
  return test::csv_rows(test::text_of(test::source_folder() / "runs/reference/stability.csv"));
}

double number(const Cells& row, const std::string& column) { return std::strtod(row.at(column).c_str(), nullptr); }

TEST(ExtremesTable, TheRecordedOneHasEveryCaseAndEveryRowHolds) {
  const std::vector<Cells> rows = recorded_table();
  std::vector<std::string> recorded;
  std::vector<std::string> wanted;
  for (const Case& one : cases()) {
    wanted.push_back(one.name + " dense");
    if (one.kernel != "rbf") continue;
    for (const char* engine : {" grid", " lowrank", " auto"}) wanted.push_back(one.name + engine);
  }
  for (const Cells& row : rows) {
    recorded.push_back(row.at("case") + " " + row.at("engine"));
    EXPECT_EQ(row.at("verdict"), "holds") << row.at("case");
    EXPECT_LE(number(row, "mean_error"), number(row, "mean_bound")) << row.at("case");
    EXPECT_LE(number(row, "variance_error"), number(row, "variance_bound")) << row.at("case");
  }
  EXPECT_EQ(recorded, wanted);
}

TEST(ExtremesTable, HoldsManyCasesOnBothSidesOfWhatDoublePrecisionCanHold) {
  const std::vector<Cells> rows = recorded_table();
  int beyond = 0;
  for (const Cells& row : rows) beyond += number(row, "condition") >= kBeyond ? 1 : 0;
  EXPECT_GE(beyond, 40);
  EXPECT_GE(static_cast<int>(rows.size()) - beyond, 100);
}

TEST(ExtremesTable, ItsPageCountsTheCasesThatThereAre) {
  EXPECT_THAT(test::text_of(test::source_folder() / "framework/docs/numerics.md"),
              ::testing::HasSubstr(fmt::format("\n{} cases", cases().size())));
}

// Why the scale of a mean is the largest posterior mean where that exceeds the prior: the last digits of the
// covariances, which no computation in double precision has, are worth more than the bound without it.
TEST(ExtremesScale, AMeanThatOvershootsIsMovedBeyondTheBoundOfOneThatDoesNotByTheLastDigitsOfTheCovariances) {
  const auto rough = std::find_if(cases().begin(), cases().end(),
                                  [](const Case& one) { return one.name == "rbf_rough_data_length_1_noise_1e-08"; });
  ASSERT_NE(rough, cases().end());
  const Problem problem(*rough);
  Oracle oracle(*rough, problem.places, problem.values);
  Eigen::Index farthest = 0;
  by_oracle(problem, oracle, 0.0).value().mean.cwiseAbs().maxCoeff(&farthest);
  const Target probe{problem.probes(farthest, 0), problem.probes(farthest, 1)};
  const Real exact = oracle.at(probe.x, probe.y).mean;
  oracle.nudge_covariances(probe.x, probe.y);
  ASSERT_TRUE(oracle.factorise(0.0));
  const auto moved = static_cast<double>(Real(abs(oracle.at(probe.x, probe.y).mean - exact)));
  const double bound = rough->points * std::numeric_limits<double>::epsilon() * spectrum(problem).condition();
  EXPECT_GT(static_cast<double>(Real(abs(exact))), 3.0);
  EXPECT_GT(moved, 3.0 * bound);
  RecordProperty("moved", fmt::format("{:.2g}, bound {:.2g}", moved, bound));
}

/// The table of a few cases, as a program that may be broken on purpose prints it.
test::Ended table_of(const char* program) {
  const test::TemporaryFolder folder;
  return test::run_program({program, "duplicates_noise_0", "one_place_noise_0", "pairs_noise_0", "17_points"},
                           folder.path());
}

TEST(BrokenOnPurpose, TheSoundFactorisationHoldsInTheFewCasesThatAreToFail) {
  const test::Ended ended = table_of(PALPATE_STABILITY_TABLE);
  EXPECT_EQ(ended.status, 0) << ended.out << ended.err;
  EXPECT_GE(test::csv_rows(ended.out).size(), 5U);
}

/// That its table tells of singular matrices, and of no sound one.
void expect_broken(const char* program, const std::string& how) {
  if (!std::filesystem::exists(program)) GTEST_SKIP() << "built by ./check --all, in release";
  const test::Ended ended = table_of(program);
  EXPECT_EQ(ended.status, 1);
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("\nduplicates_noise_0,dense,.*fails: " + how + "\n"));
  EXPECT_THAT(ended.out, ::testing::ContainsRegex("\n17_points_noise_1e-08,dense,.*holds\n"));
}

TEST(BrokenOnPurpose, WithoutThePivotGuardTheTableFails) {
  expect_broken(PALPATE_STABILITY_WITHOUT_GUARD, "not a number");
}

TEST(BrokenOnPurpose, WithAJitterThatShowsTheTableFails) { expect_broken(PALPATE_STABILITY_LARGE_JITTER, "jitter"); }

}  // namespace
}  // namespace palpate::stability
