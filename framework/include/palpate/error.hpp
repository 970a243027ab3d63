// SPDX-License-Identifier: MIT
// The only exception of the project: bad input from outside, reported in one line with place, reason and remedy.
#pragma once

#include <exception>
#include <string>
#include <utility>

namespace palpate {

/// Thrown for input that the user can correct: a config, a file, a plugin, a robot. Numerical problems are never
/// exceptions, but part of a result. Programs print `what()`, "where: reason, hint" on one line.
///
/// A plugin's constructor throws Error to reject options. There, `where` is empty or the name of the option; the plugin
/// host adds the position in the config.
class Error : public std::exception {
 public:
  /// Class of the failure, which decides the exit status of the program.
  enum class Kind {
    usage,  ///< wrong command line, config or plugin: exit 2
    run,    ///< the run itself failed: exit 1
    /// Another process uses the run or its arm, or a program file of the run was changed. Nothing was started: exit 75.
    busy,
  };

  Error(std::string where, std::string reason, std::string hint = {}, Kind kind = Kind::usage)
      : where_(std::move(where)), reason_(std::move(reason)), hint_(std::move(hint)), kind_(kind) {
    line_ = where_.empty() ? reason_ : where_ + ": " + reason_;
    if (!hint_.empty()) line_ += ", " + hint_;
    for (char& c : line_) {
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    }
  }

  const char* what() const noexcept override { return line_.c_str(); }

  const std::string& where() const { return where_; }
  const std::string& reason() const { return reason_; }
  const std::string& hint() const { return hint_; }
  Kind kind() const { return kind_; }

 private:
  std::string where_;
  std::string reason_;
  std::string hint_;
  Kind kind_;
  std::string line_;
};

}  // namespace palpate
