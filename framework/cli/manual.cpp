// SPDX-License-Identifier: MIT
#include "cli/manual.hpp"

#include "record/build_info.hpp"

#include <fmt/format.h>
#include <boost/algorithm/string/case_conv.hpp>

#include <algorithm>
#include <fstream>
#include <stdexcept>

namespace palpate::cli {
namespace {

/// A text as roff prints it: a hyphen of ours is one that can be searched for and pasted, and no line is a request.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) {
      out += std::string("\\&") + c;
    } else {
      out += c;
    }
  }
  return out;
}

std::string title(const std::string& name, const std::string& summary) {
  return fmt::format(".TH {} 1 \"\" \"palpate {}\" \"palpate\"\n.SH NAME\n{} \\- {}\n",
                     roff(boost::to_upper_copy(name)), kVersion, roff(name), roff(summary));
}

std::string arguments_part(const Command& command) {
  std::string out;
  std::string heading;
  for (const Argument& one : command.arguments) {
    if (one.heading != heading) out += fmt::format(".SH {}\n", roff(boost::to_upper_copy(heading = one.heading)));
    out += fmt::format(".TP\n.B {}\n{}\n", roff(head_of(one)), roff(words_of(one)));
  }
  return out;
}

std::string examples_part(const Command& command) {
  std::string out = ".SH EXAMPLES\n.EX\n";
  for (const std::string& example : command.examples) out += roff(example) + "\n";
  return out + ".EE\n";
}

/// What holds for all commands: the exit statuses are those of commands.hpp.
constexpr const char* kCommon =
    ".SH EXIT STATUS\n"
    ".TP\n.B 0\nsuccess\n"
    ".TP\n.B 1\nfailure of the run, or of an expectation in its config\n"
    ".TP\n.B 2\ninvalid usage or config: one line on stderr names the place, the reason and the remedy\n"
    ".TP\n.B 75\ntemporary failure: another process holds the run or its arm, or the external program has changed\n"
    ".TP\n.B 130\ninterrupted\n"
    ".SH ENVIRONMENT\n"
    ".TP\n.B PALPATE_PLUGIN_PATH\nfolders with additional plugins, separated by colons\n";

std::string program_page(const Usage& usage) {
  std::string out = title("palpate", "experiments in active touch");
  out += fmt::format(".SH SYNOPSIS\n.B {}\n.SH DESCRIPTION\n{}\n.SH COMMANDS\n", roff(synopsis(usage.program)),
                     roff(usage.program.summary));
  for (const Command& command : usage.commands) {
    out += fmt::format(".TP\n.BR palpate\\-{} (1)\n{}\n", roff(command.name), roff(command.summary));
  }
  return out + arguments_part(usage.program) + examples_part(usage.program) + kCommon;
}

std::string command_page(const Command& command) {
  return title("palpate-" + command.name, command.summary) +
         fmt::format(".SH SYNOPSIS\n.B {}\n", roff(synopsis(command))) + arguments_part(command) +
         examples_part(command) + kCommon + ".SH SEE ALSO\n.BR palpate (1)\n";
}

void write_page(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << ".\\\" SPDX-License-Identifier: MIT\n" << text;
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace

void write_manual(const Usage& usage, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_page(folder / "palpate.1", program_page(usage));
  for (const Command& command : usage.commands) {
    write_page(folder / ("palpate-" + command.name + ".1"), command_page(command));
  }
}

}  // namespace palpate::cli
