// SPDX-License-Identifier: MIT
// What becomes of a run when its program is gone.
#include "unit/process_backend.hpp"

#include <memory>

namespace palpate::test {
namespace {

constexpr const char* kSeeToIt = "; see to the robot, then 'palpate resume --retry-failed' starts it again";

/// What a program does for its second tap, so that nobody knows what its arm does, and what is said of it.
struct Gone {
  const char* name;
  std::string odd;
  std::string reason;
  std::string deadline = "90 s";
};

class ProgramThatIsGone : public ProcessBackend, public testing::WithParamInterface<Gone> {
 protected:
  /// Two taps of a program that notes each of its starts.
  Contact second_tap_of(const std::string& more) {
    backend_ = plain(command("print('begin', file=sys.stderr, flush=True)\n"
                             "for ask in asks():\n    if ask['tap'] != 2: contact(ask)\n    else:\n        " +
                             GetParam().odd),
                     ", deadline: " + GetParam().deadline + more);
    expect_contact(tap(*backend_, 1));
    return tap(*backend_, 2);
  }

  std::shared_ptr<Backend> backend_;
};

TEST_P(ProgramThatIsGone, EndsARunWhoseTapsCannotBeRepeated) {
  const Contact contact = second_tap_of("");
  EXPECT_TRUE(contact.ends_run);
  EXPECT_EQ(contact.reason, GetParam().reason + kSeeToIt);
  EXPECT_EQ(diary(), "begin\n");
}

TEST_P(ProgramThatIsGone, IsStartedAgainIfTheConfigSaysSo) {
  for (const char* more : {", restart: true", ", repeatable: true"}) {
    fs::remove(folder_.path() / "record" / "process.stderr.txt");
    const Contact contact = second_tap_of(more);
    EXPECT_FALSE(contact.ends_run);
    EXPECT_EQ(contact.reason, GetParam().reason);
    expect_contact(tap(*backend_, 3));
    EXPECT_EQ(diary(), "begin\nbegin\n");
  }
}

INSTANTIATE_TEST_SUITE_P(
    By, ProgramThatIsGone,
    testing::Values(Gone{"Exit", "os._exit(3)", "the program ended with exit status 3, its last words: 'begin'"},
                    Gone{"Signal", "os.kill(os.getpid(), 9)",
                         "the program was ended by signal 9 (Killed), its last words: 'begin'"},
                    Gone{"Silence", "time.sleep(60)", "the program did not answer in time", "1 s"},
                    Gone{"Garbage", "print('moving', flush=True)", "the answer is not JSON: 'moving'"},
                    Gone{"AnotherTap", "print('{\"tap\": 7}', flush=True)",
                         "the answer is not that to tap 2: '{\"tap\": 7}'"}),
    [](const auto& one) { return one.param.name; });

}  // namespace
}  // namespace palpate::test
