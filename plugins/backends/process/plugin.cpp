// SPDX-License-Identifier: MIT
// Backend that makes taps through another program. The program reads requests from its stdin and writes answers to its
// stdout. Each request and each answer is one line.
//
// The same rule applies to all failures. If an answer has the number of the tap, the program keeps running, even if
// other fields of the answer are rejected. Other events are a timeout, an invalid line, an additional line, and an end
// of the program. After such an event, the next line could belong to any tap, and the arm may still move. The tap then
// fails, and the program is ended before tap() returns. If taps are repeatable or `restart` is set, the next tap starts
// the program again. Otherwise the run ends, so that a person can check the arm. A late answer can therefore not be
// mistaken for the answer of another tap, and the record contains every failure.
#include "process/protocol.hpp"
#include "programs/child.hpp"
#include "programs/command.hpp"
#include "tapping/motion.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

#include <fmt/format.h>

namespace palpate::backends {

using programs::Child;

struct ProcessOptions : Options {
  std::string command;
  std::string checksum;
  std::int64_t protocol = 1;
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
    fields.integer(protocol, Field("protocol",
                                   "version of requests and answers. Version 2 has lines of any direction, "
                                   "which taps from any side need")
                                 .within(1, 2));
    fields.real(deadline,
                Field("deadline",
                      "time limit of the answer to a tap. After this time, the tap fails and palpate ends the program")
                    .in(Unit::second)
                    .above(0)
                    .at_most(86400)
                    .from("longer than motion.timeout, which the program itself should report"));
    fields.real(start, Field("start", "time added to the deadline of a tap that has to start the program")
                           .in(Unit::second)
                           .within(0, 86400)
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

class ChildProcessBackend final : public Backend {
 public:
  using Options = ProcessOptions;

  /// Throws Error if the program does not exist or its checksum differs from the option.
  ChildProcessBackend(const Options& options, const Context& context)
      : options_(options),
        context_(context),
        words_(programs::split_command(options.command).value()),
        file_(programs::find_checked(options.command, words_, {}, options.checksum)) {}

  TapResult tap(const TapRequest& request) override {
    const auto begin = Clock::now();
    tapping::MotionOptions motion = options_.motion.of_request(request);
    const Reply reply = ask(process::ask_line(request, context_, motion, protocol()));
    const bool is_line = reply.fault.empty();
    process::Answer answer{false, false, tap_without_contact(reply.outcome, 0.0, reply.fault, reply.ends_run)};
    if (is_line) answer = process::read_answer(reply.line, request, bounds_of(motion), protocol());
    if (!answer.in_step) {
      child_.reset();
      if (is_line && !may_restart()) answer.result.ends_run = true;
      if (answer.result.ends_run) answer.result.reason += "; check the robot, then run 'palpate resume --retry-failed'";
    }
    if (!answer.accepted) answer.result.seconds = Seconds(Clock::now() - begin).count();
    return std::move(answer.result);
  }

  bool taps_any_line() const override { return protocol() == ProtocolVersion::any_line; }

  void reaches(const Candidates& lines, BoolOut out) const override {
    out.setConstant(true);
    if (lines.from_above || !taps_any_line()) return;
    for (Eigen::Index first = 0; first < lines.size() && !reaches_all_; first += kMostLines) {
      const Eigen::Index count = std::min(kMostLines, lines.size() - first);
      const std::vector<bool> answer = ask_reaches(process::reaches_line(lines, first, count, context_), count);
      reaches_all_ = answer.empty();
      for (std::size_t i = 0; i < answer.size(); ++i) out(first + static_cast<Eigen::Index>(i)) = answer[i];
    }
  }

  std::vector<std::string> describe(const TapRequest& request) override {
    const std::optional<Target> from = request.previous ? std::optional(request.previous->target()) : std::nullopt;
    std::vector<std::string> out = request.line.from_above ? tapping::describe(options_.motion.of_request(request),
                                                                               context_.scene.desk(), request, from)
                                                           : std::vector{describe(request.line)};
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

  using ProtocolVersion = process::ProtocolVersion;

  static constexpr const char* kLock = "process.lock";
  static constexpr const char* kInterrupted = "interrupted";
  /// largest number of lines per question: about 64 KiB, which a pipe accepts at once
  static constexpr Eigen::Index kMostLines = 500;

  /// A line that the program printed, or the reason why there is no line.
  struct Reply {
    std::string line;
    std::string fault;  ///< reason why there is no line; "" if there is one
    Outcome outcome = Outcome::aborted;
    bool ends_run = false;
  };

  ProtocolVersion protocol() const { return static_cast<ProtocolVersion>(options_.protocol); }

  static std::string describe(const TapLine& line) {
    const auto words = [](const Eigen::Vector3d& vector, double factor) {
      return fmt::format("({:.4g}, {:.4g}, {:.4g})", factor * vector.x(), factor * vector.y(), factor * vector.z());
    };
    return fmt::format("from {} cm along {}, at most {}", words(line.start, 100.0), words(line.direction, 1.0),
                       tapping::centimetres(line.length));
  }

  programs::WaitLimit patience(Clock::time_point begin, double seconds) const {
    return {begin + std::chrono::duration_cast<Clock::duration>(Seconds(seconds)), context_.interrupted};
  }

  /// Returns the path of a file in the folder of the record. Returns "" if there is no record.
  std::string recorded(const char* name) const {
    return context_.directory.empty() ? std::string() : context_.directory + "/" + name;
  }

  /// Starts the program. If taps are not repeatable, first waits until no program of an earlier attempt runs, because
  /// two programs must not move one arm. If such a program still runs at the end of `patience`, child_ stays empty.
  void start(const programs::WaitLimit& patience) const {
    FileDescriptor lock;
    if (!options_.repeatable && !context_.directory.empty()) {
      lock = programs::lock_file(recorded(kLock), patience);
      if (!lock) return;
    }
    child_ = std::make_unique<Child>(ProgramCall{words_, file_}, recorded("process.stderr.txt"), lock);
    if (lock) programs::write_holder(lock, child_->pid());
  }

  Reply left_behind() const {
    if (context_.interrupted != nullptr && context_.interrupted->load()) return {{}, kInterrupted};
    Reply out = failed("of an earlier attempt, process " + programs::read_holder(recorded(kLock)) +
                       ", is still running: end it");
    out.ends_run = true;
    return out;
  }

  HeightBounds bounds_of(const tapping::MotionOptions& motion) const {
    return height_bounds(context_.scene.desk(), motion.overrun, motion.hover);
  }

  bool may_restart() const { return options_.repeatable || options_.restart; }

  /// Sends a question to the program and returns its reply. The first question starts the program, because the folder
  /// of the record does not exist earlier. If the program does not reply, it is ended.
  Reply ask(const std::string& question) const {
    const auto begin = Clock::now();
    double seconds = options_.deadline;
    if (!child_) {
      start(patience(begin, options_.start));
      seconds += options_.start;
    }
    Reply reply = child_ ? exchange(question, patience(begin, seconds)) : left_behind();
    if (!reply.fault.empty()) child_.reset();
    return reply;
  }

  Reply exchange(const std::string& question, const programs::WaitLimit& patience) const {
    std::string line;
    // A line that arrives before the request cannot be an answer to it. In this case, the request is not sent, so that
    // the arm does not move.
    Child::ReadResult heard = child_->read(line, {Clock::now(), context_.interrupted});
    if (heard == Child::ReadResult::complete) return failed("printed more than its answer: " + programs::shown(line));
    if (heard == Child::ReadResult::late) {
      heard = child_->send(question, patience);
      if (heard == Child::ReadResult::complete) heard = child_->read(line, patience);
    }
    switch (heard) {
      case Child::ReadResult::complete:
        answered_ = true;
        return {line, {}};
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
    return {{}, kInterrupted};
  }

  /// Asks which of `count` lines the program can reach. If the program may be started again, a failed question is
  /// repeated once, because it moves nothing. Returns one truth value per line. Returns an empty list if the program
  /// reaches all lines. Throws Error if there is no valid answer.
  std::vector<bool> ask_reaches(const std::string& question, Eigen::Index count) const {
    Reply reply = ask(question);
    if (!reply.fault.empty() && reply.fault != kInterrupted && may_restart()) reply = ask(question);
    if (reply.fault.empty()) {
      if (const auto answer = process::read_reaches(reply.line, count)) return *answer;
      child_.reset();
      reply = failed(fmt::format("has to answer 'reaches' with null or a text of {} digits 0 and 1, but printed {}",
                                 count, programs::shown(reply.line)));
    }
    throw Error("", reply.fault, "correct the cause, then run 'palpate resume --retry-failed'", Error::Kind::run);
  }

  /// If the first answer is missing, the most frequent cause is output buffering in the program.
  std::string not_answered() const {
    return std::string("did not answer in time") +
           (answered_ ? "" : " and has never answered, check that it flushes its output after each line");
  }

  Reply failed(const std::string& what, Outcome outcome = Outcome::aborted) const {
    return {{}, "the program " + what, outcome, !may_restart()};
  }

  Options options_;
  const Context& context_;
  std::vector<std::string> words_;
  std::string file_;
  // mutable, because even a question about lines may start the program
  mutable std::unique_ptr<Child> child_;
  mutable bool answered_ = false;     ///< whether any of the started programs has ever answered
  mutable bool reaches_all_ = false;  ///< whether the program has answered that it reaches all lines
};

PALPATE_PLUGIN(Backend, ChildProcessBackend, "process",
               "any program that answers requests for taps. Requests and answers are JSON lines")

}  // namespace palpate::backends
