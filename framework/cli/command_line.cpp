// SPDX-License-Identifier: MIT
#include "cli/command_line.hpp"

#include "cli/usage.hpp"
#include "config/catch_error.hpp"
#include "record/build_info.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

namespace palpate::cli {
namespace {

constexpr const char* kRecordForms =
    ". Give the directory, a folder that contains the directory, NAME in runs/, or NAME@latest";

/// Returns the error for an invalid command line. Two errors have special texts: an unknown command, and several
/// records for a command that takes only one (the shell may have expanded a *). All other errors have the text of
/// CLI11.
Error usage_error(const CLI::App& app, const CLI::Error& trouble, const std::string& first) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  if (chosen.empty() && !first.empty() && first.front() != '-') {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    return {"", fmt::format("no command '{}'", first), suggestion(first, names)};
  }
  for (const CLI::App* command : chosen) {
    std::vector<std::string> takes;
    for (const CLI::Option* option : command->get_options()) {
      if (option->get_positional()) takes.push_back("one " + option->get_name());
    }
    const std::vector<std::string> rest = command->remaining();
    if (takes.empty() || rest.empty() || rest.front()[0] == '-') continue;
    return {"command line",
            fmt::format("{} takes {}, but '{}' is given as well", command->get_name(), fmt::join(takes, " and "),
                        rest.front()),
            "if a * matches several, name one of them"};
  }
  return {"", trouble.what(),
          fmt::format("see palpate {}--help", chosen.empty() ? "" : chosen.front()->get_name() + " ")};
}

Argument with_rules(CLI::Option* option, Command::Rules rules) {
  for (const Rule& rule : rules) rule(*option);
  return option;
}

}  // namespace

Rule required(bool is_required) {
  return [=](CLI::Option& option) { option.required(is_required); };
}
Rule with_default() {
  return [](CLI::Option& option) { option.capture_default_str(); };
}
Rule at_least(int least) {
  constexpr int kUnlimited = 1000000;
  return [=](CLI::Option& option) {
    option.check(CLI::Range(least, kUnlimited).description(fmt::format("{} or more", least)));
  };
}
Rule between(int least, int most) {
  return [=](CLI::Option& option) {
    option.check(CLI::Range(least, most).description(fmt::format("{} to {}", least, most)));
  };
}
Rule one_of(const std::vector<std::string>& values) {
  return [=](CLI::Option& option) { option.check(CLI::IsMember(values)); };
}
Rule comma_separated() {
  return [](CLI::Option& option) { option.delimiter(',')->allow_extra_args(false); };
}
Rule one_per_option() {
  return [](CLI::Option& option) { option.allow_extra_args(false); };
}
Rule below(const std::string& heading) {
  return [=](CLI::Option& option) { option.group(heading); };
}
Rule only_with(Argument other) {
  return [=](CLI::Option& option) { option.needs(other); };
}
Rule not_with(Argument other) {
  return [=](CLI::Option& option) { option.excludes(other); };
}

template <class Value>
Argument Command::argument(const char* name, Value& value, const char* of, const std::string& help, Rules rules) const {
  return with_rules(app_->add_option(name, value, help)->type_name(of), rules);
}
using Text = std::string;
template Argument Command::argument(const char*, Text&, const char*, const Text&, Rules) const;
template Argument Command::argument(const char*, std::optional<Text>&, const char*, const Text&, Rules) const;
template Argument Command::argument(const char*, std::vector<Text>&, const char*, const Text&, Rules) const;
template Argument Command::argument(const char*, int&, const char*, const Text&, Rules) const;
template Argument Command::argument(const char*, std::optional<int>&, const char*, const Text&, Rules) const;
template Argument Command::argument(const char*, std::vector<int>&, const char*, const Text&, Rules) const;

Argument Command::flag(const char* name, bool& value, const std::string& help, Rules rules) const {
  return with_rules(app_->add_flag(name, value, help), rules);
}

template <class Texts>
void Command::record(const char* name, Texts& directories, RecordKind wanted, const std::string& help) const {
  const auto find = [wanted, must_exist = finds_records_](std::string& words) -> std::string {
    const auto trouble = catch_error([&] { words = find_record(words, wanted).string(); });
    if (trouble && must_exist) throw *trouble;
    return {};
  };
  const char* of = wanted == RecordKind::run ? "RUN" : wanted == RecordKind::sweep ? "SWEEP" : "DIR";
  argument(name, directories, of, help + kRecordForms, {required()})->transform(CLI::Validator(find, ""));
}
template void Command::record(const char*, Text&, RecordKind, const Text&) const;
template void Command::record(const char*, std::vector<Text>&, RecordKind, const Text&) const;

void Command::pooled_records(std::vector<std::string>& words) const {
  argument("DIR", words, "SWEEP", "one sweep, or several sweeps and runs to pool" + std::string(kRecordForms),
           {required()});
}

void Command::examples(const std::vector<std::string>& lines) const {
  app_->footer(fmt::format("{}", fmt::join(lines, "\n")));
}

CommandLine::CommandLine(const Installation& installation, bool is_query)
    : app_(std::make_unique<CLI::App>(
          "palpate: experiments in active touch. A robot arm, real or simulated, taps an unknown object; Gaussian\n"
          "processes choose the next tap.",
          "palpate")),
      is_query_(is_query) {
  app_->require_subcommand(1);
  // A command copies the formatter when it is added, so the formatter is set first.
  app_->formatter_fn(
      [](const CLI::App* command, const std::string&, CLI::AppFormatMode) { return help_text(*command); });
  app_->set_help_flag("-h,--help", "print this help and stop");
  app_->set_version_flag(
      "--version", [&installation] { return build_text(installation); }, "print version, commit and build, and stop");
  Command(app_.get(), false).examples({"palpate run configs/default.yaml scene=ring", "palpate plugins kernel"});
}

CommandLine::~CommandLine() = default;

Command CommandLine::add(const char* name, const char* help, Actions actions) {
  CLI::App* command = app_->add_subcommand(name, help);
  command->callback([this, actions = std::move(actions)] { chosen_ = actions; });
  return {command, !is_query_};
}

std::optional<int> CommandLine::parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& request) {
    return is_query_ ? kDone : app_->exit(request);
  } catch (const CLI::Error& trouble) {
    throw usage_error(*app_, trouble, argc > 1 ? argv[1] : "");
  }
  return std::nullopt;
}

}  // namespace palpate::cli
