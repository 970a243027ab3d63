// SPDX-License-Identifier: MIT
#include "experiment/resolved.hpp"

#include "config/hash.hpp"

#include <algorithm>
#include <cctype>

namespace palpate {

ResolvedConfig resolve_experiment(const Tree& composed, const PluginSource& plugins) {
  Tree input = composed;
  input.erase("sweep");
  input.erase("expect");
  ResolvedConfig out;
  out.tree = resolve(out.options, input, plugins, out.notes);
  if (const Tree* expect = composed.find("expect")) {
    out.expectations = read_expectations(expect);
    if (!out.expectations.empty()) out.tree.at("expect") = resolved_expect(*expect, out.notes);
  }
  Tree identity = Tree::map();
  for (const Tree::Entry& entry : out.tree.entries) {
    if (enters_id(entry.key)) identity.entries.push_back(entry);
  }
  out.id = hash_of(identity.canonical()).substr(0, kIdLength);
  return out;
}

ResolvedConfig load_experiment(Composer& composer, const PluginSource& plugins, const std::filesystem::path& file,
                               const std::vector<Override>& overrides) {
  return resolve_experiment(composer.compose(file, overrides), plugins);
}

bool begins_with_id(const std::string& folder) {
  return folder.size() >= kIdLength && folder.find_first_not_of("0123456789abcdef") >= kIdLength;
}

std::string slug(const std::string& name) {
  std::string out;
  for (const char c : name) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-';
    if (plain) {
      out += c;
    } else if (!out.empty() && out.back() != '-') {
      out += '-';
    }
  }
  out = out.substr(0, 64);
  out.erase(0, std::min(out.find_first_not_of(".-"), out.size()));
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out.empty() ? "experiment" : out;
}

}  // namespace palpate
