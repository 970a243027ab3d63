// SPDX-License-Identifier: MIT
#include "record/evaluation_point.hpp"

#include "config/comparison.hpp"
#include "config/quantity.hpp"
#include "record/fields.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

namespace palpate {

Checkpoint Checkpoint::after(int taps) {
  Checkpoint out;
  out.taps_ = taps;
  out.words_ = fmt::format("after {} taps", taps);
  out.key_ = fmt::format("at_{}", taps);
  return out;
}

Checkpoint Checkpoint::once(const std::string& text) {
  const Override goal = parse_override(text);
  const RecordField* const field = find_summary_field(goal.path);
  if (field == nullptr || field->better == RecordField::Better::neither) {
    std::vector<std::string> known;
    for (const RecordField& one : summary_fields()) {
      if (one.better != RecordField::Better::neither) known.push_back(one.name);
    }
    throw Error("command line",
                fmt::format("--until: '{}' is not a field of the summary for which more or less is better", goal.path),
                suggestion(goal.path, known));
  }
  Checkpoint out;
  out.field_ = field->name;
  out.goal_ = read_quantity(goal.value, "--until " + field->name, field->unit);
  out.less_ = field->better == RecordField::Better::less;
  out.words_ = fmt::format("once {} was {} or {}", field->name, goal.value.text, out.less_ ? "less" : "more");
  out.key_ = fmt::format("until_{}_{}", field->name, out.goal_);
  return out;
}

bool Checkpoint::has_come(int taps, const Row& summary) const {
  if (taps_) return taps >= *taps_;
  return satisfies(summary.number(field_), less_ ? Relation::at_most : Relation::at_least, goal_);
}

}  // namespace palpate
