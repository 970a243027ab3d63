// SPDX-License-Identifier: MIT
// The guarded tap decides on recorded descents as their verdicts say: tests/data/guarded_taps/README.md.
#include "support/tap_trace.hpp"
#include "support/filled.hpp"
#include "support/testing.hpp"
#include "tapping/guarded_tap.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <iterator>

namespace palpate::tapping {
namespace {

/// The tap that goes by a trace, and when its set-point stopped last, or when it ended where it never did, s.
struct Replay {
  GuardedTap tap;
  double decided = -1.0;
};

Replay replay(const test::TapTrace& trace) {
  const auto motion = test::filled<MotionOptions>(trace.motion);
  Replay out{GuardedTap(motion, plan_descent(motion, 0.0, {}), GuardedTap::ArmKind::real)};
  for (const test::TapTrace::Row& row : trace.rows) {
    if (out.tap.done()) break;
    const int before = out.tap.noticed();
    out.tap.next(row.height, row.force);
    // The last one counts: those before were not believed.
    if (out.tap.noticed() > before) out.decided = row.time;
    if (out.tap.done() && out.tap.result().outcome == Outcome::no_contact) out.decided = row.time;
  }
  return out;
}

TEST(TapTrace, IsDecidedAsItsVerdictSays) {
  int contacts = 0;
  int none = 0;
  for (const std::filesystem::path& file : test::recorded_traces()) {
    const test::TapTrace trace = test::read_trace(file);
    if (trace.verdict == test::TapTrace::Verdict::fault) continue;
    const bool contact = trace.verdict == test::TapTrace::Verdict::contact;
    ++(contact ? contacts : none);
    const Replay replayed = replay(trace);
    const HeightResult& result = replayed.tap.result();
    SCOPED_TRACE(file.filename().string() + ": " + trace.what);
    EXPECT_TRUE(replayed.tap.done());
    EXPECT_EQ(result.outcome, contact ? Outcome::contact : Outcome::no_contact) << result.reason;
    EXPECT_GE(replayed.decided, trace.not_before) << "s, too early";
    EXPECT_LE(replayed.decided, trace.by) << "s, too late";
    if (contact) {
      EXPECT_NEAR(result.height, trace.height, trace.tolerance);
    }
  }
  EXPECT_GE(contacts, 7);
  EXPECT_GE(none, 1);
}

TEST(TapTrace, ThatIsNoneIsRejectedWithItsFileAndWhatIsWrong) {
  const std::filesystem::path sound = test::source_folder() / "tests/data/guarded_taps/hard.csv";
  std::ifstream in(sound);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string out = text;
    out.replace(out.find(from), from.size(), to);
    return out;
  };
  const std::size_t rows = text.find("force_n,sender\n") + std::string("force_n,sender\n").size();
  const std::pair<std::string, const char*> cases[] = {
      {changed("verdict: contact", "verdict: contcat"), "there is no verdict 'contcat'"},
      {changed("# by_s", "# bye_s"), "there is no field by_s"},
      {changed("time_s", "time"), "the columns are 'time,"},
      {text + "9.9,0.1\n", "'9.9,0.1' is no row"},
      {text + "999,0.1,nan,0\n", "'999,0.1,nan,0' is no row"},
      {text + "999,0.1,1,0,5\n", "'999,0.1,1,0,5' is no row"},
      {text + "0.0,0.1,1,0\n", "'0.0,0.1,1,0' is earlier than the row before"},
      {text.substr(0, rows), "there are no rows"}};
  const test::TemporaryFolder folder;
  for (const auto& [content, reason] : cases) {
    const std::filesystem::path file = folder.path() / "trace.csv";
    std::ofstream(file) << content;
    try {
      test::read_trace(file);
      ADD_FAILURE() << "nothing is wrong, not: " << reason;
    } catch (const std::runtime_error& trouble) {
      EXPECT_THAT(trouble.what(), testing::StartsWith(file.string() + ": "));
      EXPECT_THAT(trouble.what(), testing::HasSubstr(reason));
    }
  }
}

}  // namespace
}  // namespace palpate::tapping
