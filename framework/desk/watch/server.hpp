// SPDX-License-Identifier: MIT
// Serves the pages of a Site over HTTP: to who has the address, and nothing but reading.
//
// An address is http://HOST:PORT/TOKEN/PLACE, with a token that nobody can guess. Below it lie the page itself and
// `news?at=WHERE`, which is answered once there is something that a page at WHERE lacks, or, after a while, by 204;
// with
// `&now` at once. Pages ask one page_request at a time (long polling): an open stream of events would take one of the
// six connections that a browser has for a server for as long as its page is open somewhere, and would fill up with
// what a page that draws slowly has no use for.
//
// Answered with an empty 403 is who has not the token, or calls the server by a name that is not its own, as a page of
// another site does that has had its own name point here; with 404 what is not there, with 405 all but GET. Nothing is
// kept by caches, framed, or told to other sites.
//
// One thread does everything, because a tap that is lived through takes milliseconds, and the run that is watched needs
// the other cores.
#pragma once

#include "watch/site.hpp"

#include <memory>
#include <string>

namespace palpate {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< numeric; who can reach it can reach the server
  int port = 0;                       ///< 0: any that is free
  /// Ends once nobody works on the record and no page has asked for this long, seconds; 0: never by itself. It is
  /// longer than a browser lets a page in the background sleep.
  int patience = 0;
};

class Server {
 public:
  /// Takes the port. `site` must outlive it. Throws Error where the address is none or the port is taken.
  Server(Site& site, const ServerOptions& options);
  ~Server();

  /// Where the first page is, with the token.
  std::string url() const;
  /// Whether others than this machine can reach it.
  bool is_open_to_others() const;

  /// Serves until a signal asks it to end (SIGINT, SIGTERM, SIGHUP where that is not ignored), or patience does.
  void run();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate
