// SPDX-License-Identifier: MIT
// The field list of a record, as an options struct has one: each field is named once, with its unit, its meaning, which
// way is better and when it has no value. Whoever writes the record, reads it, judges by it, compares it, draws it or
// documents it takes the field from here.
//
//     FieldList<Summary> list;
//     list.add("taps", "all taps, failed ones included", [](const Summary& s) { return s.result.taps; }).less();
#pragma once

#include "record/row.hpp"

#include <palpate/options.hpp>

#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace palpate {

/// What is said of one field of a record: everything but its value.
struct RecordField {
  enum class Type { number, flag, text };
  enum class Better { less, more, neither };

  RecordField(std::string key, std::string sentence) : name(std::move(key)), meaning(std::move(sentence)) {}

  /// Its dimension; lengths are metres, times seconds, forces newtons.
  RecordField& in(Unit dimension) { return unit = dimension, *this; }
  RecordField& less() { return better = Better::less, *this; }
  RecordField& more() { return better = Better::more, *this; }
  /// What it means that a run, or a tap, which ended well has no value.
  RecordField& absent(std::string reason) { return when_null = std::move(reason), *this; }
  /// It tells of clock, memory or machine: not the same when the same is run again.
  RecordField& measured() { return of_machine = true, *this; }
  /// Its name on pages and in tables for people.
  RecordField& called(std::string words) { return label = std::move(words), *this; }
  /// Worth a first look where there is no room for all; in the order of the list.
  RecordField& headline() { return first_look = true, *this; }

  std::string name;     ///< dotted where nested: "compute.infer"; of a family "height_gp.*"
  std::string meaning;  ///< a sentence without its full stop, in Markdown
  Type type = Type::number;
  Unit unit = Unit::none;
  Better better = Better::neither;
  std::string when_null;
  std::string label;
  bool of_machine = false;
  bool first_look = false;
};

/// Reads the cells of one row. Errors name `where`, the file and the tap.
class RowReader {
 public:
  RowReader(const Row& row, std::string where) : row_(row), where_(std::move(where)) {}

  const Row& row() const { return row_; }
  /// Returns the number of a field, `absent` for null. Throws Error for something else.
  double number(const char* name, double absent) const;
  /// Returns the index of a text among `names`. Throws Error for another text.
  std::size_t index(const char* name, const std::vector<const char*>& names) const;
  [[noreturn]] void refuse(const std::string& reason) const;

 private:
  const Row& row_;
  std::string where_;
};

/// The fields of the record that is made of a `Record`, in their order.
template <class Record>
class FieldList {
 public:
  /// One field; `get`, a function or a member, gives of a Record a number, truth value, text, or an optional of these,
  /// null without one.
  template <class Get>
  RecordField& add(std::string name, std::string meaning, Get get) {
    return add_where([](const Record&) { return true; }, std::move(name), std::move(meaning), std::move(get));
  }

  /// A field that only those records have of which `has` holds: others lack even its name.
  template <class Has, class Get>
  RecordField& add_where(Has has, std::string name, std::string meaning, Get get) {
    RecordField field(std::move(name), std::move(meaning));
    field.type = type_of(static_cast<std::decay_t<std::invoke_result_t<Get, const Record&>>*>(nullptr));
    return insert(field, false, [=, key = field.name](Row& row, const Record& record) {
      if (has(record)) row.add(key, std::invoke(get, record));
    });
  }

  /// Fields that stand in a list of their own, because several records have them; `write` adds them to a row.
  void add_shared(const std::vector<RecordField>& fields, std::function<void(Row&, const Record&)> write) {
    for (const RecordField& one : fields) insert(one, false, [](Row&, const Record&) {});
    if (!fields.empty()) entries_.back().write = std::move(write);
  }

  /// Fields whose names only a record knows, such as those of a kernel: `pattern` stands for them in documents,
  /// `write` adds them.
  RecordField& add_family(std::string pattern, std::string meaning, std::function<void(Row&, const Record&)> write) {
    return insert(RecordField(std::move(pattern), std::move(meaning)), true, std::move(write));
  }

  /// Has the latest field read what it writes.
  void read_by(std::function<void(Record&, const RowReader&)> read) { entries_.back().read = std::move(read); }

  /// Returns the record of a row, as far as fields read what they write. Throws Error for a cell that is damaged.
  Record read(const RowReader& row) const {
    Record out;
    for (const Entry& one : entries_) {
      if (one.read) one.read(out, row);
    }
    return out;
  }

  /// A record as a row.
  Row row(const Record& record) const {
    Row out;
    out.fields.reserve(2 * entries_.size());
    for (const Entry& one : entries_) one.write(out, record);
    return out;
  }

  /// All that has a name of its own; with `families`, what stands for the others, too.
  std::vector<RecordField> fields(bool families = false) const {
    std::vector<RecordField> out;
    for (const Entry& one : entries_) {
      if (families || !one.family) out.push_back(one.field);
    }
    return out;
  }

 private:
  struct Entry {
    RecordField field;
    bool family;
    std::function<void(Row&, const Record&)> write;
    std::function<void(Record&, const RowReader&)> read;
  };

  template <class T>
  static RecordField::Type type_of(const std::optional<T>*) {
    return type_of(static_cast<const T*>(nullptr));
  }
  template <class T>
  static RecordField::Type type_of(const T*) {
    if constexpr (std::is_same_v<T, bool>) return RecordField::Type::flag;
    return std::is_arithmetic_v<T> ? RecordField::Type::number : RecordField::Type::text;
  }

  RecordField& insert(RecordField field, bool family, std::function<void(Row&, const Record&)> write) {
    entries_.push_back({std::move(field), family, std::move(write), nullptr});
    return entries_.back().field;
  }

  std::vector<Entry> entries_;
};

}  // namespace palpate
