// SPDX-License-Identifier: MIT
#include "record/junit.hpp"

#include "config/utf8.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace palpate {
namespace {

/// Text inside the quotes of an attribute.
std::string xml_text(const std::string& text) {
  constexpr std::string_view kReplacement = "\xef\xbf\xbd";
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\t' || c == '\n' || c == '\r') {
      // As they are, a reader would take them for blanks.
      out += fmt::format("&#{};", static_cast<int>(c));
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += kReplacement;
    } else {
      const std::size_t length = utf8_length(std::string_view(text).substr(i));
      const std::string_view sequence = std::string_view(text).substr(i, length);
      // U+FFFE and U+FFFF are valid UTF-8, but no characters of XML.
      const bool is_none = length == 0 || sequence == "\xef\xbf\xbe" || sequence == "\xef\xbf\xbf";
      out += is_none ? kReplacement : sequence;
      i += std::max<std::size_t>(length, 1) - 1;
    }
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
