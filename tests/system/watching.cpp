// SPDX-License-Identifier: MIT
#include "system/watching.hpp"

#include "support/support.hpp"

#include <csignal>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <iterator>
#include <sstream>
#include <stdexcept>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace palpate::test {

namespace fs = std::filesystem;

Connection::Connection(int port, const std::string& request)
    : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in place{};
  place.sin_family = AF_INET;
  place.sin_port = htons(static_cast<std::uint16_t>(port));
  place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0)
    throw std::runtime_error("cannot connect");
  // What is refused in the middle of a long request is not to kill the test.
  for (std::size_t sent = 0; sent < request.size();) {
    const ssize_t some = ::send(socket_, request.data() + sent, request.size() - sent, MSG_NOSIGNAL);
    if (some <= 0) break;
    sent += static_cast<std::size_t>(some);
  }
}

Connection::~Connection() { ::close(socket_); }

std::string Connection::rest() const {
  std::string out;
  char some[4096];
  for (ssize_t got; (got = ::read(socket_, some, sizeof some)) > 0;) out.append(some, static_cast<std::size_t>(got));
  return out;
}

Address::Address(const std::string& line) {
  char token[64] = "";
  if (std::sscanf(line.c_str(), "http://%*[^:]:%d/%63[0-9a-f]/", &port_, token) != 2)
    throw std::runtime_error("no address: " + line);
  token_ = token;
}

std::string Address::request(const std::string& place) const {
  return "GET /" + token_ + "/" + place + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port_) + "\r\n\r\n";
}

std::unique_ptr<Connection> Address::begin(const std::string& place) const {
  return std::make_unique<Connection>(port_, request(place));
}

Answer Address::get(const std::string& place) const { return ask(request(place)); }

Answer Address::ask(const std::string& request) const {
  const std::string text = Connection(port_, request).rest();
  Answer out;
  const auto end = text.find("\r\n\r\n");
  if (std::sscanf(text.c_str(), "HTTP/1.1 %d", &out.status) != 1 || end == std::string::npos) return out;
  out.head = text.substr(0, end);
  out.body = text.substr(end + 4);
  return out;
}

std::vector<std::string> Address::listening() const {
  std::ostringstream port;
  port << ":" << std::hex << std::uppercase << std::setw(4) << std::setfill('0') << port_;
  std::vector<std::string> out;
  for (const char* file : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      std::string number, local, remote, state;
      words >> number >> local >> remote >> state;
      const auto colon = local.find(':');
      if (state == "0A" && colon != std::string::npos && local.substr(colon) == port.str())
        out.push_back(local.substr(0, colon));
    }
  }
  return out;
}

Watchers::Watchers(const fs::path& folder) {
  for (const auto& one : fs::directory_iterator("/proc")) {
    const std::string name = one.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    std::error_code gone;
    const fs::path place = fs::read_symlink(one.path() / "cwd", gone);
    std::ifstream in(one.path() / "cmdline", std::ios::binary);
    std::ostringstream words;
    words << in.rdbuf();  // where the process ends meanwhile, this sets failbit; an iterator of the buffer would throw
    const bool watches = words.str().find(std::string("\0watch\0", 7)) != std::string::npos;
    if (!gone && watches && place == fs::canonical(folder)) pids_.push_back(std::stoi(name));
  }
}

Watchers::~Watchers() {
  for (const int pid : pids_) ::kill(pid, SIGTERM);
}

}  // namespace palpate::test
