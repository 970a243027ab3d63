// SPDX-License-Identifier: MIT
#include "reading/ply.hpp"

#include "reading/read_file.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <sstream>
#include <utility>

namespace palpate {
namespace {

/// Returns the size of a type in a binary file, bytes; 0 for an unknown name.
std::size_t size_of(const std::string& type) {
  const BinaryNumberType* const scalar = ply_scalar(type);
  return scalar != nullptr ? scalar->size : 0;
}

struct Property {
  std::size_t count_size = 0;  ///< size of the number that counts a list's items, bytes; 0 if not a list
  std::size_t size = 0;        ///< size of an item of the list, or of the only value, bytes
};

struct Element {
  std::string name;
  std::uint64_t rows = 0;
  std::vector<Property> properties;
  std::string header;     ///< header lines of the element
  std::string_view body;  ///< rows of the element
};

/// Splits a file into its elements. split() returns false for a malformed file.
class PlySplitter {
 public:
  explicit PlySplitter(const std::string& bytes) : rest_(bytes) {}

  bool split() {
    return read_header() && std::all_of(elements.begin(), elements.end(), [&](Element& one) { return read_rows(one); });
  }

  std::string begin;  ///< header lines before the first element
  std::vector<Element> elements;

 private:
  /// Removes and returns the next line without its line end; nullopt without a line end.
  std::optional<std::string_view> take_line() {
    const std::size_t end = rest_.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    std::string_view out = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    if (!out.empty() && out.back() == '\r') out.remove_suffix(1);
    return out;
  }

  bool read_header() {
    for (bool first = true;; first = false) {
      const auto text = take_line();
      if (!text) return false;
      std::istringstream in{std::string(*text)};
      std::vector<std::string> words;
      for (std::string word; in >> word;) words.push_back(word);
      if (words.empty() || (first && words != std::vector<std::string>{"ply"})) return false;
      if (words.front() == "end_header") return words.size() == 1;
      if (!read_header_line(words)) return false;
      std::string& header = elements.empty() ? begin : elements.back().header;
      if (words.front() == "comment" || words.front() == "obj_info") continue;
      for (const std::string& word : words) header += (&word == &words.front() ? "" : " ") + word;
      header += '\n';
    }
  }

  bool read_header_line(const std::vector<std::string>& words) {
    const std::string& first = words.front();
    if (first == "format" && words.size() == 3) return format_ = words[1], true;
    if (first == "element" && words.size() == 3) {
      const bool is_count = words[2].size() <= 9 && words[2].find_first_not_of("0123456789") == std::string::npos;
      if (is_count) elements.push_back({words[1], std::stoull(words[2]), {}, "", {}});
      return is_count;
    }
    if (first != "property") return true;
    if (elements.empty()) return false;
    if (words.size() == 3) elements.back().properties.push_back({0, size_of(words[1])});
    if (words.size() == 5 && words[1] == "list")
      elements.back().properties.push_back({size_of(words[2]), size_of(words[3])});
    return elements.back().properties.empty() ? false : elements.back().properties.back().size > 0;
  }

  bool read_rows(Element& element) {
    const std::string_view all = rest_;
    for (std::uint64_t row = 0; row < element.rows; ++row) {
      if (!(format_ == "ascii" ? read_ascii_row() : read_binary_row(element))) return false;
    }
    element.body = all.substr(0, all.size() - rest_.size());
    return true;
  }

  /// Removes one row. The last row of the file may lack its line end.
  bool read_ascii_row() {
    if (rest_.empty()) return false;
    if (!take_line()) rest_ = {};
    return true;
  }

  bool read_binary_row(const Element& element) {
    for (const Property& one : element.properties) {
      const std::uint64_t count = one.count_size == 0 ? 1 : read_count(one.count_size);
      if (rest_.size() < one.count_size || (rest_.size() - one.count_size) / one.size < count) return false;
      rest_.remove_prefix(one.count_size + count * one.size);
    }
    return true;
  }

  std::uint64_t read_count(std::size_t size) const {
    std::uint64_t out = 0;
    for (std::size_t i = 0; i < std::min(size, rest_.size()); ++i) {
      const std::size_t at = format_ == "binary_big_endian" ? i : size - 1 - i;
      if (at < rest_.size()) out = (out << 8) | static_cast<unsigned char>(rest_[at]);
    }
    return out;
  }

  std::string_view rest_;
  std::string format_;
};

}  // namespace

const BinaryNumberType* ply_scalar(std::string_view name) {
  static constexpr std::array<std::pair<std::array<const char*, 2>, BinaryNumberType>, 8> kScalars{
      {{{"char", "int8"}, binary_number<std::int8_t>()},
       {{"uchar", "uint8"}, binary_number<std::uint8_t>()},
       {{"short", "int16"}, binary_number<std::int16_t>()},
       {{"ushort", "uint16"}, binary_number<std::uint16_t>()},
       {{"int", "int32"}, binary_number<std::int32_t>()},
       {{"uint", "uint32"}, binary_number<std::uint32_t>()},
       {{"float", "float32"}, binary_number<float>()},
       {{"double", "float64"}, binary_number<double>()}}};
  for (const auto& [names, scalar] : kScalars) {
    if (name == names[0] || name == names[1]) return &scalar;
  }
  return nullptr;
}

std::string plain_ply(std::string bytes, const std::vector<std::string>& elements) {
  drop_byte_order_mark(bytes);
  PlySplitter file(bytes);
  if (!file.split()) return bytes;
  std::string header = file.begin;
  std::string body;
  for (const std::string& name : elements) {
    for (const Element& one : file.elements) {
      if (one.name != name) continue;
      header += one.header;
      body += one.body;
      if (!body.empty() && header.find("format ascii") != std::string::npos && body.back() != '\n') body += '\n';
    }
  }
  return header + "end_header\n" + body;
}

}  // namespace palpate
