// SPDX-License-Identifier: MIT
// Reads one map of a config: checks its keys, parses the values of its fields, and collects the text from which the run
// id is computed. resolve.cpp reads the different kinds of fields.
#pragma once

#include "config/resolve.hpp"

#include <palpate/options.hpp>

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

/// Properties that a nested map inherits from the map around it.
struct ParentContext {
  SourceLocation place;
  std::string id_path;    ///< path of the map in the id, with former names of fields (Field::was())
  bool enters_id = true;  ///< see Field::not_identifying()
  bool complete = false;  ///< see Tree::complete
};

class MapReader : public Fields {
 public:
  /// If `input` is null, each field has its default or, in a record, its neutral value. If `input` has no source
  /// location, errors have the location in `around`. `path` is "" for the top level; otherwise it ends with a dot.
  MapReader(const Tree& input, std::string path, ResolveNotes& notes, ParentContext around);

  /// Rejects keys that no field has claimed, and returns the resolved map. `elsewhere`: see resolve().
  Tree finish(const std::vector<std::string>& elsewhere = {});

  void retired(const Field& field, const FixedValue& last) override;
  void require(bool holds, const char* field, const std::string& reason) override;

 protected:
  /// Returns the full path of a field, for messages.
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
  /// Called if the option `name` is missing. Throws Error for an unknown key that is similar to `name`; otherwise
  /// stores `missing` in ResolveNotes.
  void miss(const std::string& name, Error missing);

  /// Returns the value of a field; in a record, the value may have the former name of the field. Returns null if there
  /// is none.
  const Tree* find(const Field& field);

  /// Meaning of a field that a record lacks and that has no neutral value: an error, an absent field, or a group whose
  /// nested fields are read one by one.
  enum class MissingFieldMeaning { refused, absent, of_its_parts };
  /// Marks a field as known and returns its value; null if the config does not set it. In a record, a missing field has
  /// its neutral value: see resolve().
  const Tree* claim(const Field& field, MissingFieldMeaning missing = MissingFieldMeaning::refused);
  /// Like claim(), for a list; its neutral value is the empty list.
  const Tree* claim_list(const Field& field);

  /// Stores the layer of the type, because the type decides which fields exist. If an override of a record chose the
  /// type, missing fields have their defaults instead of their neutral values.
  void note_type(const Tree& type);

  double quantity(const Tree& tree, const Field& field) const;
  std::int64_t whole(const Tree& tree, const Field& field) const;

  // Functions for the text of the run id (identity_text()).
  bool enters(const Field& field) const { return enters_id_ && field.enters_id; }
  std::string id_name(const Field& field) const;
  void identify(std::string path, std::string_view value) {
    notes_.identity.push_back(std::move(path.append("=").append(value)));
  }
  static std::string sized(const std::string& text) { return std::to_string(text.size()) + ":" + text; }
  static std::string id_text(const double* values, std::size_t count, Unit unit);
  /// Adds an absent field to the id. Does nothing if absence is the neutral value of the field.
  void note_absent(const Field& field);
  /// Adds the number of items of a list to the id. Returns whether the items must be added, too.
  bool note_count(const Field& field, std::size_t count);

  /// Writes a claimed field to the output. `id_text` is the value of the field in the id; "" if other code adds the
  /// value to the id.
  void write(const Field& field, Tree value, std::string_view id_text);
  /// Writes a claimed scalar to the output, and adds its text to the id.
  void write(const Field& field, std::string text);

  /// Returns the ParentContext of the nested map at `name`, which is the field or an item of the field.
  ParentContext around(const Field& field, const std::string& name) const;

  const Tree& input_;
  std::string path_;
  std::string plugin_;    ///< plugin to which these options belong; "" for none
  std::string beside_;    ///< sibling key of the plugin: see Field::with_beside(); "" for none
  std::string above_;     ///< path of the map around the plugin, in which the sibling key is
  std::string id_above_;  ///< `above_` with former names of fields
  bool silent_ = false;   ///< whether the options of a plugin are unknown, so that any key may be valid
  std::string adopted_;   ///< adopted plugin (Fields::adopt()), whose options are in this map; "" for none
  ResolveNotes& notes_;
  Tree output_;
  std::string id_path_;
  bool enters_id_;
  bool complete_;
  std::vector<std::string> known_;

 private:
  bool is_known(const std::string& key) const;
  /// Returns the neutral value of an option, which applies in records that are older than the option. Returns null if
  /// the default of the option applies instead.
  const Tree* neutral(const Field& field, bool may_be_absent);
  double checked(double value, const Tree& tree, const Field& field) const;
  /// Returns the path of an option called `key` in a nested group; "" if there is none.
  std::string path_to(const std::string& key) const;
  /// Throws Error for an unknown key. `known`: names that the hint may suggest.
  [[noreturn]] void refuse_unknown(const Tree::Entry& entry, const std::vector<std::string>& known) const;
  const Tree* claimed_ = nullptr;  ///< value of the last claimed field
  Tree neutral_;                   ///< storage of a neutral value to which claimed_ may point
  Layer type_layer_ = std::numeric_limits<Layer>::min();
};

}  // namespace palpate
