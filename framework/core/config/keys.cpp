// SPDX-License-Identifier: MIT
#include "config/keys.hpp"

#include <algorithm>
#include <stdexcept>

namespace palpate {

std::string first_key(const std::string& path) { return path.substr(0, path.find('.')); }
std::string last_key(const std::string& path) { return path.substr(path.rfind('.') + 1); }

ConfigKeys::ConfigKeys(const std::vector<FieldDescription>& fields) {
  for (const FieldDescription& field : fields) {
    if (field.owner == Owner::unsaid) {
      throw std::logic_error("the key '" + field.name + "' does not say whether it is of a strategy or of the run");
    }
    if (field.owner == Owner::run) of_run_.insert(field.name);
  }
  add(fields, "");
}

void ConfigKeys::add(const std::vector<FieldDescription>& fields, const std::string& prefix) {
  for (const FieldDescription& field : fields) {
    const std::string path = prefix + field.name;
    if (field.group) {
      groups_.push_back(path);
      if (!field.kind.empty()) plugins_.insert(field.kind);
    }
    if (!field.heir_of.empty()) heirs_.emplace_back(path, field.heir_of);
    if (field.type == FieldDescription::Type::section) add(field.fields, path + ".");
  }
}

bool ConfigKeys::is_group(const std::string& path) const {
  return is_plugin(path) || std::find(groups_.begin(), groups_.end(), path) != groups_.end();
}

bool ConfigKeys::is_plugin(const std::string& path) const { return plugins_.count(last_key(path)) > 0; }

bool ConfigKeys::is_part(const std::string& path) const {
  return path.find('.') != std::string::npos && is_group(path) && !is_plugin(path);
}

bool ConfigKeys::is_of_strategy(const std::string& path) const { return of_run_.count(first_key(path)) == 0; }

std::vector<std::string> ConfigKeys::heirs_of(const std::string& path) const {
  std::vector<std::string> out;
  for (const auto& [heir, from] : heirs_) {
    const bool is_below =
        path.compare(0, from.size(), from) == 0 && (path.size() == from.size() || path[from.size()] == '.');
    if (is_below) out.push_back(heir + path.substr(from.size()));
  }
  return out;
}

}  // namespace palpate
