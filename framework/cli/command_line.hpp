// SPDX-License-Identifier: MIT
// The declaration of commands: name, arguments, examples, and the parts of the build that they need. CLI11 parses the
// command line into the variables that the declarations name.
#pragma once

#include "cli/build_targets.hpp"
#include "cli/command_context.hpp"
#include "record/catalogue.hpp"

#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpate::cli {

/// An option or positional argument of a command, and a function that configures it.
using Argument = CLI::Option*;
using Rule = std::function<void(CLI::Option&)>;

Rule required(bool is_required = true);
/// Shows the default in the help. The default is the value that the variable has at the declaration.
Rule with_default();
Rule at_least(int least);
Rule between(int least, int most);
Rule one_of(const std::vector<std::string>& values);
/// Reads several values from one word, separated by commas.
Rule comma_separated();
/// Reads one value per occurrence of the option. The option can then be repeated.
Rule one_per_option();
/// Lists the option below this heading in the help text.
Rule below(const std::string& heading);
/// Rejects a command line that has this option but lacks `other`.
Rule only_with(Argument other);
Rule not_with(Argument other);

/// A command while it is being declared.
class Command {
 public:
  using Rules = std::initializer_list<Rule>;

  /// `finds_records`: whether a run or sweep that does not exist causes an error.
  Command(CLI::App* app, bool finds_records) : app_(app), finds_records_(finds_records) {}

  /// Adds an option or a positional argument. The names of options begin with a dash. `of` is the name of the value in
  /// the help. A value is a text or a whole number. It may be optional, or a list.
  template <class Value>
  Argument argument(const char* name, Value& value, const char* of, const std::string& help, Rules rules = {}) const;
  Argument flag(const char* name, bool& value, const std::string& help, Rules rules = {}) const;

  /// Adds a required argument that names a run or sweep, or several of them. The variable receives the directories that
  /// find_record() returns.
  template <class Texts>
  void record(const char* name, Texts& directories, RecordKind wanted, const std::string& help) const;
  /// Adds a required argument that names sweeps and runs, which are pooled into one sweep. The variable receives the
  /// words of the command line, as find_records() takes them.
  void pooled_records(std::vector<std::string>& words) const;

  /// Sets the example commands in the help text.
  void examples(const std::vector<std::string>& lines) const;

 private:
  CLI::App* app_;
  bool finds_records_;
};

/// The command line of the program.
class CommandLine {
 public:
  /// `is_query`: whether the program only prints completions, or the build targets that a command needs, and performs
  /// no command.
  CommandLine(const Installation& installation, bool is_query);
  ~CommandLine();

  /// Adds a command and returns it with its arguments, which live as long as this object. `function` performs the
  /// command and returns the exit status. In the program `palpate` (not `palpate-whole`), `function` may be null (see
  /// PALPATE_WHOLE). `needed` adds the parts of the build that the command needs.
  template <class Arguments>
  std::pair<Command, Arguments&> add(const char* name, const char* help,
                                     int (*function)(CommandEnvironment&, const Arguments&),
                                     void (*needed)(NeededParts&, const Arguments&)) {
    auto arguments = std::make_shared<Arguments>();
    const Command command =
        add(name, help,
            {[=](CommandEnvironment& program) { return call_in_whole(function, program, *arguments); },
             [=](NeededParts& needs) { needed(needs, *arguments); }});
    return {command, *arguments};
  }

  /// Parses the words of the command line. Returns an exit status if nothing remains to be done, as after --help and
  /// --version. Throws Error of kind `usage`.
  std::optional<int> parse(int argc, char** argv);
  int perform(CommandEnvironment& program) const { return chosen_.perform(program); }
  void need(NeededParts& needs) const { chosen_.need(needs); }

  CLI::App& app() { return *app_; }

 private:
  struct Actions {
    std::function<int(CommandEnvironment&)> perform;
    std::function<void(NeededParts&)> need;
  };
  Command add(const char* name, const char* help, Actions actions);

  std::unique_ptr<CLI::App> app_;
  bool is_query_;
  Actions chosen_;  ///< actions of the command that was parsed
};

/// Adds the command `named`. If there is no such command, adds all commands in the order of `--help`. Adding all
/// commands would take a tenth of the time of a short run.
void add_commands(CommandLine& line, const std::string& named);

/// Values of `needed` for commands whose needs do not depend on their arguments. The commands need palpate-whole, or
/// palpate-whole and all plugins.
constexpr auto kNeedsWhole = [](NeededParts& needs, const auto&) { needs.whole(); };
constexpr auto kNeedsEverything = [](NeededParts& needs, const auto&) { needs.everything(); };

constexpr const char* kRunsHelp = "folder in which the run directories are made";
constexpr const char* kJunitHelp = "output file in JUnit XML format, with the results of all runs and expectations";
constexpr const char* kStepHelp =
    "for a robot: before each tap, show position, path and force limits, and wait for an answer. Enter makes the tap, "
    "q interrupts the run. 'palpate resume' continues the run";
constexpr const char* kWatchHelp =
    "serve a web page that follows the run or sweep, and print the address of the page. The server ends as with "
    "'palpate watch --until-left'";
constexpr int kMaxWorkers = 1024;

}  // namespace palpate::cli
