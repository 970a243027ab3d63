// SPDX-License-Identifier: MIT
#include "analysis/column.hpp"

#include "config/tree.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <set>

namespace palpate {

constexpr const char* kCommandLine = "command line";

std::vector<std::string> columns_of(const std::vector<Row>& results) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const Row& row : results) {
    for (const auto& field : row.fields) {
      if (seen.insert(field.first).second) names.push_back(field.first);
    }
  }
  return names;
}

Column find_column(const std::string& name, const std::vector<std::string>& columns, const std::string& option) {
  if (std::find(columns.begin(), columns.end(), name) == columns.end()) {
    throw Error(kCommandLine, fmt::format("{}: results.csv has no column '{}'", option, name),
                suggestion(name, columns));
  }
  const RecordField* field = find_summary_field(name);
  return {name, unit_of_column(name), field != nullptr ? field->better : RecordField::Better::neither};
}

std::optional<double> number_in(const Row& row, const std::string& column, const std::string& option) {
  const Scalar* value = row.find(column);
  const std::string text = value != nullptr ? csv_cell(*value) : std::string();
  if (text.empty()) return {};
  if (text == "true" || text == "false") return text == "true" ? 1.0 : 0.0;
  double number = 0.0;
  const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
  if (result.ec == std::errc() && result.ptr == text.data() + text.size()) return number;
  throw Error(kCommandLine, fmt::format("{}: the column '{}' holds {}, not numbers", option, column, text),
              "name one that can be averaged");
}

bool is_done(const Row& row) { return row.text("status") == "done"; }

}  // namespace palpate
