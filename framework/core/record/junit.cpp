// SPDX-License-Identifier: MIT
#include "record/junit.hpp"

#include "config/utf8.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace palpate {
namespace {

/// What stands for a character; blanks but the space, as they are, would be read as spaces.
constexpr std::array<std::pair<char, std::string_view>, 7> kEntities{
    {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\t', "&#9;"}, {'\n', "&#10;"}, {'\r', "&#13;"}}};

/// Text inside the quotes of an attribute.
std::string xml_text(const std::string& text) {
  std::string out;
  for (std::string_view rest = text; !rest.empty();) {
    const auto entity =
        std::find_if(kEntities.begin(), kEntities.end(), [&](const auto& one) { return one.first == rest.front(); });
    const std::size_t length = utf8_length(rest);
    const std::string_view sequence = rest.substr(0, std::max<std::size_t>(length, 1));
    // U+FFFE and U+FFFF are valid UTF-8, but no characters of XML.
    const bool is_none = length == 0 || static_cast<unsigned char>(rest.front()) < 0x20 || sequence == "\xef\xbf\xbe" ||
                         sequence == "\xef\xbf\xbf";
    out += entity != kEntities.end() ? entity->second : is_none ? "\xef\xbf\xbd" : sequence;
    rest.remove_prefix(sequence.size());
  }
  return out;
}

}  // namespace

std::string junit_xml(const std::string& suite, const std::vector<TestCase>& cases) {
  const auto failures = std::count_if(cases.begin(), cases.end(),
                                      [](const TestCase& one) { return !one.failure.empty() && !one.tolerated; });
  const auto skipped = std::count_if(cases.begin(), cases.end(),
                                     [](const TestCase& one) { return one.tolerated && !one.failure.empty(); });
  double seconds = 0.0;
  for (const TestCase& one : cases) seconds += one.seconds;
  const std::string counts =
      fmt::format("tests=\"{}\" failures=\"{}\" errors=\"0\" time=\"{:.6f}\"", cases.size(), failures, seconds);
  std::string out = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites " + counts + ">\n";
  out += fmt::format("  <testsuite name=\"{}\" {} skipped=\"{}\">\n", xml_text(suite), counts, skipped);
  for (const TestCase& one : cases) {
    out += fmt::format("    <testcase classname=\"{}\" name=\"{}\" time=\"{:.6f}\"", xml_text(one.group),
                       xml_text(one.name), one.seconds);
    out += one.failure.empty() ? std::string("/>\n")
                               : fmt::format(">\n      <{} message=\"{}\"/>\n    </testcase>\n",
                                             one.tolerated ? "skipped" : "failure", xml_text(one.failure));
  }
  return out + "  </testsuite>\n</testsuites>\n";
}

}  // namespace palpate
