// SPDX-License-Identifier: MIT
#include "cli/completion.hpp"

#include "cli/key_completion.hpp"
#include "config/trouble.hpp"
#include "reading/reading.hpp"
#include "record/fields.hpp"
#include "record/run_directory.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <sstream>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

bool starts_with(const std::string& word, const std::string& with) { return word.compare(0, with.size(), with) == 0; }

/// What is typed so far: what stands behind the command by its place, and whose value comes next.
struct Typed {
  const Command* command = nullptr;
  std::map<std::string, std::vector<std::string>> given;  ///< by the name of the argument
  const Argument* next = nullptr;                         ///< whose value is being typed, or none
  std::string word;                                       ///< as far as it is typed
  std::string kept;                                       ///< of the word before the value: "--launcher="

  /// The value of what stands by its place, "" if it was not given.
  std::string at(const std::string& name) const {
    const auto found = given.find(name);
    return found == given.end() ? "" : found->second.front();
  }
};

const Argument* option(const Command& command, const std::string& name) {
  for (const Argument& one : command.arguments) {
    if (!one.by_place && std::find(one.names.begin(), one.names.end(), name) != one.names.end()) return &one;
  }
  return nullptr;
}

/// The argument at a place, counted from 0; the last one again where it may be repeated.
const Argument* at_place(const Command& command, std::size_t place) {
  const Argument* last = nullptr;
  for (const Argument& one : command.arguments) {
    if (!one.by_place) continue;
    last = &one;
    if (place-- == 0) return last;
  }
  return last != nullptr && last->repeated ? last : nullptr;
}

Typed read(const Command& command, const std::vector<std::string>& words) {
  Typed out;
  out.command = &command;
  std::size_t place = 0;
  for (std::size_t i = 1; i < words.size(); ++i) {
    const bool last = i + 1 == words.size();
    const std::string& word = words[i];
    out.word = word;
    if (out.next != nullptr) {  // the value of an option
      if (!last) out.next = nullptr;
    } else if (starts_with(word, "-")) {
      const auto equals = word.find('=');
      const Argument* one = option(command, word.substr(0, equals));
      if (one == nullptr || one->value.empty()) continue;
      if (equals == std::string::npos) {
        if (!last) out.next = one;
      } else if (last) {
        out.next = one;
        out.kept = word.substr(0, equals + 1);
        out.word = word.substr(equals + 1);
      }
    } else if (const Argument* one = at_place(command, place++); one != nullptr) {
      if (last) {
        out.next = one;
      } else {
        out.given[one->names.front()].push_back(word);
      }
    }
  }
  return out;
}

std::vector<Completion> options_of(const Command& command) {
  std::vector<Completion> out;
  for (const Argument& one : command.arguments) {
    if (!one.by_place) out.push_back({one.names.back(), words_of(one)});
  }
  return out;
}

/// The folder in which `typed` goes on, as typed and as it is.
struct Place {
  std::string typed;
  fs::path folder;
  bool hidden = false;  ///< whether what begins with a dot is asked for
};

Place place_of(const std::string& typed) {
  Place out;
  out.typed = typed.substr(0, typed.rfind('/') + 1);
  out.folder = out.typed.empty() ? fs::path(".") : fs::path(out.typed);
  if (const char* home = std::getenv("HOME"); home != nullptr && starts_with(out.typed, "~/")) {
    out.folder = fs::path(home) / out.typed.substr(2);
  }
  out.hidden = typed.compare(out.typed.size(), 1, ".") == 0;
  return out;
}

/// Folders, and the files that `take` has a meaning for.
template <class Take>
std::vector<Completion> files(const std::string& typed, const Take& take) {
  std::vector<Completion> out;
  const Place place = place_of(typed);
  std::error_code none;
  for (const fs::path& path : list_folder(place.folder)) {
    const std::string name = path.filename().string();
    if (name.front() == '.' && !place.hidden) continue;
    const std::string word = place.typed + name;
    if (!starts_with(word, typed)) continue;
    if (fs::is_directory(path, none)) {
      out.push_back({word + "/", ""});
    } else if (const std::optional<std::string> meaning = take(path)) {
      out.push_back({word, *meaning});
    }
  }
  std::sort(out.begin(), out.end(), [](const Completion& a, const Completion& b) { return a.word < b.word; });
  return out;
}

std::optional<std::string> as_config(const fs::path& file) {
  const std::string type = file.extension().string();
  if (type != ".yaml" && type != ".yml") return std::nullopt;
  return purpose_of(file);
}

std::optional<std::string> as_any(const fs::path&) { return ""; }
std::optional<std::string> as_none(const fs::path&) { return std::nullopt; }

enum class Records { runs, sweeps, both };

/// What lies in a folder, if it is asked for: a word on it; "" if it is none.
std::string record_at(const fs::path& folder, Records asked) {
  std::error_code none;
  bool ended = false;
  if (is_sweep(folder.string())) return asked == Records::runs ? "" : "a sweep";
  if (asked == Records::sweeps || !fs::exists(folder / "config.yaml", none)) return "";
  trouble_in([&] { ended = read_ending(folder).end.has_value(); });  // of one that cannot be read no end is known
  return ended ? "a run, ended" : "a run, not ended";
}

/// Runs and sweeps below runs/, where they are made; where none is meant, folder by folder.
std::vector<Completion> records(const std::string& typed, Records asked) {
  std::vector<Completion> out;
  for (const fs::path& name : list_folder("runs")) {
    for (const fs::path& id : list_folder(name)) {
      const std::string word = id.string();
      if (!starts_with(word, typed)) continue;
      if (std::string meaning = record_at(id, asked); !meaning.empty()) out.push_back({word, std::move(meaning)});
    }
  }
  if (!out.empty()) {
    std::sort(out.begin(), out.end(), [](const Completion& a, const Completion& b) { return a.word < b.word; });
    return out;
  }
  for (Completion& one : files(typed, as_none)) {
    if (std::string meaning = record_at(one.word, asked); !meaning.empty()) {
      one.word.pop_back();
      one.meaning = std::move(meaning);
    }
    out.push_back(std::move(one));
  }
  return out;
}

std::vector<Completion> summary_columns(const std::string& behind = "") {
  std::vector<Completion> out;
  for (const RecordField& field : summary_fields()) out.push_back({field.name + behind, field.meaning});
  return out;
}

/// The columns of results.csv between those that name the job and those of its summary.
std::vector<Completion> swept_keys(const fs::path& sweep) {
  std::vector<Completion> out;
  std::istringstream in(read_bounded(sweep / "results.csv", kMostLogBytes, Origin::record).text);
  std::string header;
  std::getline(in, header);
  std::istringstream names(header);
  for (std::string name; std::getline(names, name, ',');) {
    if (name == "job" || name == "id") continue;
    if (find_summary_field(name) != nullptr) break;  // what was swept comes first
    out.push_back({name, "key that the sweep varies"});
  }
  return out;
}

std::vector<Completion> kinds() {
  std::vector<Completion> out;
  for (const std::string& one : PluginHost::kinds()) out.push_back({one, ""});
  return out;
}

/// KIND, then KIND/NAME.
std::vector<Completion> plugins_of(const Program& program, const std::string& typed) {
  std::vector<Completion> out;
  const std::string kind = typed.substr(0, typed.find('/'));
  for (const std::string& one : PluginHost::kinds()) {
    if (typed.find('/') == std::string::npos) {
      out.push_back({one, ""});
      out.push_back({one + "/", ""});
    } else if (one == kind) {
      for (Completion& name : plugin_names(program, kind)) out.push_back({kind + "/" + name.word, name.meaning});
    }
  }
  return out;
}

/// Completions of what stands behind the last comma, as whole words.
std::vector<Completion> behind_comma(const std::string& typed, std::size_t from, std::vector<Completion> values) {
  const auto comma = typed.rfind(',');
  if (comma == std::string::npos || comma < from) return values;
  for (Completion& one : values) one.word.replace(0, from, typed.substr(0, comma + 1));
  return values;
}

/// A sweep's KEY=VALUES: as KEY=VALUE, one behind the other.
std::vector<Completion> axis(Program& program, const std::string& config, const std::string& typed) {
  const auto equals = typed.find('=');
  if (equals == std::string::npos) return complete_key(program, config, {}, typed);
  const std::size_t bracket = typed.compare(equals + 1, 1, "[") == 0 ? 1 : 0;
  std::vector<Completion> out = complete_key(program, config, {}, typed.substr(0, equals + 1));
  for (Completion& one : out) one.word.insert(equals + 1, bracket, '[');
  return behind_comma(typed, equals + 1 + bracket, std::move(out));
}

/// By the word that help has for a value; nothing for what only the user knows.
std::vector<Completion> values_of(const Typed& typed, Program& program) {
  const Argument& argument = *typed.next;
  std::vector<Completion> out;
  for (const std::string& one : argument.choices) out.push_back({one, ""});
  if (!out.empty()) return out;
  const std::string& of = argument.value;
  const std::string& word = typed.word;
  if (of == "CONFIG") return files(word, as_config);
  if (of == "FILE") return files(word, as_any);
  if (of == "FOLDER") return files(word, as_none);
  if (of == "RUN") return records(word, Records::runs);
  if (of == "SWEEP") return records(word, Records::sweeps);
  if (of == "DIR") return records(word, Records::both);
  if (of == "KIND") return kinds();
  if (of == "KIND[/NAME]") return plugins_of(program, word);
  if (of == "COLUMN") return summary_columns();
  if (of == "COLUMN=VALUE") return summary_columns("=");
  if (of == "COLUMNS") return behind_comma(word, 0, summary_columns());
  if (of == "KEYS") return behind_comma(word, 0, swept_keys(typed.at("DIR")));
  if (of == "KEY=VALUES") return axis(program, typed.at("CONFIG"), word);
  if (of != "KEY=VALUE") return {};
  const auto before = typed.given.find(argument.names.front());
  return complete_key(program, typed.at("CONFIG"),
                      before == typed.given.end() ? std::vector<std::string>{} : before->second, word);
}

/// Bash takes a word apart at each '=' and ':', which come as words of their own; and leaves quotes where they are.
std::vector<std::string> joined(const std::vector<std::string>& pieces) {
  std::vector<std::string> out;
  bool open = false;
  for (const std::string& piece : pieces) {
    const bool breaks = piece == "=" || piece == ":";
    if (!out.empty() && !piece.empty() && (breaks || open)) {
      out.back() += piece;
    } else {
      out.push_back(piece);
    }
    open = breaks;
  }
  for (std::string& word : out) word.erase(0, word.find_first_not_of("\"'"));
  return out;
}

}  // namespace

std::vector<Completion> completions(const Usage& usage, Program& program, const std::vector<std::string>& words) {
  std::vector<Completion> out;
  Typed typed;
  const std::string& last = words.back();
  if (words.size() == 1) {
    typed.word = last;
    for (const Command& one : usage.commands) out.push_back({one.name, one.summary});
    for (Completion& one : options_of(usage.program)) out.push_back(std::move(one));
  } else {
    for (const Command& one : usage.commands) {
      if (one.name == words.front()) typed = read(one, words);
    }
    if (typed.command == nullptr) return {};
    if (typed.next != nullptr) {
      out = values_of(typed, program);
    } else if (starts_with(last, "-")) {
      out = options_of(*typed.command);
    }
  }
  const auto differs = [&](const Completion& one) { return !starts_with(one.word, typed.word); };
  out.erase(std::remove_if(out.begin(), out.end(), differs), out.end());
  for (Completion& one : out) one.word = typed.kept + one.word;
  return out;
}

std::string completion_lines(const std::string& shell, const Usage& usage, Program& program,
                             std::vector<std::string> words) {
  std::size_t cut = 0;  // of each answer, what bash takes for a word before
  const bool bash = shell == "bash";
  if (bash) {
    const bool quoted = !words.empty() && words.back().find_first_of("\"'") == 0;
    words = joined(words);
    if (!quoted && !words.empty()) cut = words.back().find_last_of("=:") + 1;
  }
  if (words.empty()) words.emplace_back();
  std::string out;
  for (const Completion& one : completions(usage, program, words)) {
    out += bash ? one.word.substr(cut) : fmt::format("{}\t{}", one.word, one.meaning);
    out += '\n';
  }
  return out;
}

}  // namespace palpate::cli
