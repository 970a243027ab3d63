// SPDX-License-Identifier: MIT
// HTTP server for the pages of a Site. It cannot change a record.
//
// An address is http://HOST:PORT/TOKEN/PLACE, with a random token. The page has this address, and its updates have the
// address `news?at=POSITION` relative to the page. The server answers a request for news when there is an update for a
// page at this position, or with 204 after a while. If the request contains `&now`, the server answers at once. Each
// page has one request at a time (long polling). A stream of events would instead occupy one of the six connections
// that a browser has per server, and would fill up while a page draws slowly.
//
// The server answers with an empty 403 to requests without the token. It also answers with 403 if the host name in a
// request is foreign, as in requests from a website whose name resolves to this machine. Unknown places get the status
// 404, and methods other than GET the status 405. Headers forbid caching, frames and referrers.
//
// One thread suffices: replaying a tap takes milliseconds, and the other cores are for the run.
#pragma once

#include "watch/site.hpp"

#include <memory>
#include <string>

namespace palpate {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< numeric address; any machine that can reach this address can reach the server
  int port = 0;                       ///< 0 stands for any free port
  /// Number of seconds after which the server ends if no process works on the record and no request arrives. 0 stands
  /// for never. The value must be longer than the time for which a browser suspends a page in the background.
  int patience = 0;
};

class Server {
 public:
  /// Opens the port. `site` must outlive the object. Throws Error for an invalid address, and if the port is taken.
  Server(Site& site, const ServerOptions& options);
  ~Server();

  /// Returns the address of the first page, with the token.
  std::string url() const;
  /// Returns whether the server accepts connections from other machines.
  bool is_open_to_others() const;

  /// Serves until SIGINT, SIGTERM, SIGHUP (unless ignored), or until ServerOptions::patience has passed.
  void run();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
