// SPDX-License-Identifier: MIT
#include "cli/completion.hpp"

#include "cli/key_completion.hpp"
#include "cli/usage.hpp"
#include "config/catch_error.hpp"
#include "reading/read_file.hpp"
#include "record/fields.hpp"
#include "record/run_directory.hpp"

#include <CLI/CLI.hpp>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;
using boost::starts_with;

/// Returns the argument of `command` to which the word `last` belongs; null if there is none. `previous` is the word
/// before `last`. `command` must have parsed all words before `last`.
const CLI::Option* argument_of(const CLI::App& command, const std::string& previous, const std::string& last) {
  const auto with_value = [&](const std::string& word) {
    const CLI::Option* option = starts_with(word, "-") ? command.get_option_no_throw(word) : nullptr;
    return option == nullptr || value_of(*option).empty() ? nullptr : option;
  };
  if (const CLI::Option* option = with_value(previous)) return option;
  if (starts_with(last, "-")) {
    const auto equals = last.find('=');
    return equals == std::string::npos ? nullptr : with_value(last.substr(0, equals));
  }
  for (const CLI::Option* one : command.get_options()) {
    if (one->get_positional() && static_cast<int>(one->count()) < one->get_items_expected_max()) return one;
  }
  return nullptr;
}

std::vector<Completion> options_of(const CLI::App& command) {
  std::vector<Completion> out;
  for (const CLI::Option* one : arguments_of(command)) {
    if (!one->get_positional()) out.push_back({one->get_name(), meaning_of(*one)});
  }
  return out;
}

/// Returns the folders and YAML files that complete `typed`.
std::vector<Completion> configs(const std::string& typed) {
  const std::string folder = typed.substr(0, typed.rfind('/') + 1);
  std::vector<Completion> out;
  std::error_code none;
  for (const fs::path& path : list_folder(folder.empty() ? "." : folder)) {
    const std::string name = path.filename().string();
    const std::string type = path.extension().string();
    if (name.front() == '.') continue;
    if (fs::is_directory(path, none)) {
      out.push_back({folder + name + "/", ""});
    } else if (type == ".yaml" || type == ".yml") {
      out.push_back({folder + name, purpose_of(path)});
    }
  }
  return out;
}

/// Returns the runs in runs/, the sweeps in runs/, or (if `of` is DIR) runs and sweeps.
std::vector<Completion> records(const std::string& of) {
  std::vector<Completion> out;
  std::error_code none;
  for (const fs::path& name : list_folder("runs")) {
    for (const fs::path& id : list_folder(name)) {
      if (is_sweep(id)) {
        if (of != "RUN") out.push_back({id.string(), "a sweep"});
      } else if (of != "SWEEP" && fs::exists(id / "config.yaml", none)) {
        bool ended = false;
        catch_error([&] { ended = read_ending(id).end.has_value(); });  // A damaged record counts as not ended.
        out.push_back({id.string(), ended ? "a run, ended" : "a run, not ended"});
      }
    }
  }
  return out;
}

/// Returns the plugin kinds. If `names` is set, also returns each plugin as KIND/NAME.
std::vector<Completion> plugins_by_kind(const CommandEnvironment& program, bool names) {
  std::vector<Completion> out;
  for (const std::string& kind : PluginHost::kinds()) {
    out.push_back({kind, ""});
    if (!names) continue;
    for (const Completion& one : plugin_names(program, kind)) out.push_back({kind + "/" + one.word, one.meaning});
  }
  return out;
}

/// Returns completions for the last of the comma-separated values in `typed`; the first value begins at index `from`.
/// `values`: completions of a word with a single value at index `from`. In the results, the first `from` characters are
/// replaced by the text of `typed` up to its last comma.
std::vector<Completion> after_comma(const std::string& typed, std::size_t from, std::vector<Completion> values) {
  const auto comma = typed.rfind(',');
  if (comma == std::string::npos || comma < from) return values;
  for (Completion& one : values) one.word.replace(0, from, typed.substr(0, comma + 1));
  return values;
}

/// Completes KEY=VALUES of a sweep. Each value is completed like the value in KEY=VALUE.
std::vector<Completion> axis(CommandEnvironment& program, const std::string& config, const std::string& typed) {
  const auto equals = typed.find('=');
  if (equals == std::string::npos) return complete_key(program, config, {}, typed);
  const std::size_t bracket = typed.compare(equals + 1, 1, "[") == 0 ? 1 : 0;
  std::vector<Completion> out = complete_key(program, config, {}, typed.substr(0, equals + 1));
  for (Completion& one : out) one.word.insert(equals + 1, bracket, '[');
  return after_comma(typed, equals + 1 + bracket, std::move(out));
}

/// Returns the completions for the value of an option, according to the name of the value in the help, such as CONFIG
/// or RUN. Other files and free texts have no completions.
std::vector<Completion> values_of(const CLI::App& command, const CLI::Option& option, const std::string& typed,
                                  CommandEnvironment& program) {
  std::vector<Completion> out;
  for (const std::string& one : choices_of(option)) out.push_back({one, ""});
  if (!out.empty()) return out;
  const std::string of = value_of(option);
  if (of == "CONFIG") return configs(typed);
  if (of == "RUN" || of == "SWEEP" || of == "DIR") return records(of);
  if (of == "KIND" || of == "KIND[/NAME]") return plugins_by_kind(program, of != "KIND");
  if (of == "COLUMN" || of == "COLUMNS" || of == "COLUMN=VALUE") {
    for (const RecordField& field : summary_fields())
      out.push_back({field.name + (of == "COLUMN=VALUE" ? "=" : ""), field.meaning});
    return of == "COLUMNS" ? after_comma(typed, 0, std::move(out)) : out;
  }
  if (of != "KEY=VALUE" && of != "KEY=VALUES") return {};
  const std::vector<std::string> config = command.get_option("CONFIG")->results();
  if (config.empty()) return {};
  return of == "KEY=VALUE" ? complete_key(program, config.front(), option.results(), typed)
                           : axis(program, config.front(), typed);
}

}  // namespace

std::vector<Completion> completions(CLI::App& app, CommandEnvironment& program, const std::vector<std::string>& words) {
  std::vector<Completion> out;
  std::string typed = words.back();
  std::string kept;  // prefix of the last word that is not completed, for example "--launcher="
  if (words.size() == 1) {
    for (const CLI::App* one : app.get_subcommands({})) out.push_back({one->get_name(), one->get_description()});
    for (Completion& one : options_of(app)) out.push_back(std::move(one));
  } else {
    try {
      app.parse(std::vector<std::string>(words.rbegin() + 1, words.rend()));
    } catch (const CLI::Error&) {  // The words typed so far may be incomplete.
    }
    if (app.get_subcommands().empty()) return {};
    const CLI::App& command = *app.get_subcommands().front();
    if (const CLI::Option* option = argument_of(command, words[words.size() - 2], typed)) {
      if (starts_with(typed, "-")) {
        kept = typed.substr(0, typed.find('=') + 1);
        typed.erase(0, kept.size());
      }
      out = values_of(command, *option, typed, program);
    } else if (starts_with(typed, "-")) {
      out = options_of(command);
    }
  }
  const auto differs = [&](const Completion& one) { return !starts_with(one.word, typed); };
  out.erase(std::remove_if(out.begin(), out.end(), differs), out.end());
  for (Completion& one : out) one.word = kept + one.word;
  return out;
}

}  // namespace palpate::cli
