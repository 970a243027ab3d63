// SPDX-License-Identifier: MIT
// A folder in which a test calls palpate as a user does, and looks at what that leaves there.
#pragma once

#include "record/row.hpp"
#include "support/parts.hpp"
#include "system/shipped.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace palpate::test {

/// Words of a command line: given one by one, or as a text that is cut at its blanks.
struct Words : std::vector<std::string> {
  Words() = default;
  Words(std::initializer_list<std::string> words) : vector(words) {}
  Words(const std::vector<std::string>& words) : vector(words) {}
  Words(const std::string& text);
  Words(const char* text) : Words(std::string(text)) {}
};

Words operator+(Words words, const Words& more);
/// The same, but what `more` sets KEY=VALUE takes the place of what `words` sets: a key may be given once.
Words set_by(const Words& words, const Words& more);

class Shell : public testing::Test {
 protected:
  const std::filesystem::path& here() const { return folder_.path(); }
  /// Writes a file, whose path may start here, and returns its path.
  std::filesystem::path write(const std::filesystem::path& file, const std::string& text) const {
    return folder_.write(file.string(), text);
  }
  /// Puts `text` in the place of the first `part` of a file, which must be there.
  void replace(const std::filesystem::path& file, const std::string& part, const std::string& text) const;

  Ended palpate(const Words& words) const { return test::palpate(words, here(), environment_); }
  Ended run(const Words& more = {}, const std::string& file = paper()) const {
    return palpate(Words{"run", file} + more);
  }
  Ended sweep(const Words& more, const std::string& file = paper()) const {
    return palpate(Words{"sweep", file} + more);
  }
  Ended status_of(const std::filesystem::path& directory) const { return palpate({"status", directory}); }
  Ended resume(const std::filesystem::path& directory, const Words& more = {}) const {
    return palpate(Words{"resume", directory, "--quiet"} + more);
  }
  /// `palpate` under way.
  std::unique_ptr<Child> begin(const Words& words) const;

  /// `palpate run --quiet`, which must succeed, and the directory that it made.
  std::filesystem::path ran(const Words& more = {}, const std::string& file = paper()) const;
  /// `palpate sweep --quiet`, which must end with `status`, and the directory that it made.
  std::filesystem::path swept(const Words& more, const std::string& file = paper(), int status = 0) const;
  /// The one line on stderr of a command that prints nothing else and ends with `status`.
  std::string refused(const Words& words, int status = 2) const;

  /// The only run or sweep below a folder here.
  std::filesystem::path directory(const std::string& runs = "runs") const { return only_run(here() / runs); }
  bool left_nothing() const { return !std::filesystem::exists(here() / "runs"); }

  /// As if the run had been killed in the middle of a tap, or had been made by another build of the program.
  void break_off(const std::filesystem::path& run) const;
  void make_of_another_build(const std::filesystem::path& run) const;

  TemporaryFolder folder_;
  std::vector<std::string> environment_;  ///< of palpate, NAME=VALUE
};

/// The search path of a plugin of tests/bad_plugins, for environment_.
inline std::string with_plugin(const std::string& name) {
  return "PALPATE_PLUGIN_PATH=" + bad_plugin_folder(name).string();
}

/// The rows of a file that has an object per line.
std::vector<Row> json_rows(const std::filesystem::path& file);
/// The directory of a job of a sweep, by its number.
std::filesystem::path job_of(const std::filesystem::path& sweep, int index);
/// The folders below jobs/, in no order.
std::vector<std::filesystem::path> jobs_of(const std::filesystem::path& sweep);

/// Cuts the taps of a run in their middle, and with them what a job has recorded behind them.
void cut_taps(const std::filesystem::path& run);

/// The outcome of each tap of a run.
std::vector<std::string> outcomes(const std::filesystem::path& run);

}  // namespace palpate::test

namespace palpate {

using test::cut_taps;
using test::job_of;
using test::jobs_of;
using test::json_rows;
using test::outcomes;
using test::part_of;
using test::rows_of;
using test::set_by;
using test::Shell;
using test::Words;

}  // namespace palpate
