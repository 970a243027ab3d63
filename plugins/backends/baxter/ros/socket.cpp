// SPDX-License-Identifier: MIT
#include "baxter/ros/socket.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <unistd.h>

namespace palpate::baxter {
namespace {

using std::chrono::milliseconds;

/// What is left until a deadline, never negative.
std::chrono::nanoseconds left(Deadline deadline) {
  return std::max(std::chrono::nanoseconds(deadline - Steady::now()), std::chrono::nanoseconds(0));
}

[[noreturn]] void refuse(int error) { throw Unreached(Unreached::Why::refused, std::strerror(error)); }

/// A look-up under way, in memory that may have to outlive who asked.
struct LookUp {
  explicit LookUp(const std::string& host) : name(host) {
    const char* ipv6 = std::getenv("ROS_IPV6");  // as roscpp has it, whose connections these addresses foretell
    hints.ai_family = ipv6 != nullptr && std::strcmp(ipv6, "on") == 0 ? AF_UNSPEC : AF_INET;
    hints.ai_socktype = SOCK_STREAM;
    request.ar_name = name.c_str();
    request.ar_request = &hints;
  }
  ~LookUp() {
    if (request.ar_result != nullptr) freeaddrinfo(request.ar_result);
  }
  LookUp(const LookUp&) = delete;
  LookUp& operator=(const LookUp&) = delete;

  std::string name;
  addrinfo hints{};
  gaicb request{};
};

Address first_address(const addrinfo* result, int port) {
  Address address;
  std::memcpy(&address.storage, result->ai_addr, result->ai_addrlen);
  address.length = result->ai_addrlen;
  const in_port_t number = htons(static_cast<in_port_t>(port));
  if (result->ai_family == AF_INET) {
    reinterpret_cast<sockaddr_in*>(&address.storage)->sin_port = number;
  } else {
    reinterpret_cast<sockaddr_in6*>(&address.storage)->sin6_port = number;
  }
  return address;
}

}  // namespace

Deadline within(milliseconds longest, Deadline deadline) { return std::min(deadline, Steady::now() + longest); }

Address look_up(const std::string& host, int port, Deadline deadline) {
  auto query = std::make_unique<LookUp>(host);
  query->hints.ai_flags = AI_NUMERICHOST;  // needs nobody's help and so no thread
  if (getaddrinfo(host.c_str(), nullptr, &query->hints, &query->request.ar_result) == 0) {
    return first_address(query->request.ar_result, port);
  }
  query->hints.ai_flags = 0;
  gaicb* list[] = {&query->request};
  int error = getaddrinfo_a(GAI_NOWAIT, list, 1, nullptr);
  while (error == 0) {
    error = gai_error(&query->request);
    if (error != EAI_INPROGRESS) break;
    const auto rest = left(deadline);
    if (rest.count() == 0) {
      // One that has begun cannot be stopped: the C library goes on writing to it.
      if (gai_cancel(&query->request) == EAI_NOTCANCELED) query.release();
      throw Unreached(Unreached::Why::name, "looking it up takes too long");
    }
    const timespec pause{static_cast<time_t>(rest.count() / 1'000'000'000),
                         static_cast<long>(rest.count() % 1'000'000'000)};
    gai_suspend(list, 1, &pause);
    error = 0;
  }
  if (error != 0) throw Unreached(Unreached::Why::name, gai_strerror(error));
  return first_address(query->request.ar_result, port);
}

Wire::Wire(const Address& address, Deadline deadline)
    : socket_(socket(address.storage.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
  if (socket_ < 0) refuse(errno);
  try {
    if (connect(socket_, reinterpret_cast<const sockaddr*>(&address.storage), address.length) == 0) return;
    if (errno != EINPROGRESS) refuse(errno);
    wait(POLLOUT, deadline);
    int error = 0;
    socklen_t size = sizeof error;
    getsockopt(socket_, SOL_SOCKET, SO_ERROR, &error, &size);
    if (error != 0) refuse(error);
  } catch (...) {
    close(socket_);
    throw;
  }
}

Wire::~Wire() { close(socket_); }

void Wire::wait(short events, Deadline deadline) const {
  pollfd entry{socket_, events, 0};
  for (;;) {
    const auto rest = left(deadline);
    const timespec pause{static_cast<time_t>(rest.count() / 1'000'000'000),
                         static_cast<long>(rest.count() % 1'000'000'000)};
    const int ready = ppoll(&entry, 1, &pause, nullptr);
    if (ready > 0) return;
    if (ready < 0 && errno != EINTR) refuse(errno);
    if (ready == 0) throw Unreached(Unreached::Why::silent, "no answer in time");
  }
}

void Wire::send(const std::string& bytes, Deadline deadline) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count >= 0) {
      sent += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      wait(POLLOUT, deadline);
    } else if (errno != EINTR) {
      refuse(errno);
    }
  }
}

std::string Wire::receive_some(std::size_t most, Deadline deadline) {
  std::string bytes(most, '\0');
  for (;;) {
    const ssize_t count = recv(socket_, bytes.data(), bytes.size(), 0);
    if (count >= 0) {
      bytes.resize(static_cast<std::size_t>(count));
      return bytes;
    }
    if (errno == EAGAIN || errno == EWOULDBLOCK) {
      wait(POLLIN, deadline);
    } else if (errno != EINTR) {
      refuse(errno);
    }
  }
}

std::string Wire::receive(std::size_t bytes, Deadline deadline) {
  std::string all;
  while (all.size() < bytes) {
    const std::string some = receive_some(std::min<std::size_t>(bytes - all.size(), 65536), deadline);
    if (some.empty()) throw Unreached(Unreached::Why::nonsense, "the connection was ended");
    all += some;
  }
  return all;
}

}  // namespace palpate::baxter
