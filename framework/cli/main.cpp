// SPDX-License-Identifier: MIT
// The command line: which commands there are, what they are called with, and what becomes of errors.
#include "cli/commands.hpp"
#include "cli/completion.hpp"
#include "cli/display.hpp"
#include "cli/interrupt.hpp"
#include "cli/needs.hpp"
#include "cli/output.hpp"
#include "cli/usage.hpp"
#include "config/tree.hpp"
#include "config/trouble.hpp"
#include "math/instructions.hpp"
#include "record/catalogue.hpp"
#include "record/fields.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdio>
#include <string_view>

namespace palpate::cli {
namespace {

/// What a command takes; see needs.hpp.
using Need = std::function<void(Needs&)>;

/// The program with every command, and what the run or the sweep in `directory` takes.
Need all_about(const std::string& directory) {
  return [&directory](Needs& needs) {
    needs.whole();
    needs.record(directory);
  };
}

constexpr const char* kMeantBy =
    ". Give the directory, a folder that contains the directory, NAME in runs/, or NAME@latest";

/// An option or positional argument; help calls its value `of`.
template <class Value>
CLI::Option* add_option(CLI::App* sub, const char* name, Value& value, const char* of, const std::string& help) {
  return sub->add_option(name, value, help)->type_name(of);
}

/// The commands with what they are called with.
struct CommandLine {
  CLI::App& app;
  bool asked;                            ///< what the command takes, and no more: see needs.hpp
  std::function<int(Program&)> perform;  ///< the command that was named, once the command line is understood
  Need need;
  RunArguments run;
  SweepArguments sweep;
  ResumeArguments resume;
  ParetoArguments pareto;
  CompareArguments compare;
  CurvesArguments curves;
  ReportArguments report;
  WatchArguments watch;
  ListArguments list;
  std::string directory;  ///< of a command that has no arguments of its own
  std::string to;
  std::string format = "ply";
  std::vector<std::string> configs;
  std::vector<std::string> runs;
  std::string plugin;
  std::string kind;
  bool python = false;
  bool json = false;
  int tap = 0;

  CommandLine(CLI::App& commands, bool only_asked) : app(commands), asked(only_asked) {}

  /// An argument that says which run or sweep is meant: the command gets the directory of it, or of each.
  template <class Texts>
  void add_record(CLI::App* sub, const char* name, Texts& texts, Wanted wanted, const std::string& help) const {
    const auto find = [wanted, only_asked = asked](std::string& words) -> std::string {
      const auto trouble = trouble_in([&] { words = find_record(words, wanted).string(); });
      if (trouble && !only_asked) throw *trouble;
      return {};
    };
    const char* of = wanted == Wanted::run ? "RUN" : wanted == Wanted::sweep ? "SWEEP" : "DIR";
    add_option(sub, name, texts, of, help + kMeantBy)->required()->transform(CLI::Validator(find, ""));
  }

  /// Arguments that say which sweeps and runs are taken as one sweep: see find_records().
  static void add_records(CLI::App* sub, std::vector<std::string>& words) {
    add_option(sub, "DIR", words, "SWEEP", "one sweep, or several sweeps and runs to pool" + std::string(kMeantBy))
        ->required();
  }

  /// The arguments are read when the command is performed.
  template <class... Parameters, class... Arguments>
  CLI::App* add(const char* name, const char* help, const Need& takes, int (*command)(Program&, Parameters...),
                const Arguments&... arguments) {
    CLI::App* sub = app.add_subcommand(name, help);
    sub->callback([=, &arguments...] {
      perform = [command, &arguments...](Program& program) { return command(program, arguments...); };
      need = takes;
    });
    return sub;
  }
};

constexpr const char* kStepHelp =
    "for a robot: before each tap, show position, path and force limits, and wait for an answer. Enter makes the tap, "
    "q interrupts the run. 'palpate resume' continues the run";
constexpr const char* kWatchHelp =
    "serve a web page that follows the run or sweep, and print the address of the page. The server ends as with "
    "'palpate watch --until-left'";
constexpr const char* kRunsHelp = "folder in which the run directories are made";
constexpr const char* kJunitHelp = "output file in JUnit XML format, with the results of all runs and expectations";
constexpr int kMany = 1000000;
constexpr int kManyWorkers = 1024;

/// A range that says so in words.
CLI::Validator from(int least, int most) {
  return CLI::Range(least, most)
      .description(most == kMany ? fmt::format("{} or more", least) : fmt::format("{} to {}", least, most));
}

/// Whole lines, as typed; the help shows them.
void show(CLI::App* command, const std::vector<std::string>& examples) {
  command->footer(fmt::format("{}", fmt::join(examples, "\n")));
}

void add_run(CommandLine& line) {
  const Need takes = [&line](Needs& needs) {
    if (line.run.watch) needs.whole();
    needs.config(line.run.config, line.run.overrides, false);
  };
  CLI::App* sub = line.add("run", "Run one experiment", takes, run, line.run);
  add_option(sub, "CONFIG", line.run.config, "CONFIG", "YAML file of the experiment")->required();
  add_option(sub, "OVERRIDE", line.run.overrides, "KEY=VALUE",
             "value that replaces the value in the config, for example kernel.length_scale=2cm for a key, or "
             "kernel=matern52 for a config group");
  add_option(sub, "--runs", line.run.runs, "FOLDER", kRunsHelp)->capture_default_str();
  sub->add_flag("--json", line.run.json, "print summary.json and nothing else");
  CLI::Option* quiet = sub->add_flag("--quiet", line.run.quiet, "print nothing");
  sub->add_flag("--dry-run", line.run.dry_run, "print the planned run and its directory; nothing moves");
  sub->add_flag("--force", line.run.force,
                "run again even if a run with the same id exists. The existing run is moved to another folder");
  sub->add_flag("--step", line.run.step, kStepHelp)->excludes(quiet);
  sub->add_flag("--watch", line.run.watch, kWatchHelp);
  CLI::Option* print = sub->add_flag("--print-config", line.run.print_config, "print the resolved config and stop");
  CLI::Option* origins = sub->add_flag("--origins", line.run.origins,
                                       "print each resolved value with the file or argument that set the value")
                             ->needs(print);
  sub->add_flag("--identity", line.run.identity, "print the text that is hashed to make the id of the run")
      ->needs(print)
      ->excludes(origins);
  add_option(sub, "--junit", line.run.junit, "FILE", kJunitHelp);
  show(sub, {"palpate run configs/paper/object_i.yaml",
             "palpate run configs/default.yaml scene=ring kernel.length_scale=3cm seed=7"});
}

/// A list of values, separated by commas.
template <class Values>
CLI::Option* add_values(CLI::App* sub, const char* name, Values& values, const char* of, const char* help) {
  return add_option(sub, name, values, of, help)->delimiter(',')->allow_extra_args(false);
}

/// What `sweep` and `resume` say alike.
void add_launch(CLI::App* sub, LaunchArguments& launch) {
  add_option(sub, "-j", launch.workers, "N",
             "number of jobs that a sweep runs in parallel; default: number of cores, or 1 in a Slurm task")
      ->check(from(1, kManyWorkers));
  add_option(sub, "--attempts", launch.attempts, "N",
             "maximum number of starts per job. After this number, the job counts as failed")
      ->check(from(1, kMany))
      ->capture_default_str();
  sub->add_flag("--quiet", launch.quiet, "show no progress");
  sub->add_flag("--watch", launch.watch, kWatchHelp);
  add_option(sub, "--junit", launch.junit, "FILE", kJunitHelp);
  add_option(sub, "--launcher", launch.launcher, "NAME",
             "place where the jobs run: this machine, or a cluster under Slurm")
      ->check(CLI::IsMember(std::vector<std::string>(kLaunchers.begin(), kLaunchers.end())))
      ->capture_default_str();
  const char* group = "With --launcher slurm";
  add_option(sub, "--partition", launch.partition, "NAME",
             "Slurm partition for the jobs; default: the cluster's default partition")
      ->group(group);
  add_option(sub, "--time", launch.time, "TIME",
             "time limit of a Slurm task, in the format of sbatch, for example 1:30:00")
      ->group(group);
  add_option(sub, "--account", launch.account, "NAME", "Slurm account that is charged for the jobs")->group(group);
  add_option(sub, "--sbatch", launch.sbatch, "OPTION",
             "further option for sbatch, dashes included, for example --sbatch=--mem=4G")
      ->allow_extra_args(false)
      ->group(group);
  add_option(sub, "--jobs-per-task", launch.jobs_per_task, "N",
             "number of jobs per Slurm task; default: 1. Option -j sets how many of these jobs run in parallel")
      ->check(from(1, kMany))
      ->group(group);
  sub->add_flag("--wait", launch.wait, "wait until all jobs have ended; Ctrl-C cancels the jobs")->group(group);
}

void add_sweep(CommandLine& line) {
  CLI::App* sub =
      line.add("sweep", "Run one experiment per combination of given values", &Needs::everything, sweep, line.sweep);
  add_option(sub, "CONFIG", line.sweep.config, "CONFIG",
             "YAML file of the experiment, optionally with a 'sweep:' block")
      ->required();
  add_option(sub, "AXIS", line.sweep.axes, "KEY=VALUES",
             "key and the values that the sweep uses for the key, for example seed=range(0,10) or "
             "acquisition=weighted,random or kernel.length_scale=logspace(1cm,5cm,8)");
  add_option(sub, "--runs", line.sweep.runs, "FOLDER", kRunsHelp)->capture_default_str();
  sub->add_flag("--list", line.sweep.list, "list the jobs and stop");
  add_launch(sub, line.sweep.launch);
  show(sub, {"palpate sweep configs/paper/object_i.yaml acquisition=weighted,uncertainty \"seed=range(0,10)\"",
             "palpate sweep configs/sweep/kernels.yaml --list"});
}

void add_resume(CommandLine& line) {
  const Need takes = [&line](Needs& needs) {
    if (line.resume.launch.watch) needs.whole();
    needs.record(line.resume.directory);
  };
  CLI::App* sub = line.add("resume", "Resume an interrupted run or sweep", takes, resume, line.resume);
  line.add_record(sub, "DIR", line.resume.directory, Wanted::any, "run or sweep");
  sub->add_flag("--retry-failed", line.resume.options.retry_failed, "also resume failed runs");
  sub->add_flag("--force", line.resume.options.force,
                "resume even if another build of palpate or its plugins started the run");
  add_option(sub, "--jobs", line.resume.jobs, "NUMBERS",
             "numbers of the sweep's jobs to resume, for example 0-7,12. Jobs that another process runs are skipped");
  add_launch(sub, line.resume.launch);
  sub->add_flag("--step", line.resume.step, kStepHelp)->excludes(sub->get_option("--quiet"));
  show(sub, {"palpate resume runs/object_i/422cd70eb5f7", "palpate resume runs/many/5b0c4e1d77aa --retry-failed -j 2"});
}

void add_list(CommandLine& line) {
  CLI::App* sub = line.add("list", "List the runs and sweeps in a folder, sorted by start time", &Needs::whole,
                           list_runs, line.list);
  add_option(sub, "FOLDER", line.list.folder, "FOLDER",
             "folder to search, three levels deep, for example runs, runs/NAME, or a parent folder")
      ->capture_default_str();
  add_option(sub, "--where", line.list.where, "CONDITION",
             "list only runs that satisfy a condition on columns, summary fields and config keys, for example "
             "\"rmse_m < 8 mm and kernel.type == rbf\"");
  sub->add_flag("--json", line.list.json, "print the list as JSON");
  show(sub, {"palpate list", "palpate list runs/first --where \"rmse_m < 8 mm and seed > 3\""});
}

void add_rest(CommandLine& line) {
  CLI::App* sub = line.add(
      "status", "Show the state of a run or sweep",
      [&line](Needs& needs) {
        if (is_sweep(line.directory)) needs.whole();
      },
      status, line.directory);
  line.add_record(sub, "DIR", line.directory, Wanted::any, "run or sweep");
  show(sub, {"palpate status runs/object_i/422cd70eb5f7", "palpate status runs/first/*"});

  sub = line.add(
      "replay", "Recompute a run from its recorded taps and compare every number with the record",
      [&line](Needs& needs) { needs.record(line.directory); }, replay, line.directory);
  line.add_record(sub, "DIR", line.directory, Wanted::run, "run");
  show(sub, {"palpate replay runs/object_i/422cd70eb5f7", "palpate replay runs/first/*"});

  sub = line.add(
      "validate", "Check configs without running them",
      [&line](Needs& needs) {
        for (const std::string& config : line.configs) needs.config(config, {}, true);
      },
      validate, line.configs);
  add_option(sub, "CONFIG", line.configs, "CONFIG", "YAML files of experiments")->required();
  show(sub, {"palpate validate configs/default.yaml", "palpate validate configs/paper/*.yaml"});

  sub = line.add(
      "plugins", "List all plugins, or show the options of one plugin",
      [&line](Needs& needs) { needs.listing(line.plugin); }, plugins, line.plugin, line.json);
  add_option(sub, "PLUGIN", line.plugin, "KIND[/NAME]",
             "plugin kind, for example kernel, or plugin, for example kernel/rbf");
  sub->add_flag("--json", line.json, "print the list as JSON");
  show(sub, {"palpate plugins", "palpate plugins kernel/rbf"});

  sub = line.add(
      "new", "Create a starter plugin and an experiment that uses it", [](Needs&) {}, new_plugin, line.kind, line.to,
      line.python);
  add_option(sub, "KIND", line.kind, "KIND",
             fmt::format("kind of the plugin: {}", fmt::join(PluginHost::kinds(), ", ")))
      ->required();
  add_option(sub, "NAME", line.to, "NAME", "name of the plugin; the new folder has the same name")->required();
  sub->add_flag("--python", line.python,
                "create the acquisition as a Python function with a test; no compilation is needed");
  show(sub,
       {"palpate new kernel my_kernel", "palpate new acquisition curious", "palpate new acquisition --python curious"});

  sub = line.add("pareto", "Show which settings of a sweep are Pareto-optimal in cost and error", &Needs::whole, pareto,
                 line.pareto);
  line.add_records(sub, line.pareto.records);
  add_option(sub, "--cost", line.pareto.cost, "COLUMN",
             "column of results.csv to use as the cost, for example robot_seconds, compute_seconds or taps")
      ->required();
  add_option(sub, "--error", line.pareto.error, "COLUMN",
             "column of results.csv to use as the error or the quality, for example rmse_m or footprint_iou")
      ->required();
  add_option(sub, "--within", line.pareto.within, "VALUE",
             "bound on the error, for example 5mm. Print the config of the cheapest setting with a 95 % interval "
             "of the error within the bound");
  add_option(sub, "--where", line.pareto.where, "CONDITION",
             "use only jobs that satisfy this condition, for example \"scene == ring\"");
  show(sub, {"palpate pareto runs/many/* --cost robot_seconds --error rmse_m",
             "palpate pareto runs/many/* --cost taps --error rmse_m --within 5mm"});

  sub = line.add("schema", "Print the JSON Schema of config files, for completion and checks in editors",
                 &Needs::every_plugin, schema);
  show(sub, {"palpate schema > palpate.schema.json", "palpate schema | grep length_scale"});
}

void add_compare(CommandLine& line) {
  CLI::App* sub = line.add(
      "compare", "Compare groups of jobs of a sweep, with confidence intervals and paired tests",
      [&line](Needs& needs) { line.compare.at.empty() && !line.compare.until ? needs.whole() : needs.everything(); },
      compare, line.compare);
  line.add_records(sub, line.compare.records);
  add_values(sub, "--by", line.compare.by, "KEYS", "swept keys that define the groups, for example acquisition,kernel")
      ->required();
  add_values(sub, "--metric", line.compare.metrics, "COLUMNS",
             "columns of results.csv to compare, for example object_taps,footprint_iou")
      ->required();
  add_option(sub, "--where", line.compare.where, "CONDITION",
             "compare only jobs that satisfy this condition, for example \"first_hit_tap <= 3\"");
  add_option(sub, "--baseline", line.compare.baseline, "GROUP",
             "group with which every other group is compared, for example uncertainty");
  CLI::Option* at = add_values(sub, "--at", line.compare.at, "NUMBERS",
                               "numbers of taps after which the jobs are compared, for example 17,30")
                        ->check(from(1, kMany));
  add_option(sub, "--until", line.compare.until, "COLUMN=VALUE",
             "value of a summary field, for example rmse_m=8mm. Each job is compared at the tap that reaches the "
             "value. A job that never reaches the value is compared at its end")
      ->excludes(at);
  sub->add_flag("--ratio", line.compare.ratio, "also print the ratio of the means of each pair");
  add_option(sub, "--format", line.compare.format, "NAME",
             "output format. text also writes CSV files next to results.csv. csv and json contain groups and "
             "pairs. latex is a booktabs table of means, intervals and n. markdown is a table of means")
      ->check(CLI::IsMember({"text", "markdown", "csv", "json", "latex"}))
      ->capture_default_str();
  add_option(sub, "-j", line.compare.workers, "N",
             "number of jobs that --at or --until computes in parallel; default: number of cores")
      ->check(from(1, kManyWorkers));
  show(sub, {"palpate compare runs/many/* --by acquisition --metric object_taps",
             "palpate compare runs/many/* --by acquisition --metric rmse_m,footprint_iou --at 17,30 --format latex"});
}

void add_curves(CommandLine& line) {
  CLI::App* sub = line.add(
      "curves", "Draw curves of a sweep's results against taps, one per group with a band, and write them as CSV",
      &Needs::everything, curves, line.curves);
  line.add_records(sub, line.curves.records);
  add_values(sub, "--by", line.curves.by, "KEYS",
             "swept keys that define the groups, for example acquisition,kernel; default: all swept keys except the "
             "seed and the scene. Each scene has its own panel");
  add_option(sub, "--metric", line.curves.metric, "COLUMN",
             "column of results.csv to draw, for example footprint_iou; default: rmse_m, or "
             "rms_surface_distance_m if the tool taps from any side");
  add_option(sub, "--against", line.curves.against, "COLUMN",
             "quantity on the horizontal axis: taps is the number of taps, robot_seconds is the robot time")
      ->check(CLI::IsMember({"taps", "robot_seconds"}))
      ->capture_default_str();
  add_option(sub, "--where", line.curves.where, "CONDITION",
             "draw only jobs that satisfy this condition, for example \"first_hit_tap <= 3\"");
  add_option(sub, "-o", line.curves.outputs, "FILE",
             "output file that ends in .png, .pdf, .svg or .csv; default: one PNG and one CSV file next to results.csv")
      ->allow_extra_args(false);
  add_option(sub, "--width", line.curves.width, "LENGTH",
             "printed width of the figure, with unit, for example 8.8cm for one column; default: 17.8 cm, which "
             "is two columns. Panels that do not fit side by side continue in a further row");
  add_option(sub, "-j", line.curves.workers, "N", "number of jobs replayed in parallel; default: number of cores")
      ->check(from(1, kManyWorkers));
  show(sub, {"palpate curves runs/many/*",
             "palpate curves runs/many/* --by acquisition --width 8.8cm -o curves.pdf -o curves.csv",
             "palpate curves runs/many/* --metric footprint_iou --against robot_seconds -o iou.svg"});
}

void add_watch(CommandLine& line) {
  CLI::App* sub = line.add("watch", "Serve a web page that follows a run or sweep while it runs",
                           all_about(line.watch.directory), watch, line.watch);
  line.add_record(sub, "DIR", line.watch.directory, Wanted::any, "run or sweep");
  constexpr int kMostPort = 65535;
  add_option(sub, "--port", line.watch.port, "N", "port of the web page; default: any free port")
      ->check(from(1, kMostPort));
  add_option(
      sub, "--bind", line.watch.bind, "ADDRESS",
      "numeric IP address of the web page's server. Other machines can open the page if they can reach this address")
      ->capture_default_str();
  sub->add_flag("--until-left", line.watch.until_left,
                "end the server two minutes after the run has ended and the last page was closed. Without this option, "
                "only Ctrl-C ends the server");
  show(sub, {"palpate watch runs/object_i/422cd70eb5f7", "palpate watch many@latest --port 8000"});
}

void add_about_one(CommandLine& line) {
  const auto all_of_them = [&line](Needs& needs) {
    needs.whole();
    for (const std::string& directory : line.report.directories) needs.record(directory);
  };
  CLI::App* sub = line.add(
      "report", "Write an HTML page of a run or sweep, optionally with figures, or one page that compares several runs",
      all_of_them, report, line.report);
  line.add_record(sub, "DIR", line.report.directories, Wanted::any, "run or sweep, or several runs");
  sub->add_flag("--figures", line.report.figures, "also draw the panels as PNG files, with gnuplot");
  sub->add_flag("--paper", line.report.paper, "draw figures in the layout of the figures in the paper");
  add_option(sub, "--to", line.report.to, "FOLDER",
             "output folder; default: the folder of the run or sweep. For several runs, the default is the folder "
             "that contains all of them");
  show(sub, {"palpate report runs/object_i/422cd70eb5f7 --figures", "palpate report runs/first/* runs/second/*"});

  sub = line.add("explain", "Explain in words why a run chose the position of a tap", all_about(line.directory),
                 explain, line.directory, line.tap);
  line.add_record(sub, "RUN", line.directory, Wanted::run, "run");
  add_option(sub, "TAP", line.tap, "N", "number of the tap, counted from 1")->required();
  show(sub, {"palpate explain runs/object_i/422cd70eb5f7 9", "palpate explain runs/first/* 9"});

  sub = line.add("calibrate",
                 "Estimate the errors of an arm from recorded taps, and print an effects file for the simulator",
                 &Needs::everything, calibrate, line.runs);
  line.add_record(sub, "RUN", line.runs, Wanted::run,
                  "runs in scenes exactly as configured, for example a bare desk or a block");
  show(sub, {"palpate calibrate runs/bare_desk/*", "palpate calibrate runs/bare_desk/* runs/block/*"});

  sub = line.add("export", "Export the surface and the taps of a run for other programs", all_about(line.directory),
                 export_run, line.directory, line.format, line.to);
  line.add_record(sub, "RUN", line.directory, Wanted::run, "run");
  add_option(sub, "--format", line.format, "NAME",
             "file format: ply is for mesh viewers, csv writes tables of the taps, timings, objects and attempts")
      ->check(CLI::IsMember({"ply", "csv"}))
      ->capture_default_str();
  add_option(sub, "--to", line.to, "FOLDER", "output folder; default: export/ in the run directory");
  show(sub, {"palpate export runs/first/*", "palpate export runs/first/* --to surfaces",
             "palpate export runs/first/* --format csv"});
}

/// All commands, or of those that scripts give by the thousand only the one that is named: a tenth of a run's time.
void add_commands(CommandLine& line, const std::string& named) {
  if (named == "run") return add_run(line);
  if (named == "sweep") return add_sweep(line);
  if (named == "resume") return add_resume(line);
  for (const auto add :
       {add_run, add_sweep, add_resume, add_watch, add_list, add_rest, add_compare, add_curves, add_about_one})
    add(line);
}

/// CLI11's own words, on one line, but of a command that there is not, and of many directories where one belongs, which
/// is what a shell makes of a *.
int usage_error(const CLI::App& app, const CLI::Error& trouble, const std::string& first) {
  if (app.get_subcommands().empty() && !first.empty() && first.front() != '-') {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    throw Error("", fmt::format("no command '{}'", first), suggestion(first, names));
  }
  for (const CLI::App* command : app.get_subcommands()) {
    std::vector<std::string> takes;
    for (const CLI::Option* option : command->get_options()) {
      if (option->get_positional()) takes.push_back("one " + option->get_name());
    }
    const std::vector<std::string> rest = command->remaining();
    if (takes.empty() || rest.empty() || rest.front()[0] == '-') continue;
    throw Error("command line",
                fmt::format("{} takes {}, but '{}' is given as well", command->get_name(), fmt::join(takes, " and "),
                            rest.front()),
                "if a * matches several, name one of them");
  }
  const std::vector<CLI::App*> named = app.get_subcommands();
  throw Error("", trouble.what(), fmt::format("see palpate {}--help", named.empty() ? "" : named[0]->get_name() + " "));
}

int run_main(int argc, char** argv) {
  const Installation installation = find_installation();
  CLI::App app{
      "palpate: experiments in active touch. A robot arm, real or simulated, taps an unknown object; Gaussian\n"
      "processes choose the next tap.",
      "palpate"};
  app.require_subcommand(1);
  // Before there are commands, which take it over.
  app.formatter_fn([](const CLI::App* command, const std::string&, CLI::AppFormatMode) { return help_text(*command); });
  app.set_help_flag("-h,--help", "print this help and stop");
  app.set_version_flag(
      "--version", [&] { return build_text(installation); }, "print version, commit and build, and stop");
  show(&app, {"palpate run configs/default.yaml scene=ring", "palpate plugins kernel"});
  // Questions of the shells and of ./palpate, see completion.hpp and needs.hpp. No options of a command, and so of
  // nobody's help.
  const bool completes = argc > 1 && std::string_view(argv[1]) == "--complete";
  const bool asked = argc > 1 && std::string_view(argv[1]) == "--needs";
  if (asked) argv[1] = argv[0], ++argv, --argc;
  const std::string first = argc > 1 ? argv[1] : "";
  CommandLine line(app, asked || completes);
  add_commands(line, first);
  if (first == "--manual" && argc == 3) return write_manual(app, argv[2]), kDone;
  if (argc == 1 && !asked) {
    mention(help_text(app));
    return kUsage;
  }
  PluginHost host(PluginHost::search_path(installation.plugins));
  Composer composer(installation.configs, config_keys());
  host.set_group_names([&](const std::string& kind) { return composer.names_of(kind); });
  Program program{{host, installation, {argv, argv + argc}, &interrupted}, composer};
  if (completes) {
    std::vector<std::string> words(argv + 2, argv + argc);
    if (words.empty()) words.emplace_back();
    for (const Completion& one : completions(app, program, words)) {
      print_data(fmt::format("{}\t{}\n", one.word, one.meaning));
    }
    return kDone;
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& wish) {
    return asked ? kDone : app.exit(wish);
  } catch (const CLI::Error& trouble) {
    return usage_error(app, trouble, first);
  }
  if (!asked) math::choose_instructions();  // what is wrong with PALPATE_INSTRUCTIONS is said before anything begins
  std::signal(SIGCHLD, SIG_DFL);  // whoever started this may ignore it, and then no end of a child can be told
  if (!asked) return line.perform(program);
  Needs needs(program);
  line.need(needs);
  needs.print();
  return kDone;
}

int exit_status(Error::Kind kind) {
  return kind == Error::Kind::usage ? kUsage : kind == Error::Kind::busy ? kBusy : kFailed;
}

}  // namespace
}  // namespace palpate::cli

int main(int argc, char** argv) {
  palpate::cli::occupy_standard_files();
  palpate::cli::follow_parent();
  std::signal(SIGPIPE, SIG_DFL);  // a Python that becomes this program ignores it, and so would this
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may grow no more is an error of the write, as a full disk is
  int status = palpate::cli::kFailed;
  try {
    status = palpate::cli::run_main(argc, argv);
  } catch (const palpate::Error& error) {
    palpate::cli::mention(std::string(error.what()) + "\n");
    status = palpate::cli::exit_status(error.kind());
  } catch (const std::exception& error) {
    palpate::cli::mention(fmt::format("palpate: {}\n", error.what()));
  }
  return palpate::cli::finish_output(status);
}
