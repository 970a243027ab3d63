// SPDX-License-Identifier: MIT
// The laws of footprint.hpp, over every footprint found: those that need no options, and those of every shipped config.
#include "config/yaml.hpp"
#include "support/instruction_sets.hpp"
#include "support/sanitizers.hpp"
#include "support/testing.hpp"
#include "support/touches.hpp"

#include <palpate/footprint.hpp>

#include <ostream>

namespace palpate::test {
namespace {

struct FootprintCase {
  std::string name;
  std::string type;
  std::string options;  ///< a YAML map
};

void PrintTo(const FootprintCase& one, std::ostream* out) { *out << one.name; }

std::vector<std::filesystem::path> shipped_files() {
  std::vector<std::filesystem::path> out;
  for (const auto& entry : std::filesystem::directory_iterator(source_folder() / "configs/footprint"))
    out.push_back(entry.path());
  std::sort(out.begin(), out.end());
  return out;
}

FootprintCase shipped_case(const std::filesystem::path& file) {
  const Tree tree = read_yaml(file);
  Tree options = *tree.find("footprint");
  const std::string type = options.find("type")->text;
  options.erase("type");
  return {"config_" + file.stem().string(), type, options.entries.empty() ? "{}" : to_yaml(options)};
}

std::vector<FootprintCase> footprint_cases() {
  std::vector<FootprintCase> out;
  for (const std::string& name : plugins_under_contract("footprint")) out.push_back({test_name(name), name, "{}"});
  for (const std::filesystem::path& file : shipped_files()) out.push_back(shipped_case(file));
  return out;
}

class FootprintContract : public testing::TestWithParam<FootprintCase> {
 protected:
  void SetUp() override {
    if (fresh()->is_weight()) GTEST_SKIP() << "its probability is the framework's";
  }

  static std::shared_ptr<Footprint> fresh() {
    return make<Footprint>(contract_host(), GetParam().type, GetParam().options);
  }
};

TEST_P(FootprintContract, GivesProbabilitiesWhateverTheTouches) {
  for (const auto& [what, touches] : trying_touches()) {
    const auto footprint = fresh();
    take(*footprint, touches);
    Eigen::VectorXd doubt(static_cast<Eigen::Index>(touches.size()));
    footprint->doubt(doubt);
    EXPECT_TRUE(all_probabilities(doubt)) << "of labels, touches: " << what;
    for (const auto& [where, places] : trying_places())
      EXPECT_TRUE(all_probabilities(probability_of(*footprint, places))) << "touches: " << what << "; " << where;
  }
}

TEST_P(FootprintContract, GivesProbabilitiesAfterAThousandTouches) {
  const int count = brief() ? 500 : 1000;  // what is drawn at random weighs every touch so far at each
  const auto footprint = fresh();
  take(*footprint, disc_touches(count));
  for (const auto& [where, places] : trying_places())
    EXPECT_TRUE(all_probabilities(probability_of(*footprint, places))) << where;
  const Eigen::VectorXd inside = probability_of(*footprint, Points{{0.115, 0.115}, {0.01, 0.01}});
  EXPECT_GT(inside(0), 0.9) << "the middle of an object that so many touches have found";
  EXPECT_LT(inside(1), 0.1) << "a corner of the desk";
}

// The touches tell, whatever the places are that somebody asks about: a row of one is as good as a place of a lattice.
TEST_P(FootprintContract, GivesAPlaceTheSameProbabilityAmongAnyOthers) {
  const auto footprint = fresh();
  take(*footprint, disc_touches(30));
  for (const auto& [where, places] : trying_places()) {
    const Eigen::VectorXd together = probability_of(*footprint, places);
    for (Eigen::Index i = 0; i < places.rows(); i += 7) {
      const Points one = places.row(i);
      EXPECT_NEAR(probability_of(*footprint, one)(0), together(i), 1e-9) << "place " << i << " of " << where;
    }
  }
}

TEST_P(FootprintContract, WritesItsOutputAndNothingBesideIt) {
  const auto footprint = fresh();
  take(*footprint, disc_touches(10));
  const Eigen::MatrixXd written =
      written_inside(25, 1, [&](MatrixOut out) { footprint->probability(lattice(5, 5), out.col(0)); });
  EXPECT_TRUE(same_bytes(written.col(0), probability_of(*footprint, lattice(5, 5))));
}

TEST_P(FootprintContract, GivesTheSameBytesHoweverOftenAndWhereItIsAskedInBetween) {
  const std::vector<Touch> touches = disc_touches(30);
  const auto rarely = fresh();
  take(*rarely, touches);
  const auto often = fresh();
  for (const Touch& touch : touches) {
    for (const auto& [where, places] : trying_places()) probability_of(*often, places);
    often->numbers();
    often->undiscovered_probability();
    often->remark();
    often->add(touch);
    probability_of(*often, lattice(7, 7));
    probability_of(*often, lattice(7, 7));
  }
  EXPECT_TRUE(same_bytes(probability_of(*rarely, lattice(23, 23)), probability_of(*often, lattice(23, 23))));
  EXPECT_EQ(rarely->remark(), often->remark());
  EXPECT_EQ(rarely->undiscovered_probability(), often->undiscovered_probability());
  const std::vector<FootprintNumber> some = rarely->numbers();
  const std::vector<FootprintNumber> others = often->numbers();
  ASSERT_EQ(some.size(), others.size());
  for (std::size_t i = 0; i < some.size(); ++i) EXPECT_EQ(some[i].value, others[i].value) << some[i].name;
}

TEST_P(FootprintContract, GivesTheSameProbabilitiesOnEveryInstructionSet) {
  std::vector<Eigen::VectorXd> found;
  for (const Instructions set : math::instruction_sets()) {
    const OnInstructions on(set);
    const auto footprint = fresh();
    take(*footprint, disc_touches(30));
    found.push_back(probability_of(*footprint, lattice(23, 23)));
    EXPECT_LT((found.back() - found.front()).cwiseAbs().maxCoeff(), 1e-9) << math::name_of(set);
  }
}

TEST_P(FootprintContract, TellsFiniteNumbersOfTheSameNamesAtEachTouch) {
  const auto names_of = [](const std::vector<FootprintNumber>& numbers) {
    std::vector<std::string> out;
    for (const FootprintNumber& one : numbers) out.push_back(one.name);
    return out;
  };
  const std::vector<std::string> first = names_of(fresh()->numbers());
  for (const auto& [what, touches] : trying_touches()) {
    const auto footprint = fresh();
    for (const Touch& touch : touches) {
      footprint->add(touch);
      const std::vector<FootprintNumber> numbers = footprint->numbers();
      EXPECT_EQ(names_of(numbers), first) << what;
      for (const FootprintNumber& one : numbers) EXPECT_TRUE(std::isfinite(one.value)) << what << ": " << one.name;
      const double left = footprint->undiscovered_probability().value_or(0.0);
      EXPECT_TRUE(left >= 0.0 && left <= 1.0) << what << ": " << left;
      EXPECT_EQ(footprint->remark().find('\n'), std::string::npos);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, FootprintContract, testing::ValuesIn(footprint_cases()),
                         [](const auto& one) { return one.param.name; });

// The cases above would quietly be fewer if a config named a plugin that is not there.
TEST(FootprintConfigs, NameEveryFootprintThatThereIs) {
  std::vector<std::string> named;
  for (const std::filesystem::path& file : shipped_files()) named.push_back(shipped_case(file).type);
  std::vector<std::string> shipped;
  for (const PluginListing& row : shared_host().list("footprint", "")) shipped.push_back(row.name);
  EXPECT_THAT(named, testing::UnorderedElementsAreArray(shipped));
}

}  // namespace
}  // namespace palpate::test
