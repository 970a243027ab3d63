// SPDX-License-Identifier: MIT
#include "cli/watch.hpp"

#include "cli/display.hpp"
#include "cli/output.hpp"
#include "record/run_directory.hpp"
#include "watch/server.hpp"

#include <fmt/format.h>

#include <sys/resource.h>

namespace palpate::cli {

int watch(CommandEnvironment& program, const WatchArguments& arguments) {
  constexpr int kIdleSeconds = 120;
  // This process computes the watched run a second time, so it gets a lower priority than the run. The page of a sweep
  // needs little computing time. Its priority is higher than that of a run's page, because the jobs of the sweep occupy
  // all cores.
  ::setpriority(PRIO_PROCESS, 0, is_sweep(arguments.directory) ? 10 : 19);
  Site site(program, arguments.directory);
  Server server(site, {arguments.bind, arguments.port, arguments.until_left ? kIdleSeconds : 0});
  if (server.is_open_to_others())
    print_message(fmt::format(
        "watch: anyone who can reach {} and has this address can see the run; the connection is not encrypted\n",
        arguments.bind));
  print_text(server.url() + "\n");
  flush_output();
  server.run();
  return kDone;
}

}  // namespace palpate::cli
