// SPDX-License-Identifier: MIT
#include "cli/usage.hpp"

#include "config/layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

namespace palpate::cli {
namespace {

constexpr std::size_t kWidth = 100;
constexpr std::size_t kColumn = 28;  ///< where meanings begin

/// A term and its meaning beside it, or below where the term is too long.
std::string entry(const std::string& term, const std::string& meaning) {
  std::string out = "  " + term;
  if (out.size() + 2 > kColumn) out += "\n" + std::string(kColumn, ' ');
  out.resize(std::max(out.size(), kColumn), ' ');
  return out + fmt::format("{}\n", fmt::join(wrapped(meaning, kWidth - kColumn), "\n" + std::string(kColumn, ' ')));
}

std::string examples_text(const Command& command) {
  std::string out = "\nExamples:\n";
  for (const std::string& example : command.examples) out += "  " + example + "\n";
  return out;
}

std::string arguments_text(const Command& command) {
  std::string out;
  std::string heading;
  for (const Argument& one : command.arguments) {
    if (one.heading != heading) out += fmt::format("\n{}:\n", heading = one.heading);
    out += entry(head_of(one), words_of(one));
  }
  return out;
}

}  // namespace

std::string synopsis(const Command& command) {
  if (command.name.empty()) return "palpate COMMAND ...";
  std::string out = "palpate " + command.name + " [--OPTION ...]";
  for (const Argument& one : command.arguments) {
    if (!one.by_place) {
      if (one.required) out += fmt::format(" {} {}", one.names.front(), one.value);
      continue;
    }
    const std::string name = one.names.front() + (one.repeated ? "..." : "");
    out += one.required ? " " + name : " [" + name + "]";
  }
  return out;
}

std::string head_of(const Argument& argument) {
  std::string out = fmt::format("{}", fmt::join(argument.names, ", "));
  // By its place it is called after what it is, but for one that has a form.
  const bool has_form = argument.value.find_first_of("=/") != std::string::npos;
  if (!argument.value.empty() && (!argument.by_place || has_form)) out += " " + argument.value;
  return argument.by_place && argument.repeated && has_form ? out + " ..." : out;
}

std::string words_of(const Argument& argument) {
  std::vector<std::string> notes;
  if (!argument.by_place && argument.required) notes.emplace_back("required");
  if (!argument.choices.empty()) notes.push_back(fmt::format("{}", fmt::join(argument.choices, " or ")));
  if (!argument.limits.empty()) notes.push_back(argument.limits);
  if (!argument.default_value.empty()) notes.push_back("default: " + argument.default_value);
  if (!argument.by_place && argument.repeated) notes.emplace_back("can be repeated");
  if (!argument.only_with.empty()) notes.push_back(fmt::format("only with {}", fmt::join(argument.only_with, " and ")));
  if (!argument.never_with.empty()) notes.push_back(fmt::format("not with {}", fmt::join(argument.never_with, " or ")));
  if (notes.empty()) return argument.meaning;
  return fmt::format("{} ({})", argument.meaning, fmt::join(notes, "; "));
}

std::string help_text(const Usage& usage) {
  std::string out = fmt::format("{}\n\nUsage: {}\n\nCommands:\n", usage.program.summary, synopsis(usage.program));
  for (const Command& command : usage.commands) out += entry(command.name, command.summary);
  return out + arguments_text(usage.program) + examples_text(usage.program) +
         "\n'palpate COMMAND --help' shows the arguments and options of a command.\n";
}

std::string help_text(const Command& command) {
  return fmt::format("{}\n\nUsage: {}\n", command.summary, synopsis(command)) + arguments_text(command) +
         examples_text(command);
}

}  // namespace palpate::cli
