// SPDX-License-Identifier: MIT
#include "cli/key_completion.hpp"

#include "config/catch_error.hpp"
#include "config/describe.hpp"
#include "experiment/experiment_options.hpp"
#include "reading/read_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>

namespace palpate::cli {
namespace {

using Type = FieldDescription::Type;
using Descriptions = std::vector<FieldDescription>;

/// Returns the config with the overrides that were typed so far. If an override is invalid (such as a list of groups in
/// a sweep), all overrides are left out. For an invalid config, returns an empty tree.
Tree config_so_far(Composer& composer, const std::string& config, const std::vector<std::string>& before) {
  Tree out = Tree::map();
  std::vector<Override> overrides;
  const auto trouble = catch_error([&] {
    for (const std::string& text : before) overrides.push_back(parse_override(text));
    out = composer.compose(config, overrides);
  });
  if (trouble) catch_error([&] { out = composer.compose(config, {}); });
  return out;
}

/// The keys that a config can have, level by level, and their values.
class Keys {
 public:
  Keys(const PluginHost& host, const Tree& config) : host_(host), config_(config) {}

  Descriptions top() const {
    ExperimentOptions options;
    Descriptions out = beside(describe_fields([&](Fields& fields) { options.list(fields); }), "");
    for (const Field& field : keys_beside_options()) {
      if (field.is_group) out.push_back(describe_key(field));
    }
    for (const FieldDescription& field : Descriptions(out)) {
      if (!field.beside.empty()) out.push_back(describe_beside(field));
    }
    return out;
  }

  /// Returns the fields below the field at `path`.
  Descriptions within(const FieldDescription& field, const std::string& path) const {
    if (field.type == Type::section && !field.kind.empty()) return of_option(field, path);
    if (field.type == Type::section) return beside(field.fields, path + ".");
    if (field.type == Type::plugin && !field.adopted) return of_plugin(field, path);
    const Tree* list = config_.find_path(path);
    Descriptions out;
    for (std::size_t i = 0; list != nullptr && i < list->items.size(); ++i) {
      FieldDescription item;
      item.name = std::to_string(i);
      item.meaning = fmt::format("number {} of {}, from 0", i, list->items.size());
      item.type = field.type == Type::plugins ? Type::plugin : Type::section;
      item.kind = field.kind;
      item.fields = field.fields;
      out.push_back(std::move(item));
    }
    return out;
  }

  /// Returns the value in the config, or the default value if the config has none. Returns "" for a value that is not a
  /// single word.
  std::string value(const FieldDescription& field, const std::string& path) const {
    const Tree* own = config_.find_path(path);
    if (own != nullptr) return own->is_scalar() ? own->text : "";
    return field.default_value;
  }

 private:
  std::string chosen_plugin(const FieldDescription& field, const std::string& path) const {
    const Tree* own = config_.find_path(path);
    if (own == nullptr && !field.heir_of.empty()) own = config_.find_path(field.heir_of);
    if (own != nullptr && own->is_map()) own = own->find("type");
    return own != nullptr && own->is_scalar() ? own->text : field.default_value;
  }

  Descriptions options_of(const std::string& kind, const std::string& name) const {
    Descriptions out;
    catch_error([&] { out = describe_fields([&](Fields& fields) { host_.describe(kind, name, fields); }); });
    return out;
  }

  /// Returns the fields of a plugin option whose key is not in the plugin's block but next to the plugin's key
  /// (Field::with_beside()).
  Descriptions of_option(const FieldDescription& option, const std::string& path) const {
    FieldDescription plugin;
    for (const FieldDescription& one : options_of(option.kind, chosen_plugin(plugin, option.kind))) {
      if (one.name == option.name) return beside(one.fields, path + ".");
    }
    return {};
  }

  Descriptions of_plugin(const FieldDescription& field, const std::string& path) const {
    FieldDescription type;
    type.name = "type";
    type.kind = field.kind;
    type.type = Type::plugin;
    type.adopted = true;
    type.meaning = fmt::format("the plugin, of kind {}", field.kind);
    type.default_value = chosen_plugin(field, path);
    Descriptions out{std::move(type)};
    for (FieldDescription& one : beside(options_of(field.kind, out.front().default_value), path + ".")) {
      if (one.name != field.beside) out.push_back(std::move(one));
    }
    return out;
  }

  /// Returns `fields` and the fields that depend on their values, such as the options of a chosen plugin.
  Descriptions beside(const Descriptions& fields, const std::string& prefix) const {
    Descriptions out = fields;
    for (const FieldDescription& field : fields) {
      const std::string chosen = value(field, prefix + field.name);
      Descriptions more;
      if (field.adopted) more = options_of(field.kind, chosen);
      for (const auto& one : field.cases) {
        if (one.name == chosen) more = beside(one.fields, prefix);
      }
      out.insert(out.end(), more.begin(), more.end());
    }
    return out;
  }

  const PluginHost& host_;
  const Tree& config_;
};

/// Returns whether the value of the field has keys of its own.
bool has_keys_within(const FieldDescription& field, const Tree& config, const std::string& path) {
  if (field.type == Type::section || (field.type == Type::plugin && !field.adopted)) return true;
  if (field.type != Type::sections && field.type != Type::plugins) return false;
  const Tree* list = config.find_path(path);
  return list != nullptr && !list->items.empty();
}

std::string meaning_of(const FieldDescription& field) {
  if (field.adopted || field.type == Type::section || field.type == Type::plugin) return field.meaning;
  return fmt::format("{} ({}{}{})", field.meaning, field.type_name(), field.range.empty() ? "" : " ", field.range);
}

std::vector<Completion> values(const CommandEnvironment& program, const std::filesystem::path& beside, const Keys& keys,
                               const FieldDescription& field, const std::string& path) {
  std::vector<Completion> out;
  if (field.type == Type::plugin && field.adopted) return plugin_names(program, field.kind);
  std::map<std::string, std::string> names;
  if (config_keys().is_group(path)) {
    for (const auto& [name, file] : program.composer.group_files().list(last_key(path), beside))
      names[name] = purpose_of(file);
  }
  if (field.type == Type::plugin) {
    for (const Completion& one : plugin_names(program, field.kind)) names.emplace(one.word, one.meaning);
  }
  for (const auto& [name, meaning] : names) out.push_back({name, meaning});
  for (const auto& one : field.cases) out.push_back({one.name, one.meaning});
  if (field.type == Type::flag) out.insert(out.end(), {{"true", ""}, {"false", ""}});
  if (field.type == Type::real || field.type == Type::integer) {
    std::string value = keys.value(field, path);
    value.erase(std::remove(value.begin(), value.end(), ' '), value.end());
    if (!value.empty()) out.push_back({value, "current value: " + meaning_of(field)});
  }
  return out;
}

}  // namespace

std::string purpose_of(const std::filesystem::path& config) {
  std::istringstream in(read_bounded(config, kMostConfigBytes, FileOrigin::user).text);
  std::string out;
  for (std::string line; std::getline(in, line) && line.rfind("# ", 0) == 0;) {
    out += (out.empty() ? "" : " ") + line.substr(2);
    if (const auto end = out.find(". "); end != std::string::npos) return out.substr(0, end);
  }
  return !out.empty() && out.back() == '.' ? out.substr(0, out.size() - 1) : out;
}

std::vector<Completion> plugin_names(const CommandEnvironment& program, const std::string& kind) {
  std::vector<Completion> out;
  for (const std::string& name : program.host.names(kind))
    out.push_back({name, purpose_of(program.installation.configs / kind / (name + ".yaml"))});
  return out;
}

std::vector<Completion> complete_key(CommandEnvironment& program, const std::string& config,
                                     const std::vector<std::string>& before, const std::string& typed) {
  const Tree tree = config_so_far(program.composer, config, before);
  const Keys keys(program.host, tree);
  const auto equals = typed.find('=');
  const std::string path = typed.substr(0, equals);
  std::string prefix;
  Descriptions level = keys.top();
  const auto named = [&](const std::string& name) {
    return std::find_if(level.begin(), level.end(), [&](const auto& field) { return field.name == name; });
  };
  for (std::string rest = path; rest.find('.') != std::string::npos; rest = rest.substr(rest.find('.') + 1)) {
    const auto field = named(first_key(rest));
    if (field == level.end()) return {};
    const std::string here = prefix + field->name;
    level = keys.within(FieldDescription(*field), here);
    prefix = here + ".";
  }
  std::vector<Completion> out;
  if (equals != std::string::npos) {
    const auto field = named(last_key(path));
    if (field == level.end()) return {};
    for (Completion& one : values(program, std::filesystem::path(config).parent_path(), keys, *field, path))
      out.push_back({path + "=" + one.word, std::move(one.meaning)});
    return out;
  }
  for (const FieldDescription& field : level) {
    const std::string key = prefix + field.name;
    const bool inner = has_keys_within(field, tree, key);
    if (!inner || config_keys().is_group(key)) out.push_back({key + "=", meaning_of(field)});
    if (inner) out.push_back({key + ".", meaning_of(field)});
  }
  return out;
}

}  // namespace palpate::cli
