// SPDX-License-Identifier: MIT
// What tests share: a folder that vanishes, the program run as a user runs it, and the places of this build.
#pragma once

#include "host/plugin_host.hpp"

#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace palpate::test {

/// A fresh folder, removed with all that is in it at the end of the test.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file below the folder, making folders on the way, and returns its path.
  std::filesystem::path write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path path_;
};

/// What a program left behind when it ended.
struct Ended {
  int status = 0;  ///< exit status; 128 + signal if a signal ended it
  std::string out;
  std::string err;
};

/// The words as execvp() takes them, which must outlive it; for a child just forked by `parent`, what becomes of it:
/// that program in `folder`, killed when the thread that forked it ends.
std::vector<char*> arguments_of(const std::vector<std::string>& words);
[[noreturn]] void become(const std::vector<char*>& arguments, const std::filesystem::path& folder,
                         const std::vector<std::string>& environment, int parent);

/// A program under way, started without a shell.
class Child {
 public:
  /// `words[0]` is the program. `folder` becomes its working directory; `environment` adds NAME=VALUE, and NAME alone
  /// takes it away. It is killed when the thread that made it ends, however that ends.
  Child(const std::vector<std::string>& words, const std::filesystem::path& folder,
        const std::vector<std::string>& environment = {});
  ~Child();
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void signal(int number) const;
  /// Waits for its end and collects what it printed; once only. What has not ended after `limit` seconds is killed.
  Ended wait(double limit = 1e9);

  int pid() const { return pid_; }
  bool running() const;
  /// What it printed so far.
  std::string out() const;
  std::string err() const;

 private:
  TemporaryFolder scratch_;
  int pid_ = -1;
};

/// Runs a program to its end.
Ended run_program(const std::vector<std::string>& words, const std::filesystem::path& folder,
                  const std::vector<std::string>& environment = {});

/// Runs `palpate` of this build with `words` behind it, in `folder`.
Ended palpate(const std::vector<std::string>& words, const std::filesystem::path& folder,
              const std::vector<std::string>& environment = {});

/// The rows of a CSV text, quotes taken away: cells by the names of the header. Throws std::runtime_error for a row of
/// another length.
using Cells = std::map<std::string, std::string>;
std::vector<Cells> csv_rows(const std::string& text);

/// The folder of the project's sources, the program and the plugins of this build.
std::filesystem::path source_folder();
std::filesystem::path program_file();
std::filesystem::path plugin_folder();

/// The search path of one deliberately broken plugin (tests/bad_plugins): <folder>/<kind>/<name>.so with the name of
/// the case.
std::filesystem::path bad_plugin_folder(const std::string& name);

/// A host over the plugins of this build, shared by the tests of one process.
const PluginHost& shared_host();

/// The text of a file.
std::string text_of(const std::filesystem::path& file);

/// The one run directory below `runs`; fails the test if there is not exactly one.
std::filesystem::path only_run(const std::filesystem::path& runs);

/// An environment variable that has a value while this lives.
class EnvironmentVariable {
 public:
  EnvironmentVariable(std::string name, const std::string& value) : name_(std::move(name)) {
    if (const char* before = std::getenv(name_.c_str())) before_ = before;
    setenv(name_.c_str(), value.c_str(), 1);
  }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;
  ~EnvironmentVariable() { before_ ? setenv(name_.c_str(), before_->c_str(), 1) : unsetenv(name_.c_str()); }

 private:
  std::string name_;
  std::optional<std::string> before_;
};

}  // namespace palpate::test
