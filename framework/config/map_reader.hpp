// SPDX-License-Identifier: MIT
// Reads one map of a config: known keys, values of fields, and the text for the id of the run. See resolve.cpp for the
// kinds of fields.
#pragma once

#include "config/resolve.hpp"

#include <palpate/options.hpp>

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

/// Properties that a nested map takes over from the map around it.
struct ParentContext {
  SourceLocation place;
  std::string id_path;    ///< the path, with former names of fields (Field::was())
  bool enters_id = true;  ///< see Field::not_identifying()
  bool complete = false;  ///< see Tree::complete
};

class MapReader : public Fields {
 public:
  /// If `input` is null, each field has its default or, in a record, its neutral value. If `input` has no place, errors
  /// have the place in `around`. `path` is "" at the top, otherwise it ends with a dot.
  MapReader(const Tree& input, std::string path, ResolveNotes& notes, ParentContext around);

  /// Rejects keys that no field has claimed, and returns the resolved map. `elsewhere`: see resolve().
  Tree finish(const std::vector<std::string>& elsewhere = {});

  void retired(const Field& field, const FixedValue& last) override;
  void require(bool holds, const char* field, const std::string& reason) override;

 protected:
  /// Returns the full path of a field for messages.
  std::string name(const Field& field) const { return path_of(field.name); }
  std::string path_of(const std::string& key) const { return (is_beside(key) ? above_ : path_) + key; }
  bool is_beside(const std::string& key) const { return !beside_.empty() && key == beside_; }
  static std::string item_of(const Field& field, std::size_t i) { return field.name + ("." + std::to_string(i)); }
  std::string owner() const { return path_.empty() ? "the config" : path_.substr(0, path_.size() - 1); }
  std::string where() const { return output_.place.text(); }

  static bool is_none(const Tree& tree) { return tree.is_scalar() && !tree.quoted && tree.text == "none"; }
  static std::string shown(const Tree& tree);
  [[noreturn]] void refuse(const Tree& at, const Field& field, const std::string& reason,
                           const std::string& hint) const;
  void check_list(const Tree& tree, const Field& field, const char* hint) const;
  /// Rejects a key that is nearly `name`, or else notes the missing option: see ResolveNotes.
  void miss(const std::string& name, Error missing);

  /// Returns the value of a field, in a record also under its former name; null if there is none.
  const Tree* find(const Field& field);

  /// The meaning of a field that a record lacks.
  enum class Missing { refused, absent, of_its_parts };
  /// Marks a field as known and returns its value. Returns null if a config does not set it. In a record, a missing
  /// field has its neutral value: see resolve().
  const Tree* claim(const Field& field, Missing missing = Missing::refused);
  /// Like claim(), for a list; its neutral value is the empty list.
  const Tree* claim_list(const Field& field);

  /// Notes the type that decides which fields exist. If an override of a record chose the type, missing fields have
  /// their defaults instead of their neutral values.
  void note_type(const Tree& type);

  double quantity(const Tree& tree, const Field& field) const;
  std::int64_t whole(const Tree& tree, const Field& field) const;

  // The text for the id of the run (identity_text()):
  bool enters(const Field& field) const { return enters_id_ && field.enters_id; }
  std::string id_name(const Field& field) const;
  void identify(std::string path, std::string_view value) {
    notes_.identity.push_back(std::move(path.append("=").append(value)));
  }
  static std::string sized(const std::string& text) { return std::to_string(text.size()) + ":" + text; }
  static std::string id_text(const double* values, std::size_t count, Unit unit);
  /// Adds an absent field to the id, unless absence is its neutral value.
  void note_absent(const Field& field);
  /// Adds the number of items to the id. Returns whether the items must follow.
  bool note_count(const Field& field, std::size_t count);

  /// Writes a claimed field. `id_text` is its value in the id; "" if other code adds it to the id.
  void write(const Field& field, Tree value, std::string_view id_text);
  /// Writes a claimed scalar, whose text also goes into the id.
  void write(const Field& field, std::string text);

  /// Returns the properties for the map at `name`, which is the field or one of its items.
  ParentContext around(const Field& field, const std::string& name) const;

  const Tree& input_;
  std::string path_;
  std::string plugin_;    ///< plugin that has these options; "": none
  std::string beside_;    ///< option next to the plugin: Field::with_beside(); "": none
  std::string above_;     ///< path of the map around such a plugin
  std::string id_above_;  ///< `above_` with former names of fields
  bool silent_ = false;   ///< whether the options of a plugin are unknown, so that any key may be valid
  std::string adopted_;   ///< adopted plugin (Fields::adopt()), whose options are among these; "": none
  ResolveNotes& notes_;
  Tree output_;
  std::string id_path_;
  bool enters_id_;
  bool complete_;
  std::vector<std::string> known_;

 private:
  bool is_known(const std::string& key) const;
  /// Returns the neutral value of an option, which applies in records that are older than the option; null if it is the
  /// default.
  const Tree* neutral(const Field& field, bool may_be_absent);
  double checked(double value, const Tree& tree, const Field& field) const;
  /// Returns the path of an option called `key` in a nested group; "" if there is none.
  std::string path_to(const std::string& key) const;
  /// `known`: candidates for the hint.
  [[noreturn]] void refuse_unknown(const Tree::Entry& entry, const std::vector<std::string>& known) const;
  const Tree* claimed_ = nullptr;  ///< value of the last claimed field
  Tree neutral_;                   ///< the neutral value to which claimed_ may point
  Layer type_layer_ = std::numeric_limits<Layer>::min();
};

}  // namespace palpate
