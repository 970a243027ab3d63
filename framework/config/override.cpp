// SPDX-License-Identifier: MIT
#include "config/override.hpp"

#include "config/yaml.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace palpate {

namespace {

constexpr const char* kCommandLine = "command line";

/// Returns the position of a YAML comment in the value of an override; npos if there is none.
std::size_t comment_in(const std::string& value, const Tree& read) {
  const auto begins = [&](std::size_t at) {
    return value[at] == '#' && (at == 0 || value[at - 1] == ' ' || value[at - 1] == '\t');
  };
  for (std::size_t at = 0; at < value.size(); ++at) {
    // A # within quotes is text. In this case, the value that is cut at the # parses to something else.
    if (begins(at) && parse_value(value.substr(0, at), kCommandLine).canonical() == read.canonical()) return at;
  }
  return std::string::npos;
}

}  // namespace

void check_path(const std::string& path, const std::string& place) {
  const bool has_gap =
      path.empty() || path.front() == '.' || path.back() == '.' || path.find("..") != std::string::npos;
  if (has_gap) throw Error(place, fmt::format("'{}' is not a dotted path", path), "write it like kernel.length_scale");
  constexpr std::size_t kMostBytes = 1024;
  constexpr std::ptrdiff_t kMostLevels = 100;
  if (path.size() <= kMostBytes && std::count(path.begin(), path.end(), '.') < kMostLevels) return;
  throw Error(place, fmt::format("'{}...' is too long a path", path.substr(0, 40)),
              "a path has at most 100 levels and 1024 characters");
}

Override parse_override(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0)
    throw Error(kCommandLine, fmt::format("'{}' is not KEY=VALUE", text), "for example kernel.length_scale=2cm");
  Override out{text.substr(0, equals), parse_value(text.substr(equals + 1), kCommandLine)};
  check_path(out.path, kCommandLine);
  if (const auto comment = comment_in(text.substr(equals + 1), out.value); comment != std::string::npos)
    throw Error(kCommandLine, fmt::format("{}: '{}' is a comment", out.path, text.substr(equals + 1 + comment)),
                "put the value in its own quotes: KEY='\"a #b\"'");
  out.value.set_layer(kCommandLineLayer);
  return out;
}

void check_given_once(const std::vector<std::string>& texts) {
  std::set<std::string> seen;
  for (const std::string& text : texts) {
    const std::string path = text.substr(0, text.find('='));
    if (!seen.insert(path).second)
      throw Error(kCommandLine, fmt::format("{} is given twice", path), "leave one of them out");
  }
}

}  // namespace palpate
