// SPDX-License-Identifier: MIT
#include "cli/command_line.hpp"
#include "cli/display.hpp"
#include "cli/execute_run.hpp"
#include "cli/gate.hpp"
#include "cli/output.hpp"
#include "config/catch_error.hpp"
#include "config/expand.hpp"
#include "config/yaml.hpp"
#include "record/files.hpp"
#include "record/run_directory.hpp"
#include "scene/size_warnings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

#include <unistd.h>

namespace palpate::cli {
namespace {

struct RunArguments {
  std::string config;
  std::vector<std::string> overrides;
  std::string runs = "runs";
  bool json = false;
  bool quiet = false;
  bool dry_run = false;
  bool force = false;
  bool step = false;
  bool print_config = false;
  bool origins = false;
  bool identity = false;
  bool watch = false;
  std::string junit;
};

/// Prints the group files, and each value with its origin, such as file:line:column. Also prints the options that were
/// dropped because a later group chose another type.
void print_origins(const std::vector<Composer::Group>& groups, const ResolvedConfig& config) {
  for (const Composer::Group& one : groups) print_out("# {} {}: {}\n", one.path, one.name, one.file.string());
  std::size_t width = 0;
  std::vector<std::pair<std::string, std::string>> lines;
  for (const ResolveNotes::Origin& one : config.notes.origins) {
    std::string text = to_yaml(*config.tree.find_path(one.path));
    while (!text.empty() && text.back() == '\n') text.pop_back();
    lines.emplace_back(fmt::format("{}: {}", one.path, text), one.place);
    width = std::max(width, lines.back().first.size());
  }
  for (const auto& [text, place] : lines) print_out("{:<{}}  # {}\n", text, width, place);
  for (const ResolveNotes::Origin& one : config.notes.dropped)
    print_out("# dropped: {} from {}, the type chosen later has no such option\n", one.path, one.place);
}

/// Returns a clearer error if `trouble` is about an override that gives a key several values, which only `palpate
/// sweep` accepts. Otherwise returns `trouble`.
Error axis_error(const std::vector<Override>& overrides, const std::vector<std::string>& texts, const Error& trouble) {
  const auto mentions = [&](const std::string& text) { return trouble.reason().find(text) != std::string::npos; };
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const Override& one = overrides[i];
    const bool about = one.value.is_scalar() && trouble.where() == one.value.place.text() &&
                       (mentions(one.path + ":") || mentions("'" + one.value.text + "'"));
    // A comma between two digits is more often a decimal comma than a separator of a list.
    if (!about || mentions("decimal comma")) continue;
    ValueCount count;
    if (parse_axis(texts[i], count).values.size() < 2) continue;
    return Error(trouble.where(), fmt::format("{} has several values, but a run takes one", one.path),
                 "run all of them with 'palpate sweep'");
  }
  return trouble;
}

/// Prints the models that the run needs for the choice of taps, each with the parts of the run that read it. Each line
/// begins with `mark`. Throws Error for a config that cannot be run.
void print_models(const CommandEnvironment& program, const ResolvedConfig& config, const char* mark) {
  std::map<std::string, std::string> models;
  for (const PlannedModel& one : models_of(program, config)) {
    std::string& readers = models[one.model];
    readers += (readers.empty() ? "" : ", ") + one.reader;
  }
  print_out("{}models for the choice of taps{}\n", mark, models.empty() ? ": none" : ", and the parts that read them:");
  for (const auto& [model, readers] : models) print_out("{}  {}: {}\n", mark, model, readers);
}

/// Prints the resolved config in the form that the arguments select.
void print_resolved_config(const CommandEnvironment& program, const RunArguments& arguments,
                           const ResolvedConfig& config) {
  if (arguments.identity) {
    print_data(identity_text(config.notes));
  } else if (arguments.origins) {
    print_origins(program.composer.groups(), config);
  } else {
    print_data(to_yaml(config.tree));
    if (const auto no_run = catch_error([&] { print_models(program, config, "# "); }))
      print_out("# this config cannot be run: {}\n", no_run->what());
  }
}

void print_plan(const ResolvedConfig& config, const std::filesystem::path& directory) {
  const RunStatus status = read_status(directory);
  print_out("{}: {} taps of {} with {}, kernel {}, seed {}\n", config.options.name, config.options.taps,
            config.options.backend.type, config.options.acquisition.type, config.options.kernel.type,
            config.options.seed);
  print_out("{}: {}\n", directory.string(),
            status.state == RunStatus::State::absent ? "not run yet" : state_name(status.state));
}

/// Prints the command that builds all parts, if palpate-whole is not built yet and stderr is a terminal.
void offer_full_build(const CommandEnvironment& program) {
  if (::isatty(STDERR_FILENO) == 0 || is_there(program.installation.whole)) return;
  print_message(
      "sweeps, pages and the other plugins are built when a command first needs them; './palpate build' builds them "
      "now\n");
}

int run(CommandEnvironment& program, const RunArguments& arguments) {
  check_given_once(arguments.overrides);
  std::vector<Override> overrides;
  for (const std::string& text : arguments.overrides) overrides.push_back(parse_override(text));
  Tree composed;
  ResolvedConfig config;
  const std::optional<Error> trouble = catch_error([&] {
    composed = program.composer.compose(arguments.config, overrides);
    config = resolve_experiment(composed, program.host);
  });
  if (trouble) throw axis_error(overrides, arguments.overrides, *trouble);
  for (const auto& [block, use] :
       {std::pair("sweep", "'palpate sweep' runs all its jobs"), std::pair("tune", "'palpate tune' runs all its jobs"),
        std::pair("compare", "it plans a comparison of a sweep")}) {
    const Tree* found = composed.find(block);
    if (found == nullptr || arguments.quiet) continue;
    print_message(fmt::format("{}: {}: is ignored by 'palpate run'; {}\n", found->place.text(), block, use));
  }
  if (arguments.print_config) {
    print_resolved_config(program, arguments, config);
    return kDone;
  }
  const std::filesystem::path directory = directory_of(config, arguments.runs);
  if (arguments.dry_run) {
    print_models(program, config, "");
    print_plan(config, directory);
    return kDone;
  }
  check_junit(arguments.junit);
  RunOutput output{!arguments.quiet && !arguments.json, arguments.json, arguments.junit, arguments.step};
  if (arguments.watch) output.watched = directory;
  const int status = execute_run(program, config, output, [&](const std::vector<Observer*>& observers) {
    return start_run(program, config, directory, {arguments.force, TapMaker::by_backend, arguments.step}, observers);
  });
  if (arguments.quiet) return status;
  for (const std::string& line : partly_given_sizes(config.tree, config.notes)) print_message(line + "\n");
  offer_full_build(program);
  return status;
}

}  // namespace

void add_run(CommandLine& line) {
  auto [command, arguments] =
      line.add<RunArguments>("run", "Run one experiment", run, [](NeededParts& needs, const RunArguments& given) {
        if (given.watch) needs.whole();
        needs.config(given.config, given.overrides, false);
      });
  command.argument("CONFIG", arguments.config, "CONFIG", "YAML file of the experiment", {required()});
  command.argument("OVERRIDE", arguments.overrides, "KEY=VALUE",
                   "value that replaces the value in the config, for example kernel.length_scale=2cm for a key, or "
                   "kernel=matern52 for a config group");
  command.argument("--runs", arguments.runs, "FOLDER", kRunsHelp, {with_default()});
  command.flag("--json", arguments.json, "print summary.json and nothing else");
  const Argument quiet = command.flag("--quiet", arguments.quiet, "print nothing");
  command.flag("--dry-run", arguments.dry_run, "print the planned run, its directory and its models; nothing moves");
  command.flag("--force", arguments.force,
               "run again even if a run with the same id exists. The existing run is moved to another folder");
  command.flag("--step", arguments.step, kStepHelp, {not_with(quiet)});
  command.flag("--watch", arguments.watch, kWatchHelp);
  const Argument print = command.flag("--print-config", arguments.print_config, "print the resolved config and stop");
  const Argument origins =
      command.flag("--origins", arguments.origins,
                   "print each resolved value with the file or argument that set the value", {only_with(print)});
  command.flag("--identity", arguments.identity, "print the text that is hashed to make the id of the run",
               {only_with(print), not_with(origins)});
  command.argument("--junit", arguments.junit, "FILE", kJunitHelp);
  command.examples({"palpate run configs/paper/object_i.yaml",
                    "palpate run configs/default.yaml scene=ring kernel.length_scale=3cm seed=7"});
}

}  // namespace palpate::cli
