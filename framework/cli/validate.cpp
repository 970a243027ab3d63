// SPDX-License-Identifier: MIT
#include "cli/command_line.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "cli/sweep.hpp"
#include "cli/tune.hpp"
#include "config/catch_error.hpp"
#include "scene/size_warnings.hpp"

#include <fmt/format.h>

#include <utility>

namespace palpate::cli {

namespace {

struct ValidateArguments {
  std::vector<std::string> configs;
};

int validate(CommandEnvironment& program, const ValidateArguments& arguments) {
  int bad = 0;
  // All lines are printed at the end. For a sweep, this process may be replaced by palpate-whole, which validates all
  // files again and prints all lines.
  std::vector<std::pair<bool, std::string>> said;  // true for a valid config
  for (const std::string& file : arguments.configs) {
    // All files are checked, so that one command reports every invalid file.
    const std::optional<Error> trouble = catch_error([&] {
      const Tree tree = program.composer.compose(file, {});
      if (tree.find("tune") != nullptr) call_in_whole(check_tune, program, file);
      if (tree.find("sweep") != nullptr) {
        said.emplace_back(
            true, fmt::format("{}: valid, a sweep of {} jobs\n", file, call_in_whole(jobs_of_sweep, program, file)));
      } else {
        if (tree.find("compare") != nullptr) call_in_whole(check_compare, program, tree);
        const ResolvedConfig config = resolve_experiment(tree, program.host);
        // Broken meshes, and objects that do not fit into the area, are detected only when the scene is built.
        build_scene(config.options.scene, static_cast<std::uint64_t>(config.options.seed), program.host);
        for (const std::string& line : partly_given_sizes(config.tree, config.notes))
          said.emplace_back(false, line + "\n");
        said.emplace_back(true, fmt::format("{}: valid, id {}\n", file, config.id));
      }
    });
    if (!trouble) continue;
    said.emplace_back(false, std::string(trouble->what()) + "\n");
    ++bad;
  }
  for (const auto& [valid, line] : said) valid ? print_text(line) : print_message(line);
  return bad == 0 ? kDone : kUsage;
}

}  // namespace

void add_validate(CommandLine& line) {
  auto [command, arguments] = line.add<ValidateArguments>("validate", "Check configs without running them", validate,
                                                          [](NeededParts& needs, const ValidateArguments& given) {
                                                            for (const std::string& config : given.configs)
                                                              needs.config(config, {}, true);
                                                          });
  command.argument("CONFIG", arguments.configs, "CONFIG", "YAML files of experiments", {required()});
  command.examples({"palpate validate configs/default.yaml", "palpate validate configs/paper/*.yaml"});
}

}  // namespace palpate::cli
