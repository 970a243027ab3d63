// SPDX-License-Identifier: MIT
// HTTP server for the pages of a Site, which only reads.
//
// An address is http://HOST:PORT/TOKEN/PLACE, with a random token. Below it are the page and `news?at=POSITION`. The
// latter is answered when there is an update for a page at this position, or after a while by 204; with `&now` at once.
// Pages ask one request at a time (long polling). An open stream of events would occupy one of a browser's six
// connections to a server, and would fill up while a page draws slowly.
//
// The server answers with an empty 403 to requests without the token, and to requests that call the server by another
// name, such as those of a website whose name points to this machine. Unknown places get 404, methods other than GET
// 405. Headers forbid caches, frames and referrers.
//
// One thread suffices: replaying a tap takes milliseconds, and the other cores are for the run.
#pragma once

#include "watch/site.hpp"

#include <memory>
#include <string>

namespace palpate {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< numeric; any machine that reaches this address reaches the server
  int port = 0;                       ///< 0: any free port
  /// Seconds without a working process and without requests after which the server ends; 0: never. Longer than a
  /// browser suspends a page in the background.
  int patience = 0;
};

class Server {
 public:
  /// Opens the port. `site` must outlive the object. Throws Error for an invalid address, and if the port is taken.
  Server(Site& site, const ServerOptions& options);
  ~Server();

  /// Returns the address of the first page, with the token.
  std::string url() const;
  /// Returns whether other machines can reach the server.
  bool is_open_to_others() const;

  /// Serves until SIGINT, SIGTERM or SIGHUP (unless ignored), or until patience ends.
  void run();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
