// SPDX-License-Identifier: MIT
// What satisfies a condition: the one rule, and that everything in core asks it.
#include "config/comparison.hpp"

#include "record/evaluation_point.hpp"
#include "record/json.hpp"
#include "support/testing.hpp"

#include <cmath>
#include <limits>

namespace palpate::test {
namespace {

constexpr Relation kRelations[] = {Relation::at_least, Relation::above, Relation::at_most,
                                   Relation::below,    Relation::equal, Relation::unequal};
constexpr double kBeyond = std::numeric_limits<double>::infinity();
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

TEST(Satisfies, ComparesFiniteValuesAsTheirSignsSay) {
  const auto held = [](double value, double bound) {
    std::string out;
    for (const Relation one : kRelations) {
      if (satisfies(value, one, bound)) out += std::string(sign_of(one)) + " ";
    }
    return out;
  };
  EXPECT_EQ(held(2.0, 1.0), ">= > != ");
  EXPECT_EQ(held(1.0, 1.0), ">= <= == ");
  EXPECT_EQ(held(0.0, 1.0), "<= < != ");
  EXPECT_EQ(held(-0.0, 0.0), ">= <= == ");
}

TEST(Satisfies, IsFalseOfWhatIsMissingOrNotFiniteWhateverIsAsked) {
  for (const Relation one : kRelations) {
    for (const double bound : {-1.0, 0.0, 1.0, kBeyond, -kBeyond, kNoNumber}) {
      EXPECT_FALSE(satisfies(std::nullopt, one, bound)) << sign_of(one) << bound;
      for (const double value : {kNoNumber, -kNoNumber, kBeyond, -kBeyond})
        EXPECT_FALSE(satisfies(value, one, bound)) << value << sign_of(one) << bound;
    }
  }
}

TEST(Satisfies, ReadsTheSignsThatItWrites) {
  for (const Relation one : kRelations) EXPECT_EQ(relation_of(sign_of(one)), one);
  for (const char* other : {"", "=", "=>", "<>", ">= "}) EXPECT_FALSE(relation_of(other)) << other;
}

TEST(Checkpoint, NeverComesForAnErrorThatIsNotFinite) {
  const Checkpoint good = Checkpoint::once("rmse_m=8 mm");
  const Checkpoint covered = Checkpoint::once("footprint_iou=0.5");
  for (const double value : {kNoNumber, kBeyond, -kBeyond}) {
    Row summary;
    summary.add("rmse_m", value);
    summary.add("footprint_iou", value);
    EXPECT_FALSE(good.has_come(9, summary)) << value;
    EXPECT_FALSE(covered.has_come(9, summary)) << value;
  }
}

TEST(Row, HasNoNumberWhereItsFileHasNull) {
  for (const double value : {kNoNumber, kBeyond, -kBeyond}) {
    Row row;
    row.add("rmse_m", value);
    EXPECT_EQ(to_json_line(row), "{\"rmse_m\": null}");
    EXPECT_FALSE(row.number("rmse_m")) << value;
  }
}

}  // namespace
}  // namespace palpate::test
