// SPDX-License-Identifier: MIT
#include "record/row.hpp"

#include "config/quantity.hpp"

#include <boost/algorithm/string/replace.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <list>
#include <string_view>
#include <unordered_map>

namespace palpate {
namespace {

/// Appends a scalar; appends nothing for null and for numbers that are not finite. `append_text` is called to append a
/// text.
template <class AppendText>
void append_scalar(std::string& out, const Scalar& value, const AppendText& append_text) {
  if (const auto* truth = std::get_if<bool>(&value)) {
    out += *truth ? "true" : "false";
  } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    out += std::to_string(*whole);
  } else if (const auto* real = std::get_if<double>(&value)) {
    if (!std::isfinite(*real)) return;
    append_number(out, *real);
    // JSON parsers read "-0" as the integer 0 and lose the sign.
    if (*real == 0.0 && std::signbit(*real)) out += ".0";
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    append_text(*text);
  } else if (const auto* list = std::get_if<JsonList>(&value)) {
    append_text(list->text);
  }
}

/// Returns the value at `name` if it has type T, else null.
template <class T>
const T* value_of(const Row& row, std::string_view name) {
  const Scalar* value = row.find(name);
  return value != nullptr ? std::get_if<T>(value) : nullptr;
}

/// Adds an apostrophe to a text that begins like a formula, so that a spreadsheet does not compute it. A formula that
/// already has leading apostrophes gets one more, so that removing one restores the text.
std::string guarded(const std::string& text) {
  const std::size_t begin = text.find_first_not_of("' \t\r\n");
  const bool computed = begin != std::string::npos && std::string_view("=+-@").find(text[begin]) != std::string::npos;
  return computed && decimal_length(text) != text.size() ? "'" + text : text;
}

}  // namespace

void append_number(std::string& out, double value) {
  std::array<char, 32> text;  // the longest has 24 characters: -2.2250738585072014e-308
  const char* const end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  out.append(text.data(), static_cast<std::size_t>(end - text.data()));
}

const Scalar* Row::find(std::string_view name, std::size_t& near) const {
  if (near < fields.size() && fields[near].first == name) return &fields[near].second;
  const Scalar* const found = find(name);
  if (found == nullptr) return nullptr;
  near = 0;
  while (&fields[near].second != found) ++near;
  return found;
}

const Scalar* Row::find(std::string_view name) const {
  for (const auto& [key, value] : fields) {
    if (key == name) return &value;
  }
  return nullptr;
}

std::optional<double> Row::number(std::string_view name) const {
  const Scalar* value = find(name);
  if (value == nullptr) return std::nullopt;
  if (const auto* whole = std::get_if<std::int64_t>(value)) return static_cast<double>(*whole);
  if (const auto* truth = std::get_if<bool>(value)) return *truth ? 1.0 : 0.0;
  const auto* real = std::get_if<double>(value);
  return real != nullptr && std::isfinite(*real) ? std::optional(*real) : std::nullopt;
}

std::optional<bool> Row::flag(std::string_view name) const {
  const bool* truth = value_of<bool>(*this, name);
  return truth != nullptr ? std::optional(*truth) : std::nullopt;
}

std::string Row::text(std::string_view name) const {
  const std::string* text = value_of<std::string>(*this, name);
  return text != nullptr ? *text : std::string();
}

void Row::erase(std::string_view name) {
  fields.erase(std::remove_if(fields.begin(), fields.end(), [&](const auto& field) { return field.first == name; }),
               fields.end());
}

std::string Row::cell(std::string_view name) const {
  const Scalar* value = find(name);
  return value != nullptr ? csv_cell(*value) : std::string();
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  return '"' + boost::replace_all_copy(text, "\"", "\"\"") + '"';
}

std::string csv_cell(const Scalar& value) {
  std::string out;
  append_scalar(out, value, [&](const std::string& text) { out += csv_text(text); });
  return out;
}

std::vector<std::string> names_of(const std::vector<Row>& rows) {
  std::list<std::string> names;  // a list keeps references valid when it grows
  std::unordered_map<std::string_view, std::list<std::string>::iterator> places;
  for (const Row& row : rows) {
    auto at = names.begin();  // expected position of the next field of this row
    for (const auto& [name, value] : row.fields) {
      if (at == names.end() || *at != name) {
        const auto known = places.find(name);
        if (known != places.end()) at = known->second;
        if (known == places.end()) {
          at = names.insert(at, name);
          places.emplace(*at, at);
        }
      }
      ++at;
    }
  }
  return {std::make_move_iterator(names.begin()), std::make_move_iterator(names.end())};
}

std::string to_csv(const std::vector<Row>& rows) {
  const std::vector<std::string> header = names_of(rows);
  if (header.empty()) return {};
  std::unordered_map<std::string_view, std::size_t> columns;
  std::string out;
  for (const std::string& name : header) {
    columns.emplace(name, columns.size());
    out += (out.empty() ? "" : ",") + csv_text(guarded(name));
  }
  out += "\n";
  std::vector<const Scalar*> cells(header.size());
  for (const Row& row : rows) {
    std::fill(cells.begin(), cells.end(), nullptr);
    std::size_t column = 0;  // expected column of the next field
    for (const auto& [name, value] : row.fields) {
      if (column == header.size() || header[column] != name) column = columns.at(name);
      const Scalar*& cell = cells[column++];
      if (cell == nullptr) cell = &value;
    }
    for (const Scalar*& cell : cells) {
      if (cell != nullptr) append_scalar(out, *cell, [&](const std::string& text) { out += csv_text(guarded(text)); });
      out += &cell == &cells.back() ? '\n' : ',';
    }
  }
  return out;
}

}  // namespace palpate
