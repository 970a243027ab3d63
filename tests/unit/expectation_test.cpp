// SPDX-License-Identifier: MIT
// `expect:` read strictly: what it takes, and the words of every refusal.
#include "record/expectation.hpp"

#include "config/yaml.hpp"
#include "record/fields.hpp"
#include "support/runs.hpp"
#include "support/testing.hpp"

namespace palpate::test {
namespace {

using Statistic = Expectation::Statistic;

std::vector<Expectation> read(const std::string& expect) {
  const Tree tree = parse_yaml("expect: " + expect + "\n", "c.yaml");
  return read_expectations(tree.find("expect"));
}

std::string refused(const std::string& expect) {
  return error_of([&] { read(expect); });
}

TEST(Expectation, ComparesAFieldWithAQuantity) {
  const Expectation one = read("{rmse_m: <= 2 cm}").at(0);
  EXPECT_EQ(one.field, "rmse_m");
  EXPECT_EQ(one.statistic, Statistic::each);
  EXPECT_EQ(one.comparison, Relation::at_most);
  EXPECT_EQ(one.bound, 0.02);
  EXPECT_EQ(one.unit, "cm");
  EXPECT_EQ(one.wanted, "<= 2 cm");
  EXPECT_EQ(one.place, "c.yaml:1:10");
}

TEST(Expectation, KnowsFiveComparisonsWithAndWithoutBlanks) {
  const std::pair<const char*, Relation> signs[] = {{"'>= 9'", Relation::at_least}, {"'>=9'", Relation::at_least},
                                                    {"'>9'", Relation::above},      {"<=9", Relation::at_most},
                                                    {"< 9", Relation::below},       {"== 9", Relation::equal}};
  for (const auto& [text, comparison] : signs) {
    const Expectation one = read(std::string("{taps: ") + text + "}").at(0);
    EXPECT_EQ(one.comparison, comparison) << text;
    EXPECT_EQ(one.bound, 9.0) << text;
  }
}

TEST(Expectation, TakesFlagsAndTextsAsTheyAre) {
  EXPECT_EQ(read("{found: true}").at(0).bound, 1.0);
  EXPECT_EQ(read("{found: == false}").at(0).bound, 0.0);
  EXPECT_EQ(read("{status: done}").at(0).text, "done");
  EXPECT_EQ(read("{stop_reason: tap budget}").at(0).text, "tap budget");
}

TEST(Expectation, KnowsStatistics) {
  EXPECT_EQ(read("{mean(found): '>= 0.9'}").at(0).statistic, Statistic::mean);
  const std::pair<const char*, double> shares[] = {{"min", 0.0},  {"p5", 0.05},    {"p10", 0.1},
                                                   {"p25", 0.25}, {"median", 0.5}, {"p75", 0.75},
                                                   {"p90", 0.9},  {"p95", 0.95},   {"max", 1.0}};
  for (const auto& [name, share] : shares) {
    const Expectation one = read("{" + std::string(name) + "(rmse_m): < 3 cm}").at(0);
    EXPECT_EQ(one.statistic, Statistic::quantile);
    EXPECT_EQ(one.share, share);
    EXPECT_EQ(one.field, "rmse_m");
  }
  EXPECT_EQ(read("{median( rmse_m ): < 3 cm}").at(0).key, "median(rmse_m)");
}

TEST(Expectation, ReadsNestedFieldsByDotsOrMaps) {
  EXPECT_EQ(read("{compute.infer: < 1 s}").at(0).field, "compute.infer");
  EXPECT_EQ(read("{compute: {infer: < 1 s}}").at(0).field, "compute.infer");
}

TEST(Expectation, TakesSeveralComparisonsOfOneField) {
  const std::vector<Expectation> both = read("{coverage_95: ['>= 0.9', <= 0.99]}");
  ASSERT_EQ(both.size(), 2U);
  EXPECT_EQ(both[0].bound, 0.9);
  EXPECT_EQ(both[1].bound, 0.99);
}

TEST(Expectation, IsNoneWhereNothingStands) {
  EXPECT_TRUE(read("{}").empty());
  EXPECT_TRUE(read("").empty());
  EXPECT_TRUE(read_expectations(nullptr).empty());
}

TEST(Expectation, RefusesWhatItDoesNotUnderstandInOneLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"{rmse: <= 2 cm}", "c.yaml:1:10: expect: the summary has no field 'rmse', did you mean 'rmse_m'?"},
      {"{meadian(rmse_m): <= 2 cm}", "c.yaml:1:10: expect: unknown statistic 'meadian', did you mean 'median'?"},
      {"{median(rmse): <= 2 cm}", "c.yaml:1:10: expect: the summary has no field 'rmse', did you mean 'rmse_m'?"},
      {"{median(rmse_m: <= 2 cm}",
       "c.yaml:1:10: expect: 'median(rmse_m' is not a field or STATISTIC(field), write it like "
       "median(object_taps)"},
      {"{mean(status): done}", "c.yaml:1:10: expect: 'status' has no statistics, write status alone"},
      {"{mean(failed_runs): == 0}", "c.yaml:1:10: expect: 'failed_runs' has no statistics, write failed_runs alone"},
      {"{rmse_m: <= 2}", "c.yaml:1:18: expect.rmse_m: '2' has no unit, write a length like '1.7 cm'"},
      {"{rmse_m: <= 2 s}", "c.yaml:1:18: expect.rmse_m: '2 s' is a time, not a length, write a length like '1.7 cm'"},
      {"{rmse_m: 2 cm}", "c.yaml:1:18: expect.rmse_m: '2 cm' has no comparison, write a comparison like '<= 2 cm'"},
      {"{taps: 17}",
       "c.yaml:1:16: expect.taps: '17' has no comparison, write a comparison like '>= 9', with >=, <=, >, < or =="},
      {"{taps: => 17}",
       "c.yaml:1:16: expect.taps: '=> 17' has no comparison, write a comparison like '>= 9', with >=, <=, >, < or =="},
      {"{taps: <= 2 cm}", "c.yaml:1:16: expect.taps: '2 cm' is not a plain number, write it without a unit"},
      {"{taps: <= many}", "c.yaml:1:16: expect.taps: 'many' is not a number, write a plain number"},
      {"{taps: }", "c.yaml:1:10: expect.taps: has no value, write a comparison like '>= 9', with >=, <=, >, < or =="},
      {"{taps: []}",
       "c.yaml:1:10: expect.taps: the list is empty, write a comparison like '>= 9', with >=, <=, >, < or =="},
      {"{taps: {}}",
       "c.yaml:1:16: expect.taps: is not a comparison, write a comparison like '>= 9', with >=, <=, >, < or =="},
      {"{taps: [[1]]}",
       "c.yaml:1:17: expect.taps: is not a comparison, write a comparison like '>= 9', with >=, <=, >, < or =="},
      {"{found: yes}", "c.yaml:1:17: expect.found: 'yes' is not a truth value, write true or false"},
      {"{found: '>= 1'}", "c.yaml:1:17: expect.found: '>= 1' does not compare with >=, write true or false"},
      {"{status: < done}", "c.yaml:1:18: expect.status: '< done' does not compare with <, write the expected text"},
      {"{compute: {infer: < 1 s}, compute.infer: < 2 s}", "c.yaml:1:35: expect.compute.infer: is given twice"},
      {"\n  taps: >1\n  seed: <2",
       "c.yaml:2:9: expect.taps: has no value (one that begins with > needs quotes), write "
       "a comparison like '>= 9', with >=, <=, >, < or =="},
      {"[taps]",
       "c.yaml:1:9: expect: is not a map of expectations, write expect: {object_taps: \">= 9\", rmse_m: \"<= 2 "
       "cm\"}"},
  };
  for (const auto& [text, message] : cases) EXPECT_EQ(refused(text), message) << text;
}

TEST(Expectation, StaysOutOfTheIdAndInTheResolvedConfig) {
  const ResolvedConfig without = test::shipped_config("paper/object_i.yaml");
  const ResolvedConfig with =
      test::shipped_config("paper/object_i.yaml", {"expect.rmse_m=<= 2 cm", "expect.mean(compute.infer)=<1s"});
  EXPECT_EQ(with.id, without.id);
  EXPECT_EQ(without.tree.find("expect"), nullptr);
  ASSERT_EQ(with.expectations.size(), 2U);
  EXPECT_EQ(with.expectations[1].key, "mean(compute.infer)");
  EXPECT_EQ(with.expectations[1].place, "command line");

  const ResolvedConfig again = resolve_experiment(parse_yaml(to_yaml(with.tree), "again.yaml"), test::shared_host());
  EXPECT_EQ(to_yaml(again.tree), to_yaml(with.tree));
  ASSERT_EQ(again.expectations.size(), 2U);
  EXPECT_EQ(again.expectations[1].bound, 1.0);
}

}  // namespace
}  // namespace palpate::test
