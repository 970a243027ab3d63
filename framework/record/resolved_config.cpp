// SPDX-License-Identifier: MIT
#include "record/resolved_config.hpp"

#include "config/hash.hpp"
#include "config/quantity.hpp"
#include "config/yaml.hpp"
#include "scene/random_objects.hpp"

#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/trim.hpp>

#include <algorithm>
#include <string_view>

namespace palpate {

std::string identity_text(const ResolveNotes& notes) {
  std::vector<std::string_view> lines(notes.identity.begin(), notes.identity.end());
  std::sort(lines.begin(), lines.end());
  std::string out = "palpate-id 1\n";
  for (const std::string_view line : lines) out.append(line) += '\n';
  return out;
}

ResolvedConfig resolve_experiment(const Tree& composed, const PluginSource& plugins) {
  Tree input = composed;
  for (const char* const key : {"sweep", "tune", "compare", "expect"}) input.erase(key);
  ResolvedConfig out;
  if (draws_objects(input)) {
    if (const Tree* seed = input.find("seed")) out.options.seed = read_integer(*seed, "seed");
    draw_objects(input, static_cast<std::uint64_t>(out.options.seed), plugins);
  }
  std::vector<std::string> beside;
  for (const Field& field : keys_beside_options()) beside.emplace_back(field.name);
  out.tree = resolve(out.options, input, plugins, out.notes, beside);
  const Tree* expect = composed.find("expect");
  out.expectations = read_expectations(expect);
  if (!out.expectations.empty()) out.tree.at("expect") = resolved_expect(*expect, out.notes);
  check_readable(out.tree, composed.place.text());
  out.identity = hash_of(identity_text(out.notes));
  out.id = out.identity.substr(0, kIdLength);
  return out;
}

HeightMapOptions height_map_options(const ExperimentOptions& options, const PluginSource& plugins) {
  HeightMapOptions out;
  fill(*options.belief.options, plugins, "belief", [&](Fields& fields) { out.list(fields); });
  return out;
}

bool begins_with_id(const std::string& folder) {
  return folder.size() >= kIdLength && folder.find_first_not_of("0123456789abcdef") >= kIdLength;
}

std::string slug(const std::string& name) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  std::string out;
  for (const char c : name) {
    if (kPlain.find(c) != std::string_view::npos) {
      out += c;
    } else if (!out.empty() && out.back() != '-') {
      out += '-';
    }
  }
  out = out.substr(0, 64);
  boost::trim_left_if(out, boost::is_any_of(".-"));
  boost::trim_right_if(out, boost::is_any_of("-"));
  if (out == name && !out.empty()) return out;
  constexpr std::size_t kDigits = 6;
  return (out.empty() ? "experiment" : out) + '~' + hash_of(name).substr(0, kDigits);
}

}  // namespace palpate
