// SPDX-License-Identifier: MIT
#include "config/keys.hpp"

#include <algorithm>
#include <stdexcept>

namespace palpate {

std::string first_key(const std::string& path) { return path.substr(0, path.find('.')); }
std::string last_key(const std::string& path) { return path.substr(path.rfind('.') + 1); }

bool is_at_or_below(const std::string& path, const std::string& top) {
  return path.compare(0, top.size(), top) == 0 && (path.size() == top.size() || path[top.size()] == '.');
}

ConfigKeys::ConfigKeys(const std::function<void(Fields&)>& list) {
  const std::vector<FieldDescription> fields = describe_fields(list);
  note_fields(fields, "");
  for (const FieldDescription& field : fields) {
    if (field.owner == Owner::unsaid) {
      throw std::logic_error("the key '" + field.name + "' does not say whether it is of a strategy or of the run");
    }
    if (field.owner == Owner::run) of_run_.insert(field.name);
  }
}

void ConfigKeys::note_fields(const std::vector<FieldDescription>& fields, const std::string& path) {
  for (const FieldDescription& field : fields) {
    if (field.group) groups_.push_back(path + field.name);
    if (field.group && !field.kind.empty()) plugins_.insert(field.kind);
    if (!field.beside.empty()) {
      groups_.push_back(field.beside);
      beside_.emplace(path + field.name, field.beside);
    }
    if (!field.heir_of.empty()) heirs_.emplace_back(path + field.name, field.heir_of);
    if (field.type == FieldDescription::Type::section) note_fields(field.fields, path + field.name + ".");
  }
}

bool ConfigKeys::is_group(const std::string& path) const {
  return is_plugin(path) || std::find(groups_.begin(), groups_.end(), path) != groups_.end();
}

bool ConfigKeys::is_plugin(const std::string& path) const { return plugins_.count(last_key(path)) > 0; }

bool ConfigKeys::is_brought(const std::string& key) const {
  return std::any_of(beside_.begin(), beside_.end(), [&](const auto& one) { return one.second == key; });
}

std::string ConfigKeys::beside(const std::string& path) const {
  const auto found = beside_.find(path);
  return found != beside_.end() ? found->second : std::string();
}

bool ConfigKeys::is_decided(const std::string& path, const std::string& choice) const {
  const std::string own = beside(choice);
  return is_at_or_below(path, choice) || (!own.empty() && is_at_or_below(path, own));
}

bool ConfigKeys::is_part(const std::string& path) const {
  return path.find('.') != std::string::npos && is_group(path) && !is_plugin(path);
}

bool ConfigKeys::is_of_strategy(const std::string& path) const { return of_run_.count(first_key(path)) == 0; }

std::vector<std::string> ConfigKeys::heirs_of(const std::string& path) const {
  std::vector<std::string> out;
  for (const auto& [heir, from] : heirs_) {
    if (is_at_or_below(path, from)) out.push_back(heir + path.substr(from.size()));
  }
  return out;
}

}  // namespace palpate
