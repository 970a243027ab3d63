// SPDX-License-Identifier: MIT
// The field list of a record, similar to the field list of an options struct. It defines each field once: name, unit,
// meaning, better direction, and reason for a missing value. All code that writes, reads, checks, compares, draws or
// documents the fields of a record uses this list.
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

/// Description of one field of a record, without its value.
struct RecordField {
  enum class Type { number, flag, text };
  enum class Better { less, more, neither };

  RecordField(std::string key, std::string sentence) : name(std::move(key)), meaning(std::move(sentence)) {}

  /// Sets the dimension; lengths are in metres, times in seconds, forces in newtons.
  RecordField& in(Unit dimension) { return unit = dimension, *this; }
  RecordField& less() { return better = Better::less, *this; }
  RecordField& more() { return better = Better::more, *this; }
  /// Sets the reason why a successful run or tap can lack a value.
  RecordField& absent(std::string reason) { return when_null = std::move(reason), *this; }
  /// Marks a measured time or memory, or a property of the machine. Its value may change when the same run is repeated.
  RecordField& measured() { return of_machine = true, *this; }
  /// Sets the name shown on pages and in tables.
  RecordField& called(std::string words) { return label = std::move(words), *this; }
  /// Marks an important field, which is shown even where space is limited. Marked fields are shown in the order of the
  /// list.
  RecordField& headline() { return first_look = true, *this; }

  std::string name;     ///< dotted if nested: "compute.infer"; a family has a pattern: "height_gp.*"
  std::string meaning;  ///< a sentence without its full stop, in Markdown
  Type type = Type::number;
  Unit unit = Unit::none;
  Better better = Better::neither;
  std::string when_null;
  std::string label;
  bool of_machine = false;
  bool first_look = false;
};

/// Reads the cells of one row. Error messages begin with `where`, the file and the tap.
class RowReader {
 public:
  RowReader(const Row& row, std::string where) : row_(row), where_(std::move(where)) {}

  const Row& row() const { return row_; }
  /// Returns the number of a field, or `absent` for null. Throws Error for any other value.
  double number(const char* name, double absent) const;
  /// Returns the index of a field's text in `names`. Throws Error for any other text.
  std::size_t index(const char* name, const std::vector<const char*>& names) const;
  [[noreturn]] void refuse(const std::string& reason) const;

 private:
  const Row& row_;
  std::string where_;
};

/// The fields of a record that is written from an object of type `Record`, in their order.
template <class Record>
class FieldList {
 public:
  /// Adds a field. `get`, a function or a member of Record, returns a number, a truth value, a text, or an optional of
  /// these; nullopt is written as null.
  template <class Get>
  RecordField& add(std::string name, std::string meaning, Get get) {
    return add_where([](const Record&) { return true; }, std::move(name), std::move(meaning), std::move(get));
  }

  /// Adds a field that a record contains only if `has` returns true; other records lack the whole field, including its
  /// name.
  template <class Has, class Get>
  RecordField& add_where(Has has, std::string name, std::string meaning, Get get) {
    RecordField field(std::move(name), std::move(meaning));
    field.type = type_of(static_cast<std::decay_t<std::invoke_result_t<Get, const Record&>>*>(nullptr));
    return insert(field, false, [=, key = field.name](Row& row, const Record& record) {
      if (has(record)) row.add(key, std::invoke(get, record));
    });
  }

  /// Adds fields that several kinds of records have in common. `write` adds the values of these fields to a row.
  void add_shared(const std::vector<RecordField>& fields, std::function<void(Row&, const Record&)> write) {
    for (const RecordField& one : fields) insert(one, false, [](Row&, const Record&) {});
    if (!fields.empty()) entries_.back().write = std::move(write);
  }

  /// Adds fields whose names depend on the record, such as those of a kernel. The documentation shows `pattern` instead
  /// of their names, and `write` adds the fields to a row.
  RecordField& add_family(std::string pattern, std::string meaning, std::function<void(Row&, const Record&)> write) {
    return insert(RecordField(std::move(pattern), std::move(meaning)), true, std::move(write));
  }

  /// Sets the function that reads the value of the last added field from a row.
  void read_by(std::function<void(Record&, const RowReader&)> read) { entries_.back().read = std::move(read); }

  /// Returns the record that is stored in a row. Only fields with a `read` function (see read_by()) are read. Throws
  /// Error for a damaged cell.
  Record read(const RowReader& row) const {
    Record out;
    for (const Entry& one : entries_) {
      if (one.read) one.read(out, row);
    }
    return out;
  }

  /// Returns a record as a row.
  Row row(const Record& record) const {
    Row out;
    out.fields.reserve(2 * entries_.size());
    for (const Entry& one : entries_) one.write(out, record);
    return out;
  }

  /// Returns the fields with fixed names; with `families`, also the patterns of the families.
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
