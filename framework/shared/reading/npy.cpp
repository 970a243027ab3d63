// SPDX-License-Identifier: MIT
#include "reading/npy.hpp"

#include <algorithm>

namespace palpate {
namespace {

/// Returns the length in bytes of the dictionary value at the beginning of `text`. The value ends at a comma or a
/// closing bracket outside of its own brackets and quotes.
std::size_t value_length(std::string_view text) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\'') quoted = !quoted;
    if (quoted) continue;
    const bool closes = c == ')' || c == ']' || c == '}';
    if (depth == 0 && (closes || c == ',')) return i;
    depth += c == '(' || c == '[' || c == '{' ? 1 : closes ? -1 : 0;
  }
  return text.size();
}

/// Returns the numbers of a tuple such as "(3,4)" or "(3,)"; none for any other text.
std::vector<std::uint64_t> parse_sizes(std::string_view shape) {
  constexpr std::size_t kMostDigits = 9;
  std::vector<std::uint64_t> out;
  if (shape.size() < 2 || shape.front() != '(' || shape.back() != ')') return out;
  shape = shape.substr(1, shape.size() - 2);
  while (!shape.empty()) {
    const std::string_view digits = shape.substr(0, shape.find(','));
    const bool is_whole = digits.find_first_not_of("0123456789") == std::string_view::npos;
    if (digits.empty() || digits.size() > kMostDigits || !is_whole) return {};
    out.push_back(0);
    for (const char c : digits) out.back() = 10 * out.back() + static_cast<std::uint64_t>(c - '0');
    shape.remove_prefix(std::min(digits.size() + 1, shape.size()));
  }
  return out;
}

}  // namespace

std::optional<NpyHeaderSpan> npy_header_place(std::string_view bytes) {
  constexpr std::string_view kMagic = "\x93NUMPY";
  if (bytes.size() < kNpyStart || bytes.substr(0, kMagic.size()) != kMagic) return std::nullopt;
  const char version = bytes[kMagic.size()];
  if (version < 1 || version > 3) return std::nullopt;
  NpyHeaderSpan out;
  out.begin = version == 1 ? kNpyStart : kLongNpyStart;
  if (bytes.size() < out.begin) return std::nullopt;
  for (std::size_t i = out.begin; i-- > kMagic.size() + 2;)
    out.length = (out.length << 8U) + static_cast<unsigned char>(bytes[i]);
  return out;
}

NpyHeader read_npy_header(std::string_view text) {
  constexpr std::size_t kMost = 4096;  // bytes, for a header of three keys
  std::string plain;
  for (const char c : text.substr(0, kMost)) {
    if (c != ' ' && c != '\t' && c != '\r' && c != '\n') plain += c == '"' ? '\'' : c;
  }
  NpyHeader out;
  std::string_view rest = plain;
  if (rest.empty() || rest.front() != '{') return out;
  rest.remove_prefix(1);
  while (!rest.empty() && rest.front() == '\'') {
    const std::size_t end = rest.find("':", 1);
    if (end == std::string_view::npos) break;
    const std::string_view key = rest.substr(1, end - 1);
    rest.remove_prefix(end + 2);
    std::string_view value = rest.substr(0, value_length(rest));
    rest.remove_prefix(std::min(value.size() + 1, rest.size()));
    if (key == "fortran_order") out.order = value;
    if (key == "shape") out.shape = value;
    const bool is_name = value.size() >= 2 && value.front() == '\'' && value.find('\'', 1) == value.size() - 1;
    if (key == "descr") out.type = is_name ? value.substr(1, value.size() - 2) : value;
  }
  out.sizes = parse_sizes(out.shape);
  return out;
}

}  // namespace palpate
