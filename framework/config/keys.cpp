// SPDX-License-Identifier: MIT
#include "config/keys.hpp"

#include <algorithm>
#include <stdexcept>

namespace palpate {

bool describes_many_runs(const std::string& key) { return key == "sweep" || key == "tune" || key == "compare"; }

std::string first_key(const std::string& path) { return path.substr(0, path.find('.')); }
std::string last_key(const std::string& path) { return path.substr(path.rfind('.') + 1); }

bool is_at_or_below(const std::string& path, const std::string& top) {
  return path.compare(0, top.size(), top) == 0 && (path.size() == top.size() || path[top.size()] == '.');
}

/// Reads the properties of keys from the field list. It skips the descriptions of the fields to save time, because
/// every command reads the properties first.
class ConfigKeys::Reader final : public Fields {
 public:
  explicit Reader(ConfigKeys& keys) : keys_(keys) {}

  void real(double&, const Field& field) override { note(field); }
  void real(std::optional<double>&, const Field& field) override { note(field); }
  void reals(double*, std::size_t, const Field& field) override { note(field); }
  void table(std::vector<double>&, std::size_t, const Field& field) override { note(field); }
  void integer(std::int64_t&, const Field& field) override { note(field); }
  void integer(std::optional<std::int64_t>&, const Field& field) override { note(field); }
  void flag(bool&, const Field& field) override { note(field); }
  void text(std::string&, const Field& field) override { note(field); }
  void choice(std::size_t&, const Field& field, const std::vector<Case>&) override { note(field); }
  void sections(const ListAccess&, const Field& field) override { note(field); }
  void plugin(PluginChoice& choice, const Field& field) override { note_plugin(choice.kind, field, choice.type); }
  void plugin(std::optional<PluginChoice>&, const char* kind, const Field& field) override { note_plugin(kind, field); }
  void plugins(std::vector<PluginChoice>&, const char* kind, const Field& field) override { note_plugin(kind, field); }
  void adopt(PluginChoice& choice, const Field& field) override { note_plugin(choice.kind, field); }
  void section(bool&, Options& options, const Field& field) override { section(options, field); }
  void section(Options& options, const Field& field) override {
    note(field);
    const std::size_t above = path_.size();
    path_.append(field.name).push_back('.');
    options.list(*this);
    path_.resize(above);
  }
  void require(bool, const char*, const std::string&) override {}

 private:
  ConfigKeys& keys_;
  std::string path_;  ///< path of the current section: "" at the top, otherwise it ends with a dot

  void note(const Field& field) {
    if (field.is_group) keys_.groups_.push_back(path_ + field.name);
    if (path_.empty()) note_owner(field);
    if (*field.heir_of != '\0') keys_.heirs_.emplace_back(path_ + field.name, field.heir_of);
  }
  void note_plugin(const std::string& kind, const Field& field, const std::string& type = "") {
    note(field);
    if (field.is_group) keys_.plugins_.insert(kind);
    if (!field.is_group && path_.empty()) keys_.typed_.emplace(field.name, type);
  }
  void note_owner(const Field& field) {
    const std::string name = field.name;
    if (field.owner == Owner::unsaid)
      throw std::logic_error("the key '" + name + "' does not say whether it is of a strategy or of the run");
    if (field.owner == Owner::run) keys_.of_run_.insert(name);
    if (*field.beside == '\0') return;
    keys_.groups_.emplace_back(field.beside);
    keys_.beside_.emplace(name, field.beside);
  }
};

ConfigKeys::ConfigKeys(const std::function<void(Fields&)>& list) {
  Reader reader(*this);
  list(reader);
}

bool ConfigKeys::is_group(const std::string& path) const {
  return is_plugin(path) || std::find(groups_.begin(), groups_.end(), path) != groups_.end();
}

bool ConfigKeys::is_plugin(const std::string& path) const { return plugins_.count(last_key(path)) > 0; }

std::string ConfigKeys::default_type(const std::string& key) const {
  const auto found = typed_.find(key);
  return found != typed_.end() ? found->second : std::string();
}

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
