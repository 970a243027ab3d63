// SPDX-License-Identifier: MIT
#include "cli/commands.hpp"
#include "cli/display.hpp"
#include "watch/server.hpp"

#include <fmt/format.h>

#include <cstdio>

#include <sys/resource.h>

namespace palpate::cli {

int watch(Program& program, const WatchArguments& arguments) {
  constexpr int kPatience = 120;
  // The run that is watched goes first wherever there is not enough for both. If this is not allowed, it is as it was.
  ::setpriority(PRIO_PROCESS, 0, 19);
  Site site(program, arguments.directory);
  Server server(site, {arguments.bind, arguments.port, arguments.until_left ? kPatience : 0});
  if (server.is_open_to_others()) {
    mention(fmt::format("watch: whoever reaches {} and knows this address sees the run, and it travels in the clear\n",
                        arguments.bind));
  }
  mention(server.url() + "\n", stdout);
  std::fflush(stdout);
  server.run();
  return kDone;
}

}  // namespace palpate::cli
