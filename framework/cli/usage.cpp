// SPDX-License-Identifier: MIT
#include "cli/usage.hpp"

#include "config/text_layout.hpp"
#include "record/build_info.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/replace.hpp>

#include <algorithm>
#include <fstream>
#include <stdexcept>

namespace palpate::cli {
namespace {

constexpr std::size_t kWidth = 100;
constexpr std::size_t kColumn = 28;  ///< column in which descriptions begin

std::string full_name(const CLI::App& app) {
  return app.get_parent() == nullptr ? "palpate" : "palpate " + app.get_name();
}

std::string synopsis(const CLI::App& app) {
  if (app.get_parent() == nullptr) return "palpate COMMAND ...";
  std::string out = full_name(app) + " [--OPTION ...]";
  for (const CLI::Option* one : arguments_of(app)) {
    const std::string name = one->get_name() + (one->get_items_expected_max() > 1 ? "..." : "");
    if (one->get_positional()) {
      out += one->get_required() ? " " + name : " [" + name + "]";
    } else if (one->get_required()) {
      out += fmt::format(" {} {}", one->get_name(), value_of(*one));
    }
  }
  return out;
}

/// Returns a text such as "--launcher NAME", "CONFIG" or "OVERRIDE KEY=VALUE ...".
std::string head_of(const CLI::Option& option) {
  const std::string value = value_of(option);
  if (option.get_positional()) {
    // The name of a positional argument is usually the name of its value. If the value has a form such as KEY=VALUE,
    // the text contains the name and the form.
    if (value.find_first_of("=/") == std::string::npos) return option.get_name();
    return fmt::format("{} {}{}", option.get_name(), value, option.get_items_expected_max() > 1 ? " ..." : "");
  }
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return fmt::format("{}{}{}", fmt::join(names, ", "), value.empty() ? "" : " ", value);
}

/// Returns a text with the accepted values of an option, for example "1 to 1024" or "{local,slurm}". CLI11 appends this
/// text to the name of the value.
std::string accepted_by(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto colon = type.find(':');
  return colon == std::string::npos ? "" : type.substr(colon + 1);
}

struct Section {
  std::string heading;
  std::vector<std::pair<std::string, std::string>> entries;  ///< terms with their descriptions
};

std::vector<Section> sections_of(const CLI::App& app) {
  std::vector<Section> out;
  const auto add = [&](const std::string& heading, const std::string& term, const std::string& meaning) {
    if (out.empty() || out.back().heading != heading) out.push_back({heading, {}});
    out.back().entries.emplace_back(term, meaning);
  };
  for (const CLI::App* command : app.get_subcommands({}))
    add("Commands", command->get_name(), command->get_description());
  for (const CLI::Option* one : arguments_of(app))
    add(one->get_positional() ? "Arguments" : one->get_group(), head_of(*one), meaning_of(*one));
  return out;
}

/// Formats a term with its description. The description is to the right of the term, or below it if the term is long.
std::string entry(const std::string& term, const std::string& meaning) {
  std::string out = "  " + term;
  if (out.size() + 2 > kColumn) out += "\n" + std::string(kColumn, ' ');
  out.resize(std::max(out.size(), kColumn), ' ');
  return out + fmt::format("{}\n", fmt::join(wrapped(meaning, kWidth - kColumn), "\n" + std::string(kColumn, ' ')));
}

/// Escapes a text for roff. In the escaped text, hyphens remain plain hyphens, which users can search and copy, and
/// roff interprets no line as a request.
std::string roff(std::string text) {
  boost::replace_all(text, "\\", "\\e");
  boost::replace_all(text, "-", "\\-");
  boost::replace_all(text, "\n", "\n\\&");
  return "\\&" + text;
}

/// The part of the manual that all pages share. The exit statuses must agree with program.hpp.
constexpr const char* kCommon =
    ".SH EXIT STATUS\n"
    ".TP\n.B 0\nsuccess\n"
    ".TP\n.B 1\nfailure of the run, or of an expectation in its config\n"
    ".TP\n.B 2\ninvalid usage or config: one line on stderr names the place, the reason and the remedy\n"
    ".TP\n.B 75\ntemporary failure: another process holds the run or its arm, or the external program has changed\n"
    ".TP\n.B 130\ninterrupted\n"
    ".SH ENVIRONMENT\n"
    ".TP\n.B PALPATE_PLUGIN_PATH\nfolders with additional plugins, separated by colons\n";

std::string manual_page(const CLI::App& app, const std::string& name) {
  const bool whole = app.get_parent() == nullptr;
  std::string out = fmt::format(".\\\" SPDX-License-Identifier: MIT\n.TH {} 1 \"\" \"palpate {}\" \"palpate\"\n",
                                roff(boost::to_upper_copy(name)), kVersion);
  out += fmt::format(".SH NAME\n{} \\- {}\n.SH SYNOPSIS\n.B {}\n", roff(name),
                     whole ? "experiments in active touch" : roff(app.get_description()), roff(synopsis(app)));
  if (whole) out += fmt::format(".SH DESCRIPTION\n{}\n", roff(app.get_description()));
  for (const Section& section : sections_of(app)) {
    out += fmt::format(".SH {}\n", roff(boost::to_upper_copy(section.heading)));
    for (const auto& [term, meaning] : section.entries)
      out += fmt::format(".TP\n.B {}\n{}\n", roff(term), roff(meaning));
  }
  out += fmt::format(".SH EXAMPLES\n.EX\n{}\n.EE\n", roff(app.get_footer()));
  std::vector<std::string> others;
  for (const CLI::App* one : app.get_subcommands({})) others.push_back("palpate\\-" + one->get_name() + " (1)");
  if (others.empty()) others.emplace_back("palpate (1)");
  return out + kCommon + fmt::format(".SH SEE ALSO\n.BR {}\n", fmt::join(others, ",\n.BR "));
}

void write_page(const CLI::App& app, const std::filesystem::path& folder) {
  const std::string name = boost::replace_all_copy(full_name(app), " ", "-");
  const std::filesystem::path file = folder / (name + ".1");
  std::ofstream out(file, std::ios::binary);
  out << manual_page(app, name);
  if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
}

}  // namespace

std::vector<const CLI::Option*> arguments_of(const CLI::App& command) {
  std::vector<const CLI::Option*> out = command.get_options();
  const auto rank = [](const CLI::Option* one) {
    return one->get_positional() ? 0 : one->get_group() == "Options" ? 1 : 2;
  };
  std::stable_sort(out.begin(), out.end(), [&](const auto* a, const auto* b) { return rank(a) < rank(b); });
  return out;
}

std::string value_of(const CLI::Option& option) {
  if (option.get_type_size() == 0) return "";
  const std::string type = option.get_type_name();
  return type.substr(0, type.find(':'));
}

std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string accepted = accepted_by(option);
  if (accepted.empty() || accepted.front() != '{') return {};
  return CLI::detail::split(accepted.substr(1, accepted.size() - 2), ',');
}

std::string meaning_of(const CLI::Option& option) {
  std::vector<std::string> notes;
  const auto note = [&](const char* before, const std::string& text) {
    if (!text.empty()) notes.push_back(before + text);
  };
  const auto names = [](const auto& options, const char* between) {
    std::vector<std::string> out;
    for (const CLI::Option* one : options) out.push_back(one->get_name());
    return fmt::format("{}", fmt::join(out, between));
  };
  const std::vector<std::string> choices = choices_of(option);
  if (!option.get_positional() && option.get_required()) notes.emplace_back("required");
  note("", choices.empty() ? accepted_by(option) : fmt::format("{}", fmt::join(choices, " or ")));
  note("default: ", option.get_default_str());
  if (!option.get_positional() && option.get_items_expected_max() > 1) notes.emplace_back("can be repeated");
  note("only with ", names(option.get_needs(), " and "));
  note("not with ", names(option.get_excludes(), " or "));
  if (notes.empty()) return option.get_description();
  return fmt::format("{} ({})", option.get_description(), fmt::join(notes, "; "));
}

std::string help_text(const CLI::App& app) {
  std::string out = fmt::format("{}\n\nUsage: {}\n", app.get_description(), synopsis(app));
  for (const Section& section : sections_of(app)) {
    out += fmt::format("\n{}:\n", section.heading);
    for (const auto& [term, meaning] : section.entries) out += entry(term, meaning);
  }
  out += fmt::format("\nExamples:\n  {}\n", boost::replace_all_copy(app.get_footer(), "\n", "\n  "));
  if (app.get_parent() != nullptr) return out;
  return out + "\n'palpate COMMAND --help' shows the arguments and options of a command.\n";
}

void write_manual(const CLI::App& app, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_page(app, folder);
  for (const CLI::App* command : app.get_subcommands({})) write_page(*command, folder);
}

}  // namespace palpate::cli
