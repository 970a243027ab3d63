// SPDX-License-Identifier: MIT
// The command line: which commands there are, what they are called with, and what becomes of errors.
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "cli/interrupt.hpp"
#include "cli/needs.hpp"
#include "config/tree.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdio>
#include <string_view>
#include <utility>

namespace palpate::cli {
namespace {

struct Arguments {
  RunArguments run;
  SweepArguments sweep;
  ResumeArguments resume;
  ParetoArguments pareto;
  CompareArguments compare;
  ReportArguments report;
  ExportArguments exported;
  std::string directory;
  int tap = 0;
  std::vector<std::string> configs;
  std::string plugin;
  bool json = false;
};

/// What to do once the command line is understood.
struct Action {
  std::function<int(Program&)> perform;
  std::function<void(Program&, Needs&)> need;  ///< what that takes; see needs.hpp
};

void does(CLI::App* sub, Action& action, std::function<int(Program&)> perform,
          std::function<void(Program&, Needs&)> need) {
  sub->callback([&action, its = Action{std::move(perform), std::move(need)}] { action = its; });
}

constexpr const char* kStepHelp =
    "of a robot: show place, way and force limits of every tap before it is made; Enter taps, q ends, "
    "'palpate resume' carries on";

void add_run(CLI::App& app, Arguments& a, Action& action) {
  CLI::App* sub = app.add_subcommand("run", "Run one experiment");
  sub->add_option("CONFIG", a.run.config, "the experiment, a YAML file")->required();
  sub->add_option("OVERRIDE", a.run.overrides,
                  "override a value (kernel.length_scale=2cm) or a group (kernel=matern52)")
      ->type_name("KEY=VALUE");
  sub->add_option("--runs", a.run.runs, "where run directories are made")->capture_default_str();
  sub->add_flag("--json", a.run.json, "print summary.json and nothing else");
  CLI::Option* quiet = sub->add_flag("--quiet", a.run.quiet, "print nothing");
  sub->add_flag("--dry-run", a.run.dry_run, "say what would be run and where; move nothing");
  sub->add_flag("--force", a.run.force, "move an earlier run of this id aside and run again");
  sub->add_flag("--step", a.run.step, kStepHelp)->excludes(quiet);
  CLI::Option* print = sub->add_flag("--print-config", a.run.print_config, "print the resolved config and stop");
  sub->add_flag("--origins", a.run.origins, "with it, where each value came from")->needs(print);
  sub->add_option("--junit", a.run.junit, "write what held and what failed as JUnit XML to this file");
  does(
      sub, action, [&](Program& program) { return run(program, a.run); },
      [&](Program& program, Needs& needs) { need_run(program, a.run.config, a.run.overrides, needs); });
}

/// What `sweep` and `resume` say alike.
void add_launch(CLI::App* sub, LaunchArguments& launch) {
  sub->add_option("-j", launch.workers,
                  "jobs of a sweep at a time; if not given, the number of cores, in a task of Slurm 1")
      ->check(CLI::Range(1, 1024));
  sub->add_option("--attempts", launch.attempts, "how often a job may be begun before it stays failed")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  sub->add_flag("--quiet", launch.quiet, "show no progress");
  sub->add_option("--junit", launch.junit, "write what held and what failed as JUnit XML to this file");
  sub->add_option("--launcher", launch.launcher, "who runs the jobs: this machine, or a cluster under Slurm")
      ->check(CLI::IsMember({"local", "slurm"}))
      ->capture_default_str();
  const char* group = "With --launcher slurm";
  sub->add_option("--partition", launch.partition, "of the cluster; its default one if not given")->group(group);
  sub->add_option("--time", launch.time, "a task may take: as sbatch takes it, 1:30:00")->group(group);
  sub->add_option("--account", launch.account, "that pays for it")->group(group);
  sub->add_option("--sbatch", launch.sbatch, "any other option of sbatch, with its dashes: --sbatch=--mem=4G")
      ->allow_extra_args(false)
      ->group(group);
  sub->add_option("--jobs-per-task", launch.jobs_per_task, "jobs that a task runs, -j at a time; 1 if not given")
      ->check(CLI::Range(1, 1000000))
      ->group(group);
  sub->add_flag("--wait", launch.wait, "stay until all have ended; Ctrl-C cancels them")->group(group);
}

void add_sweep(CLI::App& app, Arguments& a, Action& action) {
  CLI::App* sub = app.add_subcommand("sweep", "Run many experiments: every combination of some values");
  sub->add_option("CONFIG", a.sweep.config, "the experiment, a YAML file, perhaps with a 'sweep:'")->required();
  sub->add_option("AXIS", a.sweep.axes,
                  "what to vary: seed=range(0,10), acquisition=weighted,random, "
                  "kernel.length_scale=log(1cm,5cm,8)")
      ->type_name("KEY=VALUES");
  sub->add_option("--runs", a.sweep.runs, "where run directories are made")->capture_default_str();
  sub->add_flag("--list", a.sweep.list, "list the jobs and stop");
  add_launch(sub, a.sweep.launch);
  does(
      sub, action, [&](Program& program) { return sweep(program, a.sweep); }, need_everything);
}

void add_resume(CLI::App& app, Arguments& a, Action& action) {
  CLI::App* sub = app.add_subcommand("resume", "Carry on a broken run or sweep");
  sub->add_option("DIR", a.resume.directory, "its directory")->required();
  sub->add_flag("--retry-failed", a.resume.retry_failed, "carry on what failed, too");
  sub->add_flag("--force", a.resume.force, "carry on what another build began");
  sub->add_option("--jobs", a.resume.jobs,
                  "only these jobs of a sweep: 0-7,12; those that others hold are left to them");
  add_launch(sub, a.resume.launch);
  sub->add_flag("--step", a.resume.step, kStepHelp)->excludes(sub->get_option("--quiet"));
  does(
      sub, action, [&](Program& program) { return resume(program, a.resume); },
      [&](Program& program, Needs& needs) { need_record(program, a.resume.directory, needs); });
}

void add_rest(CLI::App& app, Arguments& a, Action& action) {
  CLI::App* sub = app.add_subcommand("status", "Where a run or a sweep stands");
  sub->add_option("DIR", a.directory, "its directory")->required();
  does(
      sub, action, [&](Program& program) { return status(program, a.directory); },
      [&](Program&, Needs& needs) { needs.whole = is_sweep(a.directory); });

  sub = app.add_subcommand("replay", "Send recorded taps through the same models and compare every number");
  sub->add_option("DIR", a.directory, "the run's directory")->required();
  does(
      sub, action, [&](Program& program) { return replay(program, a.directory); },
      [&](Program& program, Needs& needs) { need_record(program, a.directory, needs); });

  sub = app.add_subcommand("validate", "Check configs, run nothing");
  sub->add_option("CONFIG", a.configs, "YAML files")->required();
  does(
      sub, action, [&](Program& program) { return validate(program, a.configs); },
      [&](Program& program, Needs& needs) { need_configs(program, a.configs, needs); });

  sub = app.add_subcommand("plugins", "List plugins, or the options of one");
  sub->add_option("PLUGIN", a.plugin, "a kind (kernel) or a plugin (kernel/rbf)")->type_name("KIND[/NAME]");
  sub->add_flag("--json", a.json, "as JSON");
  does(
      sub, action, [&](Program& program) { return plugins(program, a.plugin, a.json); },
      [&](Program& program, Needs& needs) { need_listing(program, a.plugin, needs); });

  sub = app.add_subcommand("pareto", "What accuracy costs: the settings of a sweep that none beats in both");
  sub->add_option("DIR", a.pareto.directory, "the sweep's directory")->required();
  sub->add_option("--cost", a.pareto.cost, "a column of results.csv: robot_seconds, compute_seconds, taps")->required();
  sub->add_option("--error", a.pareto.error, "another, an error: footprint_iou")->required();
  sub->add_option("--within", a.pareto.within,
                  "print the cheapest setting whose 95 % interval of the error keeps to this, as a config: 5mm");
  does(
      sub, action, [&](Program& program) { return pareto(program, a.pareto); },
      [](Program&, Needs& needs) { needs.whole = true; });

  sub = app.add_subcommand("schema", "Print the JSON Schema of config files, for editors");
  does(
      sub, action, [&](Program& program) { return schema(program); },
      [](Program&, Needs& needs) { needs.every_plugin = true; });
}

void add_compare(CLI::App& app, Arguments& a, Action& action) {
  CLI::App* sub = app.add_subcommand("compare", "Groups of a sweep's jobs, with intervals and paired tests");
  sub->add_option("DIR", a.compare.directory, "the sweep's directory")->required();
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* help) {
    sub->add_option(name, values, help)->required()->delimiter(',')->allow_extra_args(false);
  };
  list("--by", a.compare.by, "the swept keys that make the groups: acquisition or acquisition,kernel");
  list("--metric", a.compare.metrics, "the columns of results.csv to compare: on_surface_taps,footprint_iou");
  sub->add_option("--where", a.compare.where, "compare only jobs of which this holds: \"first_hit_tap <= 3\"");
  CLI::Option* baseline =
      sub->add_option("--baseline", a.compare.baseline, "compare all groups with this one only: uncertainty");
  CLI::Option* at =
      sub->add_option(
             "--at", a.compare.at,
             "the jobs as they were after so many taps: 17 or 17,30; computed from the recorded taps, and kept")
          ->delimiter(',')
          ->allow_extra_args(false)
          ->check(CLI::Range(1, 1000000));
  CLI::Option* ratio = sub->add_flag("--ratio", a.compare.ratio, "of every pair also the ratio of the means");
  sub->add_flag("--table", a.compare.table, "the means alone, all metrics and numbers of taps in one Markdown table")
      ->excludes(baseline)
      ->excludes(ratio);
  sub->add_option("-j", a.compare.workers, "with --at, jobs at a time; if not given, the number of cores")
      ->check(CLI::Range(1, 1024))
      ->needs(at);
  does(
      sub, action, [&](Program& program) { return compare(program, a.compare); },
      [&](Program&, Needs& needs) { needs.whole = true, needs.every_plugin = !a.compare.at.empty(); });
}

void add_report(CLI::App& app, Arguments& a, Action& action) {
  CLI::App* sub = app.add_subcommand("report", "A run or a sweep as one HTML page, and as pictures");
  sub->add_option("DIR", a.report.directory, "its directory")->required();
  sub->add_flag("--figures", a.report.figures, "PNG of the same panels, too, by gnuplot");
  sub->add_flag("--paper", a.report.paper, "laid out as the figures of the paper");
  does(
      sub, action, [&](Program& program) { return report(program, a.report); },
      [&](Program& program, Needs& needs) { need_whole(program, a.report.directory, needs); });
}

void add_one_run(CLI::App& app, Arguments& a, Action& action) {
  CLI::App* sub = app.add_subcommand("explain", "Why a run made a tap where it made it, in words");
  sub->add_option("RUN", a.directory, "the run's directory")->required();
  sub->add_option("TAP", a.tap, "the number of the tap, from 1")->required();
  does(
      sub, action, [&](Program& program) { return explain(program, a.directory, a.tap); },
      [&](Program& program, Needs& needs) { need_whole(program, a.directory, needs); });

  sub = app.add_subcommand("export", "Write the surface and the taps of a run for other programs");
  sub->add_option("RUN", a.exported.directory, "the run's directory")->required();
  sub->add_option("--format", "ply, which is the only one, for programs that show meshes")
      ->check(CLI::Validator(
          [](const std::string& format) -> std::string {
            if (format == "ply") return {};
            return format == "csv" ? "the tables are surface.csv (log.surface=true) and taps.csv of the run itself"
                                   : fmt::format("{} is not known, write ply", format);
          },
          "ply"));
  sub->add_option("--to", a.exported.to, "the folder to write into; if not given, export/ of the run");
  does(
      sub, action, [&](Program& program) { return export_run(program, a.exported); },
      [&](Program& program, Needs& needs) { need_whole(program, a.exported.directory, needs); });
}

/// CLI11's own words, on one line, but of a command that there is not.
int usage_error(const CLI::App& app, const CLI::Error& trouble, const std::string& first) {
  if (app.get_subcommands().empty() && !first.empty() && first.front() != '-') {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    throw Error("", fmt::format("no command '{}'", first), suggestion(first, names));
  }
  throw Error("", trouble.what(), "see palpate --help");
}

int perform(const Action& action, bool asked, int argc, char** argv) {
  const Installation installation = find_installation();
  const PluginHost host(PluginHost::search_path(installation.plugins));
  Composer composer(installation.configs, config_keys());
  Program program{installation, host, composer, {host, installation, {argv, argv + argc}, &interrupted}};
  if (!asked) return action.perform(program);
  Needs needs;
  action.need(program, needs);
  print_needs(program, needs);
  return kDone;
}

int run_main(int argc, char** argv) {
  CLI::App app{
      "palpate: experiments in active touch. A robot arm, or a simulated one, taps an unknown object; Gaussian\n"
      "processes say where to tap next.",
      "palpate"};
  app.require_subcommand(1);
  app.set_version_flag("--version", kVersion);
  // Asked what the words behind it take: see needs.hpp. No option of a command, and so of nobody's help.
  const bool asked = argc > 1 && std::string_view(argv[1]) == "--needs";
  if (asked) argv[1] = argv[0], ++argv, --argc;
  Arguments arguments;
  Action action;
  add_run(app, arguments, action);
  add_sweep(app, arguments, action);
  add_resume(app, arguments, action);
  add_rest(app, arguments, action);
  add_compare(app, arguments, action);
  add_report(app, arguments, action);
  add_one_run(app, arguments, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {
    return asked ? kDone : app.exit(wish);
  } catch (const CLI::Error& trouble) {
    return usage_error(app, trouble, argc > 1 ? argv[1] : "");
  }
  std::signal(SIGCHLD, SIG_DFL);  // whoever started this may ignore it, and then no end of a child can be told
  return perform(action, asked, argc, argv);
}

int exit_status(Error::Kind kind) {
  switch (kind) {
    case Error::Kind::usage:
      return kUsage;
    case Error::Kind::run:
      return kFailed;
    case Error::Kind::busy:
      return kBusy;
  }
  return kFailed;
}

}  // namespace
}  // namespace palpate::cli

int main(int argc, char** argv) {
  try {
    return palpate::cli::run_main(argc, argv);
  } catch (const palpate::Error& error) {
    palpate::cli::mention(std::string(error.what()) + "\n");
    return palpate::cli::exit_status(error.kind());
  } catch (const std::exception& error) {
    palpate::cli::mention(fmt::format("palpate: {}\n", error.what()));
    return palpate::cli::kFailed;
  }
}
