// SPDX-License-Identifier: MIT
// The main function. It performs the command that the command line names and returns an exit status, even after an
// error.
#include "cli/command_line.hpp"
#include "cli/completion.hpp"
#include "cli/display.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "cli/usage.hpp"
#include "math/instructions.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <csignal>
#include <string_view>

namespace palpate::cli {
namespace {

/// Prints the completions of the last of `words`, one per line.
int print_completions(CommandLine& line, CommandEnvironment& program, std::vector<std::string> words) {
  if (words.empty()) words.emplace_back();
  for (const Completion& one : completions(line.app(), program, words))
    print_data(fmt::format("{}\t{}\n", one.word, one.meaning));
  return kDone;
}

int run_main(int argc, char** argv) {
  const Installation installation = find_installation();
  // Only the scripts of the shells and ./palpate use `--complete` and `--needs`, so no help text lists them.
  const bool completes = argc > 1 && std::string_view(argv[1]) == "--complete";
  const bool needs_only = argc > 1 && std::string_view(argv[1]) == "--needs";
  if (needs_only) argv[1] = argv[0], ++argv, --argc;
  const std::string first = argc > 1 ? argv[1] : "";
  CommandLine line(installation, needs_only || completes);
  add_commands(line, first);
  if (first == "--manual" && argc == 3) return write_manual(line.app(), argv[2]), kDone;
  if (argc == 1 && !needs_only) {
    print_message(help_text(line.app()));
    return kUsage;
  }
  PluginHost host(PluginHost::search_path(installation.plugins));
  Composer composer(installation.configs, config_keys());
  host.set_group_names([&](const std::string& kind) { return composer.names_of(kind); });
  CommandEnvironment program{{host, installation, {argv, argv + argc}, &interrupted}, composer};
  if (completes) return print_completions(line, program, {argv + 2, argv + argc});
  if (const std::optional<int> status = line.parse(argc, argv)) return *status;
  // With SIG_IGN, which a parent may have set, exit statuses of child processes would be lost.
  std::signal(SIGCHLD, SIG_DFL);
  if (!needs_only) {
    math::choose_instructions();  // An invalid PALPATE_INSTRUCTIONS is reported here, before the command begins.
    return line.perform(program);
  }
  NeededParts needs(program);
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
  std::signal(SIGPIPE, SIG_DFL);  // Python ignores this signal, and programs that Python starts inherit the setting.
  std::signal(SIGXFSZ, SIG_IGN);  // A write beyond the limit of file sizes becomes an error, as on a full disk.
  int status = palpate::cli::kFailed;
  try {
    status = palpate::cli::run_main(argc, argv);
  } catch (const palpate::Error& error) {
    palpate::cli::print_message(std::string(error.what()) + "\n");
    status = palpate::cli::exit_status(error.kind());
  } catch (const std::exception& error) {
    palpate::cli::print_message(fmt::format("palpate: {}\n", error.what()));
  }
  return palpate::cli::finish_output(status);
}
