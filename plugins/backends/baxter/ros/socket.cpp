// SPDX-License-Identifier: MIT
#include "baxter/ros/socket.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <future>
#include <memory>

#include <netdb.h>
#include <pthread.h>
#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

namespace palpate::baxter {
namespace {

namespace asio = boost::asio;
using Why = Unreached::Why;

/// The first address of a name. With AI_NUMERICHOST it needs nobody's help.
Address first_address(const std::string& host, int flags) {
  addrinfo hints{};
  const char* ipv6 = std::getenv("ROS_IPV6");  // as roscpp has it, whose connections these addresses foretell
  hints.ai_family = ipv6 != nullptr && std::strcmp(ipv6, "on") == 0 ? AF_UNSPEC : AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = flags;
  addrinfo* list = nullptr;
  const int error = getaddrinfo(host.c_str(), nullptr, &hints, &list);
  if (error != 0) throw Unreached(Why::name, gai_strerror(error));
  Address out;
  std::memcpy(out.data(), list->ai_addr, std::min<std::size_t>(list->ai_addrlen, out.capacity()));
  freeaddrinfo(list);
  return out;
}

}  // namespace

Deadline within(std::chrono::milliseconds longest, Deadline deadline) {
  return std::min(deadline, Steady::now() + longest);
}

std::thread deaf_thread(const std::function<void()>& run) {
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  std::thread out(run);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return out;
}

Address look_up(const std::string& host, int port, Deadline deadline) {
  Address out;
  try {
    out = first_address(host, AI_NUMERICHOST);
  } catch (const Unreached&) {
    // One that has begun cannot be stopped: it goes on by itself.
    const auto task = std::make_shared<std::packaged_task<Address()>>([host] { return first_address(host, 0); });
    std::future<Address> found = task->get_future();
    deaf_thread([task] { (*task)(); }).detach();
    if (found.wait_until(deadline) != std::future_status::ready) {
      throw Unreached(Why::name, "looking it up takes too long");
    }
    out = found.get();
  }
  out.port(static_cast<unsigned short>(port));
  return out;
}

/// Waits for what `begin` begins, which hands its outcome to a handler; how many bytes it was. 0 where the other side
/// has ended the connection.
template <class Begin>
std::size_t Wire::finish(Deadline deadline, const Begin& begin) {
  boost::system::error_code error;
  std::size_t bytes = 0;
  begin([&](const boost::system::error_code& outcome, std::size_t count = 0) {
    error = outcome;
    bytes = count;
  });
  io_.restart();
  io_.run_until(deadline);
  if (!io_.stopped()) {
    socket_.close(error);
    io_.run();
    throw Unreached(Why::silent, "no answer in time");
  }
  if (error == asio::error::eof) return 0;
  if (error) throw Unreached(Why::refused, error.message());
  return bytes;
}

Wire::Wire(const Address& address, Deadline deadline) {
  // Not by the library, which would leave it open in programs that are started meanwhile.
  const int opened = ::socket(address.data()->sa_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (opened < 0) throw Unreached(Why::refused, std::strerror(errno));
  socket_.assign(address.protocol(), opened);
  finish(deadline, [&](const auto& done) { socket_.async_connect(address, done); });
}

void Wire::send(const std::string& bytes, Deadline deadline) {
  finish(deadline, [&](const auto& done) { asio::async_write(socket_, asio::buffer(bytes), done); });
}

std::string Wire::receive_some(std::size_t most, Deadline deadline) {
  std::string bytes(most, '\0');
  bytes.resize(finish(deadline, [&](const auto& done) { socket_.async_read_some(asio::buffer(bytes), done); }));
  return bytes;
}

std::string Wire::receive(std::size_t bytes, Deadline deadline) {
  std::string all;
  while (all.size() < bytes) {
    const std::string some = receive_some(std::min<std::size_t>(bytes - all.size(), 65536), deadline);
    if (some.empty()) throw Unreached(Why::nonsense, "the connection was ended");
    all += some;
  }
  return all;
}

}  // namespace palpate::baxter
