// SPDX-License-Identifier: MIT
#include "baxter/urdf.hpp"

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <vector>

#include <tinyxml2.h>
#include <boost/lexical_cast/try_lexical_convert.hpp>

namespace palpate::baxter {
namespace {

using Element = const tinyxml2::XMLElement*;

/// Returns NaN if the text is not a number of at least 0.
double mass_of(const std::string& text) {
  double value = 0.0;
  const bool number = boost::conversion::try_lexical_convert(text, value) && value >= 0.0;
  return number ? value : std::numeric_limits<double>::quiet_NaN();
}

/// Returns an empty string if the element or the attribute does not exist.
std::string attribute(Element element, const char* name) {
  const char* value = element != nullptr ? element->Attribute(name) : nullptr;
  return value != nullptr ? value : "";
}

}  // namespace

std::optional<double> mass_beyond(const std::string& urdf, const std::string& link) {
  tinyxml2::XMLDocument document;
  // The parser is recursive and rejects XML that is nested too deeply.
  if (document.Parse(urdf.data(), urdf.size()) != tinyxml2::XML_SUCCESS) return {};
  std::map<std::string, double> masses;
  std::multimap<std::string, std::string> hanging_on;
  const Element robot = document.RootElement();
  for (Element one = robot->FirstChildElement("link"); one != nullptr; one = one->NextSiblingElement("link")) {
    const Element inertial = one->FirstChildElement("inertial");
    const Element mass = inertial != nullptr ? inertial->FirstChildElement("mass") : nullptr;
    masses[attribute(one, "name")] = mass != nullptr ? mass_of(attribute(mass, "value")) : 0.0;
  }
  for (Element one = robot->FirstChildElement("joint"); one != nullptr; one = one->NextSiblingElement("joint"))
    hanging_on.emplace(attribute(one->FirstChildElement("parent"), "link"),
                       attribute(one->FirstChildElement("child"), "link"));
  if (masses.count(link) == 0) return {};
  double sum = 0.0;
  std::set<std::string> seen{link};
  std::vector<std::string> open{link};
  while (!open.empty()) {
    const auto [begin, end] = hanging_on.equal_range(open.back());
    open.pop_back();
    for (auto joint = begin; joint != end; ++joint) {
      if (!seen.insert(joint->second).second) continue;
      sum += masses[joint->second];
      open.push_back(joint->second);
    }
  }
  return std::isfinite(sum) ? std::optional<double>(sum) : std::nullopt;
}

}  // namespace palpate::baxter
