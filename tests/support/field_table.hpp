// SPDX-License-Identifier: MIT
// A field list as runs/README.md has it.
#pragma once

#include "config/quantity.hpp"
#include "record/field.hpp"

#include <fmt/format.h>

#include <string>

namespace palpate::test {

/// The fields as a table of runs/README.md.
template <class Record>
std::string table_of(const FieldList<Record>& list) {
  std::string out = "| field | unit | meaning |\n|---|---|---|\n";
  for (const RecordField& field : list.fields(true)) {
    const char* const better = field.better == RecordField::Better::less   ? ". Less is better"
                               : field.better == RecordField::Better::more ? ". More is better"
                                                                           : "";
    out += fmt::format("| `{}` | {} | {}{}{} |\n", field.name, unit_symbol(field.unit), field.meaning, better,
                       field.when_null.empty() ? "" : ". Null where " + field.when_null);
  }
  return out;
}

}  // namespace palpate::test
