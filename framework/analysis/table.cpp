// SPDX-License-Identifier: MIT
#include "analysis/table.hpp"

#include "config/text_layout.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/algorithm/string/replace.hpp>

#include <string_view>

namespace palpate {

void Table::show(const std::string& title, std::string cell, Kind kind) {
  if (next_ == columns_.size()) columns_.push_back({title, kind, {}});
  columns_[next_++].cells.push_back(std::move(cell));
}

bool Table::is_hidden(const Column& column) const {
  const auto is_nothing = [](const std::string& cell) { return cell.empty() || cell == "0"; };
  return column.kind == Kind::count && std::all_of(column.cells.begin(), column.cells.end(), is_nothing);
}

std::vector<std::vector<std::string>> Table::lines(std::string (*escape)(const std::string&)) const {
  std::vector<std::vector<std::string>> out(1 + rows_.size());
  for (const Column& one : columns_) {
    if (is_hidden(one)) continue;
    const auto written = [&](const std::string& text) { return one.kind == Kind::latex ? text : escape(text); };
    out[0].push_back(written(one.title));
    for (std::size_t row = 0; row < rows_.size(); ++row) out[row + 1].push_back(written(one.cells[row]));
  }
  return out;
}

std::string Table::sides(const std::string& left, const std::string& right) const {
  std::string out;
  for (const Column& one : columns_) out += is_hidden(one) ? "" : one.kind == Kind::text ? left : right;
  return out;
}

std::vector<std::vector<std::string>> Table::cells() const {
  return lines([](const std::string& text) { return text; });
}

std::string Table::text() const { return aligned(cells(), sides("l", "r")); }

std::string Table::markdown() const {
  std::string out;
  // An unescaped '|' would end a cell.
  for (const auto& cells : lines([](const std::string& text) { return boost::replace_all_copy(text, "|", "\\|"); })) {
    const std::string rule = out.empty() ? "|" + sides("---|", "---:|") + "\n" : "";
    out += fmt::format("| {} |\n{}", fmt::join(cells, " | "), rule);
  }
  return out;
}

std::string Table::latex() const {
  std::string body;
  for (const auto& cells : lines(latex_text))
    body += fmt::format("{} \\\\\n{}", fmt::join(cells, " & "), body.empty() ? "\\midrule\n" : "");
  return fmt::format("\\begin{{tabular}}{{{}}}\n\\toprule\n{}\\bottomrule\n\\end{{tabular}}\n", sides("l", "r"), body);
}

std::string latex_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("&%$#_{}").find(c) != std::string_view::npos) {
      out += std::string("\\") + c;
    } else if (c == '\\' || c == '~' || c == '^') {
      out += c == '\\' ? "\\textbackslash{}" : c == '~' ? "\\textasciitilde{}" : "\\textasciicircum{}";
    } else {
      out += c;
    }
  }
  return !out.empty() && out.front() == '[' ? "{" + out + "}" : out;
}

}  // namespace palpate
