// SPDX-License-Identifier: MIT
// What the command line says of itself: one list, behind `--help`, the manual and what a shell completes.
#pragma once

#include <string>
#include <vector>

namespace palpate::cli {

/// What stands behind a command: by its place, or an option by its name.
struct Argument {
  std::vector<std::string> names;  ///< "--runs"; "-j"; of what stands by its place the one name, "CONFIG"
  bool by_place = false;
  std::string value;                 ///< what its value is, in a word: FOLDER, N, KEY=VALUE; "" for a flag
  std::vector<std::string> choices;  ///< the values that there are; none where there are more than a few
  std::string limits;                ///< of a number, in words; or ""
  std::string default_value;         ///< or ""
  std::string meaning;
  std::string heading;  ///< under which it is shown
  bool required = false;
  bool repeated = false;                ///< may be given several times
  std::vector<std::string> only_with;   ///< options without which it means nothing
  std::vector<std::string> never_with;  ///< options that contradict it
};

struct Command {
  std::string name;  ///< "" for the program itself
  std::string summary;
  std::vector<Argument> arguments;    ///< in the order in which they are shown, those of a heading together
  std::vector<std::string> examples;  ///< whole lines, as typed
};

struct Usage {
  Command program;
  std::vector<Command> commands;
};

/// The line behind "Usage:".
std::string synopsis(const Command& command);

/// "--launcher NAME", "CONFIG", "OVERRIDE KEY=VALUE ...".
std::string head_of(const Argument& argument);

/// All that is said of an argument, in words.
std::string words_of(const Argument& argument);

/// What `--help` prints, of the program or of one command. Lines have at most 100 letters, but for words that have
/// more.
std::string help_text(const Usage& usage);
std::string help_text(const Command& command);

}  // namespace palpate::cli
