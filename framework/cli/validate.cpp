// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate::cli {

int validate(Program& program, const std::vector<std::string>& configs) {
  int bad = 0;
  for (const std::string& file : configs) {
    // All files are looked at, so that one run of the command shows every file that needs a hand.
    try {
      const Tree tree = program.composer.compose(file, {});
      if (tree.find("sweep") != nullptr) {
        fmt::print("{}: valid, a sweep of {} jobs\n", file, jobs_of_sweep(program, file));
      } else {
        const ResolvedConfig config = resolve_experiment(tree, program.host);
        // Only building finds a broken mesh, or objects for which there is no room.
        build_scene(config.options.scene, static_cast<std::uint64_t>(config.options.seed), program.host);
        fmt::print("{}: valid, id {}\n", file, config.id);
      }
    } catch (const Error& trouble) {
      fmt::print(stderr, "{}\n", trouble.what());
      ++bad;
    }
  }
  return bad == 0 ? kDone : kUsage;
}

}  // namespace palpate::cli
