// SPDX-License-Identifier: MIT
// Backend that taps through another program. The program reads each request from its stdin and writes the answer to its
// stdout, one line each.
//
// One rule covers all failures. An answer with the number of the tap keeps the program running, even if its fields are
// rejected. After anything else (timeout, invalid line, additional line, end of the program), the next line could
// belong to any tap, and the arm may still move. So the tap fails and the program is ended before tap() returns. The
// next tap starts the program again if taps are repeatable or `restart` is set; otherwise the run ends, so that a
// person can check the arm. No late answer is taken for another tap, and the record contains every failure.
#include "process/protocol.hpp"
#include "programs/child.hpp"
#include "programs/command.hpp"
#include "tapping/motion.hpp"

#include <palpate/error.hpp>

#include <chrono>
#include <memory>

#include <fmt/format.h>

namespace palpate::backends {

using programs::Child;

struct ProcessOptions : Options {
  std::string command;
  std::string checksum;
  double deadline = 90.0;
  double start = 30.0;
  bool repeatable = false;
  bool restart = false;
  bool scene_is_truth = false;
  tapping::BackendMotion motion;

  void list(Fields& fields) override {
    const auto words = programs::list_command(command, fields);
    if (words && checksum.empty()) checksum = programs::content_of(*words).checksum;
    programs::list_checksum(checksum, fields);
    fields.real(deadline,
                Field("deadline",
                      "time limit of the answer to a tap. After this time, the tap fails and palpate ends the program")
                    .in(Unit::second)
                    .above(0)
                    .at_most(86400)
                    .from("longer than motion.timeout, which the program itself should report"));
    fields.real(start, Field("start", "time added to the deadline of a tap that has to start the program")
                           .in(Unit::second)
                           .at_least(0)
                           .at_most(86400)
                           .from("an estimate: drivers of robots take seconds"));
    fields.flag(repeatable, Field("repeatable",
                                  "whether a tap can be repeated without risk and with the same answer. If false, "
                                  "palpate records each tap before the arm moves"));
    fields.flag(restart, Field("restart",
                               "whether a program that ended is started again for the next tap, even with `repeatable: "
                               "false`. If `restart` and `repeatable` are false, the run fails"));
    fields.flag(
        scene_is_truth,
        Field("scene_is_truth",
              "whether the program taps the scene of the config. If true, errors are computed from this scene"));
    fields.section(motion, Field("motion", "motion of the arm in a tap, sent to the program in SI units"));
  }
};

class Process final : public Backend {
 public:
  using Options = ProcessOptions;

  /// Throws Error if the program does not exist or its checksum differs from the option.
  Process(const Options& options, const Context& context)
      : options_(options),
        context_(context),
        words_(programs::split_command(options.command).value()),
        file_(programs::find_checked(options.command, words_, {}, options.checksum)) {}

  TapResult tap(const TapRequest& request) override {
    const auto begin = Clock::now();
    double seconds = options_.deadline;
    // The program starts with the first tap, because the folder of the record does not exist earlier.
    if (!child_) {
      start(patience(begin, options_.start));
      seconds += options_.start;
    }
    process::Answer answer = child_ ? ask(request, patience(begin, seconds)) : left_behind();
    if (!answer.in_step) {
      child_.reset();
      if (answer.result.ends_run) answer.result.reason += "; check the robot, then run 'palpate resume --retry-failed'";
    }
    if (!answer.accepted) answer.result.seconds = Seconds(Clock::now() - begin).count();
    return std::move(answer.result);
  }

  std::vector<std::string> describe(const TapRequest& request) override {
    const std::optional<Target> from = request.previous ? std::optional(request.previous->target()) : std::nullopt;
    std::vector<std::string> out =
        tapping::describe(options_.motion.of_request(request), context_.scene.desk(), request, from);
    out.insert(out.begin(),
               fmt::format("{} {}, which has {:g} s, for this motion:", child_ ? "ask" : "start",
                           programs::shown(options_.command), options_.deadline + (child_ ? 0.0 : options_.start)));
    return out;
  }

  bool repeatable() const override { return options_.repeatable; }
  bool scene_is_truth() const override { return options_.scene_is_truth; }
  QuantitySet predicts() const override { return tapping::predicts(options_.motion); }
  static std::unique_ptr<Motions> motions(const Options& options, const Scene& scene) {
    return tapping::motions(options.motion, scene.desk());
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Seconds = std::chrono::duration<double>;

  static constexpr const char* kLock = "process.lock";

  programs::WaitLimit patience(Clock::time_point begin, double seconds) const {
    return {begin + std::chrono::duration_cast<Clock::duration>(Seconds(seconds)), context_.interrupted};
  }

  /// Returns the path of a file in the record's folder, or an empty string without a record.
  std::string recorded(const char* name) const {
    return context_.directory.empty() ? std::string() : context_.directory + "/" + name;
  }

  /// Starts the program. If taps are not repeatable, it first waits until no program of an earlier attempt runs,
  /// because two must not move one arm. If one still runs at the end of `patience`, child_ stays empty.
  void start(const programs::WaitLimit& patience) {
    Descriptor lock;
    if (!options_.repeatable && !context_.directory.empty()) {
      lock = programs::lock_file(recorded(kLock), patience);
      if (!lock) return;
    }
    child_ = std::make_unique<Child>(Program{words_, file_}, recorded("process.stderr.txt"), lock);
    if (lock) programs::write_holder(lock, child_->pid());
  }

  process::Answer left_behind() const {
    if (context_.interrupted != nullptr && context_.interrupted->load()) return interrupted();
    process::Answer answer = failed("of an earlier attempt, process " + programs::read_holder(recorded(kLock)) +
                                    ", is still running: end it");
    answer.result.ends_run = true;
    return answer;
  }

  HeightBounds bounds_of(const tapping::MotionOptions& motion) const {
    return height_bounds(context_.scene.desk(), motion.overrun, motion.hover);
  }

  bool may_restart() const { return options_.repeatable || options_.restart; }

  process::Answer ask(const TapRequest& request, const programs::WaitLimit& patience) {
    std::string line;
    process::Answer answer;
    // A line before the request is not an answer to it. The arm must not move then.
    Child::ReadResult heard = child_->read(line, {Clock::now(), context_.interrupted});
    if (heard == Child::ReadResult::complete) return failed("printed more than its answer: " + programs::shown(line));
    if (heard == Child::ReadResult::late) {
      tapping::MotionOptions motion = options_.motion.of_request(request);
      heard = child_->send(process::ask_line(request, context_, motion), patience);
      if (heard == Child::ReadResult::complete) heard = child_->read(line, patience);
    }
    switch (heard) {
      case Child::ReadResult::complete:
        answer = process::read_answer(line, request, bounds_of(options_.motion.of_request(request)));
        answered_ = true;
        if (!answer.in_step && !may_restart()) answer.result.ends_run = true;
        return answer;
      case Child::ReadResult::ended:
        return failed(child_->describe_end());
      case Child::ReadResult::late:
        return failed(
            line.empty() ? not_answered() : "sent an incomplete answer until the deadline: " + programs::shown(line),
            Outcome::timeout);
      case Child::ReadResult::too_long:
        return failed("answered with a line that is too long: " + programs::shown(line));
      case Child::ReadResult::interrupted:
        break;
    }
    return interrupted();
  }

  /// The most frequent cause of a missing first answer is output buffering in the program.
  std::string not_answered() const {
    return std::string("did not answer in time") +
           (answered_ ? "" : " and has never answered, check that it flushes its output after each line");
  }

  static process::Answer interrupted() {
    return {false, false, tap_without_contact(Outcome::aborted, 0.0, "interrupted")};
  }

  process::Answer failed(const std::string& what, Outcome outcome = Outcome::aborted) const {
    return {false, false, tap_without_contact(outcome, 0.0, "the program " + what, !may_restart())};
  }

  Options options_;
  const Context& context_;
  std::vector<std::string> words_;
  std::string file_;
  std::unique_ptr<Child> child_;
  bool answered_ = false;  ///< whether any started program has answered
};

PALPATE_PLUGIN(Backend, Process, "process",
               "any program that answers requests for taps. Requests and answers are JSON lines")

}  // namespace palpate::backends
