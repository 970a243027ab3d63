// SPDX-License-Identifier: MIT
// What Python has for our values: arrays for maps, dicts for configs, columns for tables.
#pragma once

#include "config/quantity.hpp"
#include "config/tree.hpp"
#include "record/row.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <Eigen/Core>

#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace palpate {

namespace py = pybind11;

using Array = py::array_t<double>;

/// A map over the candidates.
struct Map {
  Eigen::VectorXd values;
  int rows;
  int columns;
};

/// The array keeps the values, and nothing else.
inline Array array_of(Map map) {
  auto* const kept = new Eigen::VectorXd(std::move(map.values));
  const py::capsule owner(kept, [](void* values) { delete static_cast<Eigen::VectorXd*>(values); });
  return Array({map.rows, map.columns}, kept->data(), owner);
}

/// What Python has for a value of a config: numbers, truth values, texts, and quantities as texts with their units.
inline py::object python_of(const Tree& tree) {
  switch (tree.kind) {
    case Tree::Kind::null:
      return py::none();
    case Tree::Kind::list: {
      py::list out;
      for (const Tree& item : tree.items) out.append(python_of(item));
      return out;
    }
    case Tree::Kind::map: {
      py::dict out;
      for (const Tree::Entry& entry : tree.entries) out[py::str(entry.key)] = python_of(entry.value);
      return out;
    }
    case Tree::Kind::scalar:
      break;
  }
  const std::string& text = tree.text;
  if (tree.quoted || text.empty()) return py::str(text);
  if (text == "true" || text == "false") return py::bool_(text == "true");
  if (decimal_length(text) != text.size()) return py::str(text);
  // Python reads them: what the C library takes for a decimal point is up to the locale, which belongs to the caller.
  if (text.find_first_not_of("-0123456789") == std::string::npos) return py::int_(py::str(text));
  return py::float_(py::str(text));
}

/// A column of a table by its name: numbers with NaN for null, or what Python has for it.
using Column = std::pair<std::string, py::object>;

/// Rows as columns.
inline std::vector<Column> columns_of(const std::vector<Row>& rows) {
  const std::vector<std::string> names = names_of(rows);
  std::map<std::string, std::size_t> known;
  for (std::size_t k = 0; k < names.size(); ++k) known.emplace(names[k], k);
  std::vector<std::vector<const Scalar*>> cells(names.size(), std::vector<const Scalar*>(rows.size(), nullptr));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    for (const auto& [name, value] : rows[i].fields) cells[known.at(name)][i] = &value;
  }
  std::vector<Column> out;
  for (std::size_t k = 0; k < names.size(); ++k) {
    bool numbers = true;
    bool whole = true;
    bool flags = true;
    for (const Scalar* cell : cells[k]) {
      const bool null = cell == nullptr || std::holds_alternative<std::monostate>(*cell);
      const bool is_whole = !null && std::holds_alternative<std::int64_t>(*cell);
      whole = whole && is_whole;
      numbers = numbers && (null || is_whole || std::holds_alternative<double>(*cell));
      flags = flags && !null && std::holds_alternative<bool>(*cell);
    }
    const auto fill = [&](auto array, const auto& value_of) {
      auto* to = array.mutable_data();
      for (const Scalar* cell : cells[k]) *to++ = value_of(cell);
      out.emplace_back(names[k], std::move(array));
    };
    const auto n = static_cast<py::ssize_t>(rows.size());
    if (flags) {
      fill(py::array_t<bool>(n), [](const Scalar* cell) { return std::get<bool>(*cell); });
    } else if (whole) {
      fill(py::array_t<std::int64_t>(n), [](const Scalar* cell) { return std::get<std::int64_t>(*cell); });
    } else if (numbers) {
      fill(Array(n), [](const Scalar* cell) {
        if (cell == nullptr || std::holds_alternative<std::monostate>(*cell))
          return std::numeric_limits<double>::quiet_NaN();
        const auto* integer = std::get_if<std::int64_t>(cell);
        return integer != nullptr ? static_cast<double>(*integer) : std::get<double>(*cell);
      });
    } else {
      py::list all;
      for (const Scalar* cell : cells[k]) {
        if (cell == nullptr || std::holds_alternative<std::monostate>(*cell)) {
          all.append(py::none());
        } else {
          std::visit(
              [&](const auto& value) {
                using Value = std::decay_t<decltype(value)>;
                if constexpr (std::is_same_v<Value, JsonList>) {
                  all.append(py::module_::import("json").attr("loads")(value.text));
                } else if constexpr (!std::is_same_v<Value, std::monostate>) {
                  all.append(value);
                }
              },
              *cell);
        }
      }
      out.emplace_back(names[k], std::move(all));
    }
  }
  return out;
}

}  // namespace palpate
