// SPDX-License-Identifier: MIT
// TCP of which no step outlasts its deadline. roscpp's own look-ups and calls wait for ever when a host is gone, so
// whatever could wait is asked over this before roscpp begins. Knows no ROS.
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

namespace palpate::baxter {

using Steady = std::chrono::steady_clock;
using Deadline = Steady::time_point;
using Address = boost::asio::ip::tcp::endpoint;

/// The earlier of `deadline` and `longest` from now.
Deadline within(std::chrono::milliseconds longest, Deadline deadline);

/// Why nothing came of talking to a host; caught inside ros/, where it becomes an Error for the user.
class Unreached : public std::runtime_error {
 public:
  enum class Why {
    name,      ///< the host's name has no address
    refused,   ///< the host, or the way to it, says no
    silent,    ///< nobody answered in time
    nonsense,  ///< somebody answered who does not speak the protocol, or says that it cannot serve
  };
  Unreached(Why why, const std::string& words) : std::runtime_error(words), why_(why) {}
  Why why() const { return why_; }

 private:
  Why why_;
};

/// A thread that hears no signals: they are for those that were there before.
std::thread deaf_thread(const std::function<void()>& run);

/// The address of a host by its name or number. Throws Unreached (`name`), also when the answer takes too long.
Address look_up(const std::string& host, int port, Deadline deadline);

/// A TCP connection. All members throw Unreached.
class Wire {
 public:
  Wire(const Address& address, Deadline deadline);

  void send(const std::string& bytes, Deadline deadline);

  /// Exactly so many bytes.
  std::string receive(std::size_t bytes, Deadline deadline);

  /// What is there, at least one byte, at most `most`; empty when the other side has ended the connection.
  std::string receive_some(std::size_t most, Deadline deadline);

 private:
  template <class Begin>
  std::size_t finish(Deadline deadline, const Begin& begin);

  boost::asio::io_context io_;
  boost::asio::ip::tcp::socket socket_{io_};
};

}  // namespace palpate::baxter
