// SPDX-License-Identifier: MIT
// A client of `palpate watch` that sends what it likes, and the watchers that a command left behind.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

struct Answer {
  int status = 0;  ///< 0 where none came
  std::string head;
  std::string body;
};

/// A connection that is open.
class Connection {
 public:
  /// Sends `request` to the port of 127.0.0.1.
  Connection(int port, const std::string& request);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  /// All that comes until the other side closes it.
  std::string rest() const;

 private:
  int socket_ = -1;
};

/// Where a page is served.
class Address {
 public:
  /// From the line that the program prints.
  explicit Address(const std::string& line);
  int port() const { return port_; }
  const std::string& token() const { return token_; }

  /// GET of a place behind the token.
  Answer get(const std::string& place) const;
  std::unique_ptr<Connection> begin(const std::string& place) const;
  /// Any request.
  Answer ask(const std::string& request) const;
  /// The addresses on which somebody listens at the port, as /proc/net/tcp and tcp6 have them.
  std::vector<std::string> listening() const;

 private:
  std::string request(const std::string& place) const;

  int port_ = 0;
  std::string token_;
};

/// The processes `palpate-whole watch` that were started in a folder and are there; they end with this.
class Watchers {
 public:
  explicit Watchers(const std::filesystem::path& folder);
  ~Watchers();
  Watchers(const Watchers&) = delete;
  Watchers& operator=(const Watchers&) = delete;
  std::size_t count() const { return pids_.size(); }

 private:
  std::vector<int> pids_;
};

}  // namespace palpate::test
