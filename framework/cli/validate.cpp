// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "config/trouble.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace palpate::cli {

int validate(Program& program, const std::vector<std::string>& configs) {
  int bad = 0;
  // Said at the end: over a sweep, this process may become another program, which begins anew.
  std::vector<std::pair<std::FILE*, std::string>> said;
  for (const std::string& file : configs) {
    // All files are looked at, so that one run of the command shows every file that needs a hand.
    const std::optional<Error> trouble = trouble_in([&] {
      const Tree tree = program.composer.compose(file, {});
      if (tree.find("sweep") != nullptr) {
        said.emplace_back(stdout, fmt::format("{}: valid, a sweep of {} jobs\n", file, jobs_of_sweep(program, file)));
      } else {
        const ResolvedConfig config = resolve_experiment(tree, program.host);
        // Only building finds a broken mesh, or objects for which there is no room.
        build_scene(config.options.scene, static_cast<std::uint64_t>(config.options.seed), program.host);
        said.emplace_back(stdout, fmt::format("{}: valid, id {}\n", file, config.id));
      }
    });
    if (!trouble) continue;
    said.emplace_back(stderr, std::string(trouble->what()) + "\n");
    ++bad;
  }
  for (const auto& [where, line] : said) fmt::print(where, "{}", line);
  return bad == 0 ? kDone : kUsage;
}

}  // namespace palpate::cli
