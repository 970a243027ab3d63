// SPDX-License-Identifier: MIT
#include "config/keys.hpp"

#include <algorithm>
#include <stdexcept>

namespace palpate {

std::string first_key(const std::string& path) { return path.substr(0, path.find('.')); }
std::string last_key(const std::string& path) { return path.substr(path.rfind('.') + 1); }

namespace {

bool is_at_or_below(const std::string& path, const std::string& top) {
  return path.compare(0, top.size(), top) == 0 && (path.size() == top.size() || path[top.size()] == '.');
}

}  // namespace

ConfigKeys::ConfigKeys(const std::vector<FieldDescription>& fields) {
  for (const FieldDescription& field : fields) {
    if (field.owner == Owner::unsaid) {
      throw std::logic_error("the key '" + field.name + "' does not say whether it is of a strategy or of the run");
    }
    if (field.owner == Owner::run) of_run_.insert(field.name);
    if (!field.strategy_part.empty()) strategy_parts_.push_back(field.name + "." + field.strategy_part);
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

bool ConfigKeys::is_of_strategy(const std::string& path) const {
  const auto in = [&](const std::string& part) { return is_at_or_below(path, part); };
  return of_run_.count(first_key(path)) == 0 || std::any_of(strategy_parts_.begin(), strategy_parts_.end(), in);
}

std::vector<std::string> ConfigKeys::heirs_of(const std::string& path) const {
  std::vector<std::string> out;
  for (const auto& [heir, from] : heirs_) {
    if (is_at_or_below(path, from)) out.push_back(heir + path.substr(from.size()));
  }
  return out;
}

}  // namespace palpate
