// SPDX-License-Identifier: MIT
// Arguments of `palpate watch`.
#pragma once

#include "cli/command_line.hpp"

namespace palpate::cli {

struct WatchArguments {
  std::string directory;
  std::string bind = "127.0.0.1";
  int port = 0;  ///< 0: any free port
  bool until_left = false;
};
PALPATE_WHOLE int watch(CommandEnvironment& program, const WatchArguments& arguments);

inline void add_watch(CommandLine& line) {
  auto [command, watched] = line.add<WatchArguments>(
      "watch", "Serve a web page that follows a run or sweep while it runs", watch,
      [](NeededParts& needs, const WatchArguments& arguments) { needs.whole_and_record(arguments.directory); });
  command.record("DIR", watched.directory, RecordKind::any, "run or sweep");
  constexpr int kLastPort = 65535;
  command.argument("--port", watched.port, "N", "port of the web page; default: any free port",
                   {between(1, kLastPort)});
  command.argument(
      "--bind", watched.bind, "ADDRESS",
      "numeric IP address of the web page's server. Other machines can open the page if they can reach this "
      "address",
      {with_default()});
  command.flag("--until-left", watched.until_left,
               "end the server two minutes after the run has ended and the last page was closed. Without this option, "
               "only Ctrl-C ends the server");
  command.examples({"palpate watch runs/object_i/422cd70eb5f7", "palpate watch many@latest --port 8000"});
}

}  // namespace palpate::cli
