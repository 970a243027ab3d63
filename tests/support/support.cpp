// SPDX-License-Identifier: MIT
#include "support/support.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace palpate::test {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder() {
  std::string name = (fs::temp_directory_path() / "palpate-test-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

fs::path TemporaryFolder::write(const std::string& name, const std::string& text) const {
  const fs::path file = path_ / name;
  fs::create_directories(file.parent_path());
  if (fs::is_symlink(file)) fs::remove(file);  // or what it leads to, far from here, would be written
  std::ofstream(file, std::ios::binary) << text;
  return file;
}

std::vector<char*> arguments_of(const std::vector<std::string>& words) {
  std::vector<char*> out;
  for (const std::string& word : words) out.push_back(const_cast<char*>(word.c_str()));
  out.push_back(nullptr);
  return out;
}

// Only calls that are safe after a fork, up to setenv, which no other thread can disturb here.
void become(const std::vector<char*>& arguments, const fs::path& folder, const std::vector<std::string>& environment,
            int parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // the test was gone before the line above
  for (const std::string& one : environment) ::putenv(const_cast<char*>(one.c_str()));
  for (const int number : {SIGINT, SIGTERM, SIGHUP})
    std::signal(number, SIG_DFL);  // a script's background ignores some
  if (::chdir(folder.c_str()) == 0) ::execvp(arguments.front(), arguments.data());
  ::_exit(127);
}

Child::Child(const std::vector<std::string>& words, const fs::path& folder,
             const std::vector<std::string>& environment) {
  const std::string out = (scratch_.path() / "out").string();
  const std::string err = (scratch_.path() / "err").string();
  const std::vector<char*> arguments = arguments_of(words);
  const pid_t parent = ::getpid();
  pid_ = ::fork();
  if (pid_ < 0) throw std::runtime_error("cannot fork");
  if (pid_ > 0) return;
  ::dup2(::open("/dev/null", O_RDONLY), STDIN_FILENO);
  ::dup2(::open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
  ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
  become(arguments, folder, environment, parent);
}

Child::~Child() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

void Child::signal(int number) const {
  if (pid_ > 0) ::kill(pid_, number);  // -1, when it has ended, would be every process of the machine
}

bool Child::running() const {
  siginfo_t info{};
  return pid_ > 0 && ::waitid(P_PID, static_cast<id_t>(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         info.si_pid == 0;
}

std::string Child::out() const { return text_of(scratch_.path() / "out"); }
std::string Child::err() const { return text_of(scratch_.path() / "err"); }

Ended Child::wait(double limit) {
  if (pid_ < 0) throw std::logic_error("a program's end can be waited for once");
  if (limit < 1e8) {
    // Looks again and again: a process cannot be waited for with a limit otherwise, but by threads or signals.
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(limit);
    while (running() && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    if (running()) signal(SIGKILL);
  }
  int status = 0;
  ::waitpid(pid_, &status, 0);
  pid_ = -1;
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return {code, out(), err()};
}

Ended run_program(const std::vector<std::string>& words, const fs::path& folder,
                  const std::vector<std::string>& environment) {
  return Child(words, folder, environment).wait();
}

Ended palpate(const std::vector<std::string>& words, const fs::path& folder,
              const std::vector<std::string>& environment) {
  std::vector<std::string> all{program_file().string()};
  all.insert(all.end(), words.begin(), words.end());
  return run_program(all, folder, environment);
}

std::vector<Cells> csv_rows(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  bool quoted = false;
  bool begins = true;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (begins) lines.emplace_back(1);
    begins = !quoted && c == '\n';
    if (c == '"' && quoted && i + 1 < text.size() && text[i + 1] == '"') {
      lines.back().back() += text[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      lines.back().emplace_back();
    } else if (!begins) {
      lines.back().back() += c;
    }
  }
  std::vector<Cells> rows;
  for (std::size_t line = 1; line < lines.size(); ++line) {
    if (lines[line].size() != lines[0].size()) {
      throw std::runtime_error("a row of another length: " + std::to_string(line) + ", which begins " + lines[line][0]);
    }
    rows.emplace_back();
    for (std::size_t i = 0; i < lines[0].size(); ++i) rows.back()[lines[0][i]] = lines[line][i];
  }
  return rows;
}

fs::path source_folder() { return PALPATE_SOURCE_FOLDER; }
fs::path program_file() { return fs::path(PALPATE_BUILD_FOLDER) / "palpate"; }
fs::path plugin_folder() { return fs::path(PALPATE_BUILD_FOLDER) / "lib" / "palpate"; }
fs::path bad_plugin_folder(const std::string& name) {
  return fs::path(PALPATE_BUILD_FOLDER) / "tests" / "bad_plugins" / name;
}

const PluginHost& shared_host() {
  static const PluginHost host({plugin_folder()});
  return host;
}

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

fs::path only_run(const fs::path& runs) {
  std::vector<fs::path> found;
  for (const auto& name : fs::directory_iterator(runs)) {
    for (const auto& id : fs::directory_iterator(name.path())) found.push_back(id.path());
  }
  EXPECT_EQ(found.size(), 1U);
  return found.empty() ? fs::path() : found.front();
}

}  // namespace palpate::test
