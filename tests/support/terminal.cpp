// SPDX-License-Identifier: MIT
#include "support/terminal.hpp"

#include "support/support.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::test {
namespace {

int count_of(const std::string& text, const std::string& piece) {
  int out = 0;
  for (std::size_t at = text.find(piece); at != std::string::npos; at = text.find(piece, at + piece.size())) ++out;
  return out;
}

}  // namespace

Terminal::Terminal(const std::vector<std::string>& words, const std::filesystem::path& folder,
                   const std::vector<std::string>& environment) {
  const std::vector<char*> arguments = arguments_of(words);
  const pid_t parent = ::getpid();
  pid_ = ::forkpty(&master_, nullptr, nullptr, nullptr);
  if (pid_ < 0) throw std::runtime_error("no terminal can be opened");
  if (pid_ > 0) return;
  become(arguments, folder, environment, parent);
}

Terminal::~Terminal() {
  if (pid_ > 0) {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  close();
}

bool Terminal::shows(const std::string& text, int times) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(10);
  while (count_of(screen_, text) < times) {
    if (std::chrono::steady_clock::now() > end || !read_on(100)) return false;
  }
  return true;
}

void Terminal::type(const std::string& keys) const {
  if (::write(master_, keys.data(), keys.size()) != static_cast<ssize_t>(keys.size())) {
    throw std::runtime_error("the terminal does not take what is typed");
  }
}

void Terminal::signal(int number) const {
  if (pid_ > 0) ::kill(pid_, number);  // -1, when it has ended, would be every process of the machine
}

void Terminal::close() {
  if (master_ >= 0) ::close(master_);
  master_ = -1;
}

int Terminal::wait() {
  while (master_ >= 0 && read_on(-1)) {
  }
  int status = 0;
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Takes what is shown within some time (-1: however long it takes); false once nobody can show anything any more.
bool Terminal::read_on(int milliseconds) {
  pollfd one{master_, POLLIN, 0};
  if (::poll(&one, 1, milliseconds) <= 0) return true;
  char piece[4096];
  const ssize_t size = ::read(master_, piece, sizeof piece);
  if (size > 0) screen_.append(piece, static_cast<std::size_t>(size));
  return size > 0;
}

}  // namespace palpate::test
