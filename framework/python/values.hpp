// SPDX-License-Identifier: MIT
// Conversion of C++ values to Python: maps become arrays, configs become dicts, and tables become columns.
#pragma once

#include "config/quantity.hpp"
#include "config/tree.hpp"
#include "record/row.hpp"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <Eigen/Core>

#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace palpate {

namespace py = pybind11;

using Array = py::array_t<double>;

/// The values of a quantity at all candidates, row by row.
struct Map {
  Eigen::VectorXd values;
  int rows;
  int columns;
};

/// Returns a NumPy array of rows x columns, which owns the values.
inline Array array_of(Map map) {
  auto* const kept = new Eigen::VectorXd(std::move(map.values));
  const py::capsule owner(kept, [](void* values) { delete static_cast<Eigen::VectorXd*>(values); });
  return Array({map.rows, map.columns}, kept->data(), owner);
}

/// Converts a config to Python. Maps become dicts; lists, numbers and booleans become the same types of Python. Other
/// values, such as quantities with a unit, become strings; null becomes None.
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
  // Python parses the numbers, because the C library expects the decimal point of the caller's locale.
  if (text.find_first_not_of("-0123456789") == std::string::npos) return py::int_(py::str(text));
  return py::float_(py::str(text));
}

inline py::object python_of(const Scalar& scalar) {
  return std::visit(
      [](const auto& value) -> py::object {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, std::monostate>)
          return py::none();
        else if constexpr (std::is_same_v<Value, JsonList>)
          return py::module_::import("json").attr("loads")(value.text);
        else
          return py::cast(value);
      },
      scalar);
}

/// A column of a table: its name and its values, which are None in rows without a value.
using Column = std::pair<std::string, py::list>;

inline std::vector<Column> columns_of(const std::vector<Row>& rows) {
  std::vector<Column> out;
  for (const std::string& name : names_of(rows)) {
    py::list values;
    std::size_t near = 0;
    for (const Row& row : rows) {
      const Scalar* const cell = row.find(name, near);
      values.append(cell != nullptr ? python_of(*cell) : py::none());
    }
    out.emplace_back(name, std::move(values));
  }
  return out;
}

}  // namespace palpate
