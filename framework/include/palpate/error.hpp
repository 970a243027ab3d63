// SPDX-License-Identifier: MIT
// The one exception of the project: bad input from outside, told in one line with place, reason and remedy.
#pragma once

#include <exception>
#include <string>
#include <utility>

namespace palpate {

/// Thrown for input that the user can mend: a config, a file, a plugin, a robot. Numerical trouble is never an
/// exception but part of a result. Programs print `what()` as it stands: "where: reason, hint", on one line.
///
/// Throwing it from a plugin's constructor is the right way to refuse options; leave `where` empty there or name the
/// option, the plugin host knows the place in the config and fills it in.
class Error : public std::exception {
 public:
  /// What the failure means to the caller of the program; it decides the exit status.
  enum class Kind {
    usage,  ///< wrong command line, config or plugin: exit 2
    run,    ///< the run itself failed: exit 1
    busy,   ///< not now: another process holds the run or its arm, or a program was changed; nothing was begun: exit 75
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
