// SPDX-License-Identifier: MIT
// Conversions to JSON that nlohmann::json lacks: optional values, rows, tables.
#pragma once

#include "analysis/table.hpp"
#include "record/row.hpp"

#include <nlohmann/json.hpp>

#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace nlohmann {

template <class T>
struct adl_serializer<std::optional<T>> {
  static void to_json(json& out, const std::optional<T>& value) { out = value ? json(*value) : json(); }
};

template <>
struct adl_serializer<std::monostate> {
  static void to_json(json& out, std::monostate /*null*/) { out = nullptr; }
};
template <>
struct adl_serializer<palpate::JsonList> {
  static void to_json(json& out, const palpate::JsonList& list) { out = json::parse(list.text); }
};

}  // namespace nlohmann

namespace palpate {

using Json = nlohmann::json;

/// Converts a row to a flat object. Dots in the names of fields are kept.
inline void to_json(Json& out, const Row& row) {
  out = Json::object();
  for (const auto& [name, value] : row.fields) out[name] = std::visit([](const auto& one) { return Json(one); }, value);
}

/// Converts a table to {titles, rows, left}, where `left` is the number of text columns before the numbers.
inline void to_json(Json& out, const Table& table) {
  auto rows = table.cells();
  const std::vector<std::string> titles = rows.front();
  rows.erase(rows.begin());
  out = {{"titles", titles}, {"rows", rows}, {"left", table.text_columns()}};
}

}  // namespace palpate
