// SPDX-License-Identifier: MIT
#include "scene/size_warnings.hpp"

#include "config/display_units.hpp"
#include "config/quantity.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/algorithm/string/predicate.hpp>

#include <map>

namespace palpate {

std::vector<std::string> partly_given_sizes(const Tree& resolved, const ResolveNotes& notes) {
  struct Object {
    std::string place;
    bool has_size = false;
    std::vector<std::string> left_out;
  };
  std::map<std::string, Object> objects;
  for (const ResolveNotes::Origin& one : notes.origins) {
    if (!boost::starts_with(one.path, "scene.objects.")) continue;
    const std::size_t dot = one.path.rfind('.');
    Object& object = objects[one.path.substr(0, dot)];
    if (one.path.substr(dot + 1) == "type") object.place = one.place;
    const Tree* const value = resolved.find_path(one.path);
    if (value == nullptr || !value->is_scalar() || !boost::ends_with(value->text, " m")) continue;
    const bool is_said = one.place != "default";
    object.has_size = object.has_size || is_said;
    if (is_said) continue;
    const double length = read_quantity(*value, "", Unit::metre);
    object.left_out.push_back(
        fmt::format("{} {}", one.path.substr(dot + 1), readable(length, Unit::metre, 3, LengthKind::place)));
  }
  std::vector<std::string> out;
  for (const auto& [path, object] : objects) {
    if (!object.has_size || object.left_out.empty()) continue;
    out.push_back(fmt::format("{}: {}: not given, so the default is used: {}", object.place, path,
                              fmt::join(object.left_out, ", ")));
  }
  return out;
}

}  // namespace palpate
