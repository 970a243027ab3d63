// SPDX-License-Identifier: MIT
#include "children/arm_lock.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <mutex>
#include <set>

#include <fcntl.h>
#include <pthread.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace palpate {
namespace {

/// Descriptors of the sockets with which this process locks arms. A forked child would hold the locks, too. So in the
/// child, the null device replaces these sockets.
struct HeldSockets {
  std::mutex guard;
  std::set<int> numbers;
};

HeldSockets& held() {
  static HeldSockets* const all = [] {
    ::pthread_atfork([] { held().guard.lock(); }, [] { held().guard.unlock(); },
                     [] {
                       const FileDescriptor none(::open("/dev/null", O_RDONLY | O_CLOEXEC));
                       for (const int number : held().numbers) {
                         if (none) ::dup3(none.number(), number, O_CLOEXEC);
                       }
                       held().guard.unlock();
                     });
    return new HeldSockets;  // never destroyed, because the process may fork at any time
  }();
  return *all;
}

struct SocketName {
  sockaddr_un address{};
  socklen_t bytes = 0;
};

SocketName name_of(const std::string& arm) {
  const std::string text = "palpate arm " + arm;
  SocketName out;
  out.address.sun_family = AF_UNIX;
  const std::size_t length = std::min(text.size(), sizeof out.address.sun_path - 1);
  std::memcpy(out.address.sun_path + 1, text.data(), length);  // the zero byte before it makes the name abstract
  out.bytes = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  return out;
}

const sockaddr* generic(const SocketName& name) { return reinterpret_cast<const sockaddr*>(&name.address); }

FileDescriptor make_socket() {
  return above_standard(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
}

/// Returns a description of the process that holds the name.
std::string holder_of(const SocketName& name) {
  const FileDescriptor caller = make_socket();
  ucred who{};
  socklen_t size = sizeof who;
  const bool known = caller && ::connect(caller.number(), generic(name), name.bytes) == 0 &&
                     ::getsockopt(caller.number(), SOL_SOCKET, SO_PEERCRED, &who, &size) == 0 && who.pid > 0;
  return known ? "process " + std::to_string(who.pid) : "another process";
}

}  // namespace

ArmLock::ArmLock(const std::string& where, const std::string& arm) {
  const SocketName name = name_of(arm);
  const std::lock_guard<std::mutex> no_fork(held().guard);
  FileDescriptor socket = make_socket();
  // The socket accepts no connection. It only listens, so that holder_of() can connect and read the process id of the
  // holder.
  if (socket && ::bind(socket.number(), generic(name), name.bytes) == 0 && ::listen(socket.number(), SOMAXCONN) == 0) {
    held().numbers.insert(socket.number());
    socket_ = std::move(socket);
    return;
  }
  if (errno != EADDRINUSE)
    throw Error(where, "the arm " + arm + " cannot be locked: " + std::strerror(errno),
                "allow palpate to create unix sockets (unix(7))", Error::Kind::run);
  throw Error(where, "the arm " + arm + " is used by " + holder_of(name),
              "wait until that process has ended, or end it", Error::Kind::busy);
}

ArmLock::~ArmLock() {
  if (!socket_) return;
  const std::lock_guard<std::mutex> no_fork(held().guard);
  held().numbers.erase(socket_.number());
  socket_.close();
}

}  // namespace palpate
