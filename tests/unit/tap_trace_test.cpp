// SPDX-License-Identifier: MIT
// The guarded tap decides on recorded descents as their verdicts say: tests/data/guarded_taps/README.md.
#include "support/tap_trace.hpp"
#include "support/filled.hpp"
#include "support/testing.hpp"
#include "tapping/guarded_tap.hpp"

namespace palpate::tapping {
namespace {

TEST(TapTrace, IsDecidedAsItsVerdictSays) {
  int contacts = 0;
  for (const std::filesystem::path& file : test::recorded_traces()) {
    const test::TapTrace trace = test::read_trace(file);
    if (trace.verdict != test::TapTrace::Verdict::contact) continue;
    ++contacts;
    const auto motion = test::filled<MotionOptions>(trace.motion);
    GuardedTap tap(motion, plan_descent(motion, 0.0, {}), GuardedTap::Arm::real);
    double stopped = -1.0;
    for (const test::TapTrace::Row& row : trace.rows) {
      if (tap.done()) break;
      const int before = tap.noticed();
      tap.next(row.height, row.force);
      if (tap.noticed() > before) stopped = row.time;  // the last one counts: those before were not believed
    }
    SCOPED_TRACE(file.filename().string() + ": " + trace.what);
    EXPECT_TRUE(tap.done());
    EXPECT_EQ(tap.result().outcome, Outcome::contact) << tap.result().reason;
    EXPECT_GE(stopped, trace.not_before) << "s, before anything was touched";
    EXPECT_LE(stopped, trace.by) << "s, too late";
    EXPECT_NEAR(tap.result().height, trace.height, trace.tolerance);
  }
  EXPECT_GE(contacts, 7);
}

}  // namespace
}  // namespace palpate::tapping
