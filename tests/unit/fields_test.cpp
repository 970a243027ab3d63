// SPDX-License-Identifier: MIT
#include "record/fields.hpp"

#include "record/json.hpp"
#include "support/field_table.hpp"
#include "support/testing.hpp"

#include <fstream>

namespace palpate::test {
namespace {

using ::testing::HasSubstr;

TEST(SummaryFields, AreThoseThatARunWrites) {
  const TemporaryFolder folder;
  const std::string paper = (source_folder() / "configs/paper/object_i.yaml").string();
  ASSERT_EQ(palpate({"run", paper, "--quiet"}, folder.path()).status, 0);
  const auto summary = parse_json_row(test::text_of(test::only_run(folder.path() / "runs") / "summary.json"));
  ASSERT_TRUE(summary);
  for (const RecordField& field : summary_fields()) {
    if (field.meaning.rfind("from any side", 0) == 0 || field.name == "relabelled") continue;  // for other configs
    const Scalar* value = summary->find(field.name);
    ASSERT_NE(value, nullptr) << field.name;
    EXPECT_EQ(std::holds_alternative<std::string>(*value), field.type == RecordField::Type::text) << field.name;
    EXPECT_EQ(std::holds_alternative<bool>(*value), field.type == RecordField::Type::flag) << field.name;
  }
  for (const auto& [name, value] : summary->fields) {
    if (name.find("_gp.") != std::string::npos) continue;
    EXPECT_NE(find_summary_field(name), nullptr) << name << " is not listed";
  }
}

TEST(SummaryFields, HaveTheUnitThatTheirNamesEndIn) {
  EXPECT_EQ(unit_of_column("rmse_m"), Unit::metre);
  EXPECT_EQ(unit_of_column("compute.infer"), Unit::second);
  EXPECT_EQ(unit_of_column("drift_m"), Unit::metre) << "not listed";
  EXPECT_EQ(unit_of_column("idle_seconds"), Unit::second) << "not listed";
  EXPECT_EQ(unit_of_column("footprint_iou"), Unit::none);
}

TEST(Fields, AreWhatTheTablesOfTheFormatSay) {
  const std::string format = test::text_of(test::source_folder() / "runs/README.md");
  EXPECT_THAT(format, HasSubstr(test::table_of(tap_list())));
  EXPECT_THAT(format, HasSubstr(test::table_of(timing_list())));
  EXPECT_THAT(format, HasSubstr(test::table_of(summary_list())));
  EXPECT_THAT(format, HasSubstr(test::table_of(object_list())));
}

TEST(Fields, OfDiagnosticsAreAllThatARunCounts) {
  RunResult result;
  result.state.diagnostics = {{"jitter", 3}};
  const Row row = summary_list().row({result, ResolvedConfig{}, "", {}, {}, {}, {}});
  EXPECT_EQ(row.number("diagnostics.jitter"), 3.0);
  EXPECT_EQ(row.number("diagnostics.fallback"), 0.0);
}

TEST(Fields, OfAnErrorAreFoundAgainInTheirRow) {
  Row row;
  add_errors(row, {1.0, 2.0, {}, 0.5});
  EXPECT_EQ(row.fields.size(), 4U) << "those of taps from above";
  EXPECT_EQ(main_error({Row{}, row}), "rmse_m");
  const Errors back = errors_in(row);
  EXPECT_EQ(back.rmse, 1.0);
  EXPECT_EQ(back.rmse_object, 2.0);
  EXPECT_FALSE(back.rmse_height);
  EXPECT_EQ(back.footprint_iou, 0.5);
  Row any_side;
  add_errors(any_side, {{}, 2.0, {}, {}, 0.25, 0.5, 0.75, 0.875, 0.125});
  EXPECT_EQ(any_side.fields.size(), error_fields().size());
  EXPECT_EQ(main_error({Row{}, any_side}), "rms_surface_distance_m");
  EXPECT_EQ(main_error({any_side, row}), "rmse_m") << "of some from above and some from any side";
  EXPECT_EQ(main_error({}), "rmse_m");
  EXPECT_EQ(errors_in(any_side).overall(), 0.5);
  EXPECT_EQ(errors_in(any_side).surface_distance, 0.25);
  EXPECT_EQ(errors_in(any_side).f_score, 0.75);
  EXPECT_EQ(errors_in(any_side).coverage, 0.875);
  EXPECT_EQ(errors_in(any_side).volume_iou, 0.125);
}

}  // namespace
}  // namespace palpate::test
