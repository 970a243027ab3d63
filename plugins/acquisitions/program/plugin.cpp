// SPDX-License-Identifier: MIT
// Acquisition that another program computes. The program reads arrays from its stdin and writes the scores to its
// stdout. The protocol is in framework/docs/strategies.md.
//
// The program starts when the first score is needed. It starts only in a run, because only then the context has a
// folder. Commands that read records never start it. The only valid answer is one array of finite scores in time. Any
// other answer ends the program and the run. Examples of such answers are an end of the program, a timeout, another
// shape, NaN, and an additional byte. A resumed run starts the same program again. A late answer can therefore not be
// mistaken for the answer of another tap.
#include "program/maps.hpp"
#include "programs/child.hpp"
#include "programs/command.hpp"
#include "reading/npy.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/plugin.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>
#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>

namespace palpate::acquisitions {
namespace {

namespace fs = std::filesystem;
using programs::Child;
using programs::shown;

/// Version of the protocol, which is part of every request. It increases if the meaning of a request or an answer
/// changes.
constexpr int kProtocol = 1;

constexpr const char* kNoArray = "none";

/// Returns all names in a text, separated in any way. The name `none` stands for no name.
std::vector<std::string> names_in(const std::string& text) {
  constexpr const char* kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  std::vector<std::string> out;
  if (text == kNoArray) return out;
  for (std::size_t at = 0; (at = text.find_first_of(kLetters, at)) != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_not_of(kLetters, at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end;
  }
  return out;
}

/// Returns the text in the brackets of each `reads=[...]` in the source text of a program. The program is not executed.
std::set<std::string> declarations(const std::string& program) {
  constexpr std::size_t kMost = 1000;
  std::set<std::string> out;
  const std::string word = "reads";
  for (std::size_t at = program.find(word); at != std::string::npos; at = program.find(word, at + 1)) {
    std::size_t next = program.find_first_not_of(" \t", at + word.size());
    if (next == std::string::npos || program[next] != '=') continue;
    next = program.find_first_not_of(" \t", next + 1);
    if (next == std::string::npos || program[next] != '[') continue;
    const std::size_t end = program.find(']', next);
    if (end == std::string::npos || end - next > kMost) continue;
    const std::vector<std::string> names = names_in(program.substr(next + 1, end - next - 1));
    out.insert(names.empty() ? kNoArray : fmt::format("{}", fmt::join(names, ", ")));
  }
  return out;
}

/// Returns the names of all arrays, separated by commas: "uncertainty, label_mean, ...".
std::string all_names() {
  std::vector<const char*> names;
  for (const program::ProgramMap& one : program::maps()) names.push_back(one.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

/// Returns whether a word of the command names a file that is in the parent of `folder` but not in `folder`.
bool lies_above(const std::vector<std::string>& words, const fs::path& folder) {
  std::error_code none;
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return fs::is_regular_file(folder.parent_path() / word, none) && !fs::exists(folder / word, none);
  });
}

/// Returns the folder of palpate_acquisition.py. In a build, a package and an installation by pip, it is next to the
/// folder of this library. The folders must differ, because Python would otherwise import random.so as its module
/// `random`.
std::string python_folder() {
  Dl_info self{};
  std::error_code none;
  if (::dladdr(reinterpret_cast<const void*>(&python_folder), &self) == 0 || self.dli_fname == nullptr) return {};
  return (fs::weakly_canonical(self.dli_fname, none).parent_path().parent_path() / "python").string();
}

/// Returns a value for PYTHONPATH: the entries of the user, followed by the folder of palpate_acquisition.py.
std::string python_path() {
  const char* const before = std::getenv("PYTHONPATH");
  return std::string("PYTHONPATH=") + (before != nullptr && *before != '\0' ? std::string(before) + ":" : "") +
         python_folder();
}

}  // namespace

struct ProgramOptions : Options {
  std::string command;
  std::string folder;
  std::string checksum;
  std::string reads;
  double deadline = 60.0;
  double start = 60.0;

  void list(Fields& fields) override {
    const auto words = programs::list_command(command, fields);
    if (words && folder.empty()) folder = fs::current_path().string();
    fields.text(folder, Field("folder", "working folder of the program (absolute path); not given: the current folder")
                            .not_identifying());
    fields.require(folder.empty() || fs::path(folder).is_absolute(), "folder",
                   "is not an absolute path, which a resume in another folder needs; begin it with /");
    programs::ProgramFingerprint content;
    if (words) content = programs::content_of(*words, folder);
    if (words && checksum.empty()) checksum = content.checksum;
    programs::list_checksum(checksum, fields);
    const std::set<std::string> declared = declarations(content.program);
    if (declared.size() == 1) reads = *declared.begin();
    fields.text(reads, Field("reads",
                             "names of the arrays that the program receives, separated by commas; not given: read from "
                             "reads=[...] in the program. With `none`, the program receives no arrays"));
    fields.require(!words || !reads.empty(), "reads",
                   unsaid(words.value_or(std::vector<std::string>()), content.program, declared));
    // An unknown name is usually written in the program, so the error then refers to the program.
    const bool by_program = declared.size() == 1 && reads == *declared.begin();
    for (const std::string& name : names_in(reads))
      fields.require(program::find_map(name) != nullptr, by_program ? "command" : "reads",
                     (by_program ? "reads=[...] in " + shown(content.file) + " has " : "has ") + shown(name) +
                         ", which is not one of " + all_names());
    fields.real(deadline, Field("deadline",
                                "time limit of the program's answer. After this time the run fails. 'palpate resume "
                                "--retry-failed' continues the run")
                              .in(Unit::second)
                              .above(0)
                              .at_most(86400)
                              .not_identifying());
    fields.real(start, Field("start", "time added to the deadline of the program's first scores")
                           .in(Unit::second)
                           .within(0, 86400)
                           .from("an estimate: large libraries take seconds to load")
                           .not_identifying());
  }

  std::string unsaid(const std::vector<std::string>& words, const std::string& program,
                     const std::set<std::string>& declared) const {
    if (program.empty() && lies_above(words, folder))
      return "is not given, and " + shown(command) + " names no file in " + shown(folder) +
             ": relative paths start in the current folder, so call palpate in " +
             shown(fs::path(folder).parent_path().string());
    if (program.empty())
      return "is not given, and " + shown(command) + " names no file in " + shown(folder) +
             " with reads=[...]: relative paths start in the current folder";
    return declared.empty() ? "is given neither here nor by reads=[...] in the program"
                            : "is not given here, and the program has several reads=[...]";
  }
};

class ProgramAcquisition final : public Acquisition {
 public:
  using Options = ProgramOptions;

  /// In a run, throws Error if the program does not exist or its checksum differs from the option.
  ProgramAcquisition(const Options& options, const Context& context) : options_(options), context_(context) {
    for (const std::string& name : names_in(options.reads)) maps_.push_back(program::find_map(name));
    if (context.directory.empty()) return;
    words_ = programs::split_command(options.command).value();
    file_ = programs::find_checked(options.command, words_, options.folder, options.checksum);
  }

  QuantitySet reads() const override {
    QuantitySet out;
    for (const program::ProgramMap* one : maps_) out = out | one->reads;
    return out;
  }

  void score(const BeliefView& belief, VectorOut out) const override {
    std::vector<std::string> arrays;
    for (const program::ProgramMap* one : maps_) arrays.push_back(one->npy(belief, context_.scene.desk()));
    const Candidates& candidates = belief.candidates();
    std::string fields = fmt::format(R"("tap":{})", belief.taps().count + 1);
    if (candidates.fixed)
      fields += fmt::format(R"(,"initial_taps":{},"rows":{},"columns":{})", belief.taps().initial, candidates.rows,
                            candidates.columns);
    exchange(fields, arrays, out);
  }

  /// The magnitude of the scores before the first tap is unknown.
  double prior_scale() const override { return 0.0; }

 private:
  using Clock = std::chrono::steady_clock;
  using ReadResult = Child::ReadResult;

  [[noreturn]] void fail(const std::string& what, const std::string& remedy) const {
    child_.reset();
    throw Error("", "the program " + what, remedy, Error::Kind::run);
  }

  /// Throws Error about the end of the program. If NumPy is missing, the hint is to install it.
  [[noreturn]] void fail_ended(const std::string& fate) const {
    const std::string file = in_record(".stderr.txt");
    if (fate.find("No module named 'numpy'") != std::string::npos)
      fail(fate,
           "install NumPy for the Python of acquisition.command (Debian: apt install python3-numpy, for "
           "/usr/bin/python3)");
    fail(fate, "correct it, its output is in " + file);
  }

  /// Sends the arrays and receives the scores.
  void exchange(const std::string& fields, const std::vector<std::string>& arrays, VectorOut out) const {
    if (context_.directory.empty())
      throw Error("", "programs are started in a run only", "use the values that the run recorded", Error::Kind::run);
    double seconds = options_.deadline;
    if (!child_) {
      seconds += options_.start;
      ProgramCall program{words_, file_};
      program.folder = options_.folder;
      program.environment.insert(program.environment.begin(), python_path());
      programs::find_checked(options_.command, words_, options_.folder, options_.checksum);
      keep_program();
      child_ = std::make_unique<Child>(std::move(program), in_record(".stderr.txt"), FileDescriptor());
    }
    const programs::WaitLimit limit{
        Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds)),
        context_.interrupted};
    std::string bytes;
    // Output that arrives before the request cannot be an answer to it.
    if (child_->read(bytes, 1, {Clock::now(), context_.interrupted}) == ReadResult::complete)
      fail("printed more than its scores", "print other text to stderr");
    check(child_->send(ask(fields, arrays, out.size()), limit), {});
    try {
      check(child_->read(bytes, kNpyStart, limit), bytes);
      check(child_->read(bytes, program::header_length(bytes), limit), bytes);
      program::check_header(bytes, out.size());
    } catch (const std::runtime_error& wrong) {
      fail(fmt::format("answered with {}: {}", wrong.what(), shown(bytes)), kCorrect);
    }
    check(child_->read(bytes, static_cast<std::size_t>(out.size()) * sizeof(double), limit), bytes);
    std::memcpy(out.data(), bytes.data(), bytes.size());
    for (Eigen::Index i = 0; i < out.size(); ++i) {
      if (!std::isfinite(out(i)))
        fail(fmt::format("gave candidate {} the score {}, which is not a finite number", i, out(i)), kCorrect);
    }
    answered_ = true;
  }

  std::string ask(const std::string& fields, const std::vector<std::string>& arrays, Eigen::Index candidates) const {
    const Area area = context_.scene.area();
    std::string list;
    std::size_t bytes = 0;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      bytes += arrays[i].size();
      list += fmt::format(R"({}{{"name":"{}","bytes":{}}})", i == 0 ? "" : ",", maps_[i]->name, arrays[i].size());
    }
    std::string out = fmt::format(
        R"({{"palpate":{},{},"candidates":{},"area":{{"width":{},"depth":{}}},"desk":{},"seed":{},"arrays":[{}],"bytes":{}}})"
        "\n",
        kProtocol, fields, candidates, area.width, area.depth, context_.scene.desk(), context_.seed, list, bytes);
    for (const std::string& array : arrays) out += array;
    return out;
  }

  /// Throws Error unless `heard` shows that the expected output has arrived. `bytes` is the output that arrived
  /// instead.
  void check(ReadResult heard, const std::string& bytes) const {
    switch (heard) {
      case ReadResult::complete:
        return;
      case ReadResult::ended:
        fail_ended(child_->describe_end());
      case ReadResult::late:
        fail(bytes.empty() ? std::string("sent no scores in time") +
                                 (answered_ ? "" : " and has never sent any, check that it flushes its output")
                           : "sent incomplete scores until the deadline",
             "correct it, or raise acquisition.deadline; then run 'palpate resume --retry-failed'");
      case ReadResult::too_long:
      case ReadResult::interrupted:
        fail("was interrupted", "run 'palpate resume' to continue");
    }
  }

  /// Returns the path of a file of this program in the run's folder. If a sum contains several programs, each has its
  /// own files.
  std::string in_record(const std::string& ending) const {
    constexpr std::size_t kEnough = 8;
    return context_.directory + "/acquisition_" + options_.checksum.substr(0, kEnough) + ending;
  }

  /// Copies the program to the run's folder, because the original may change later.
  void keep_program() const {
    constexpr std::size_t kMostBytes = 1 << 20;  // larger than any hand-written program
    const programs::ProgramFingerprint content = programs::content_of(words_, options_.folder);
    if (content.program.empty() || content.program.size() > kMostBytes) return;
    programs::keep_copy(in_record(fs::path(content.file).extension().string()), content.program);
  }

  static constexpr const char* kCorrect = "correct it; a changed program makes a new run";

  Options options_;
  const Context& context_;
  std::vector<const program::ProgramMap*> maps_;
  std::vector<std::string> words_;
  std::string file_;
  mutable std::unique_ptr<Child> child_;  ///< mutable as a cache; score() is still a pure function of the belief
  mutable bool answered_ = false;         ///< whether any of the started programs has ever answered
};

PALPATE_PLUGIN(Acquisition, ProgramAcquisition, "program", "scores from a program of your own, in any language")

}  // namespace palpate::acquisitions
