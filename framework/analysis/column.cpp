// SPDX-License-Identifier: MIT
#include "analysis/column.hpp"

#include "config/quantity.hpp"
#include "config/tree.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>

namespace palpate {

std::string Column::words() const {
  const RecordField* field = find_summary_field(name);
  if (field == nullptr || field->label.empty()) return name;
  // Labels of lengths, such as "over the scene", do not name the quantity, because pages show them below a heading that
  // names it.
  if (unit != Unit::metre) return field->label;
  return (name.find("rmse") != std::string::npos ? "RMSE " : "distance ") + field->label;
}

std::string Column::better_words() const {
  if (better == RecordField::Better::neither) return {};
  return better == RecordField::Better::more ? "more is better" : "less is better";
}

Column find_column(const std::string& name, const std::vector<std::string>& columns, const std::string& option) {
  const std::string of_run = field_name(name);
  const RecordField* field = find_summary_field(of_run);
  if (!is_one_of(columns, name) && !(field != nullptr && is_one_of(columns, of_run)))
    throw Error("command line", fmt::format("{}: results.csv has no column '{}'", option, name),
                suggestion(name, columns));
  return {name, unit_of_column(of_run), field != nullptr ? field->better : RecordField::Better::neither};
}

CellNumber number_of(const Scalar* cell) {
  if (cell == nullptr) return {};
  if (const auto* truth = std::get_if<bool>(cell)) return {*truth ? 1.0 : 0.0};
  if (const auto* whole = std::get_if<std::int64_t>(cell)) return {static_cast<double>(*whole)};
  if (const auto* real = std::get_if<double>(cell)) return {std::isfinite(*real) ? std::optional(*real) : std::nullopt};
  const auto* text = std::get_if<std::string>(cell);
  if (text == nullptr || text->empty()) return {};
  if (*text == "true" || *text == "false") return {*text == "true" ? 1.0 : 0.0};
  double number = 0.0;
  const char* const end = text->data() + text->size();
  const auto read = std::from_chars(text->data(), end, number);
  if (read.ec != std::errc() || read.ptr != end) return {{}, true};
  return {std::isfinite(number) ? std::optional(number) : std::nullopt};
}

std::string written_in(const std::string& column, const Scalar& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  const auto* number = std::get_if<double>(&cell);
  if (number != nullptr && std::isfinite(*number)) return write_quantity(*number, unit_of_column(column));
  return csv_cell(cell);
}

JobValue value_of_job(const Row* row, const std::string& column, const std::string& option) {
  if (row == nullptr) return {ValueStatus::unfinished};
  if (!is_done(*row)) return {ValueStatus::failed};
  const CellNumber number = number_of(result_of(*row, column));
  if (number.is_text)
    throw Error("command line",
                fmt::format("{}: the column '{}' holds {}, not numbers", option, column, row->cell(column)),
                "name a column of numbers");
  return number.value ? JobValue{ValueStatus::counted, *number.value} : JobValue{ValueStatus::without_value};
}

std::string StatusCounts::words(const std::vector<ValueStatus>& statuses, const std::string& behind) const {
  constexpr const char* kWords[] = {"with one job excluded by --where", "without a partner", "unfinished", "failed",
                                    "without a value"};  // texts in the order of ValueStatus
  std::vector<std::string> out;
  for (const ValueStatus status : statuses) {
    if (of(status) > 0)
      out.push_back(fmt::format("{}{} {}", of(status), behind, kWords[static_cast<std::size_t>(status)]));
  }
  return fmt::format("{}", fmt::join(out, ", "));
}

bool is_done(const Row& row) { return row.text("status") == "done"; }

}  // namespace palpate
