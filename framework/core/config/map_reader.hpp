// SPDX-License-Identifier: MIT
// One map of a config while its fields are read: which keys are known, what stands at a field, what enters the id. What
// is done with each kind of field, see resolve.cpp.
#pragma once

#include "config/resolve.hpp"

#include <palpate/options.hpp>

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

/// What readers of nested groups take from the one around.
struct Around {
  Place place;
  std::string id_path;    ///< as the path, but with the names that fields had first (Field::was)
  bool enters_id = true;  ///< see Field::not_identifying()
  bool complete = false;  ///< see Tree::complete
};

class MapReader : public Fields {
 public:
  /// Where `input` is null every field has its default, or of a record its neutral value, and where it has no place
  /// errors name that of what is around. `path` is "" at the top, else it ends in a dot.
  MapReader(const Tree& input, std::string path, ResolveNotes& notes, Around around);

  /// Refuses keys that no field has claimed, and gives away what was written. `elsewhere`: see resolve().
  Tree finish(const std::vector<std::string>& elsewhere = {});

  void retired(const Field& field, const FixedValue& last) override;
  void require(bool holds, const char* field, const std::string& reason) override;

 protected:
  /// The name by which messages call a field: its whole path.
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
  /// Refuses a key that is nearly the name of what is missing; else notes that that is missing: see ResolveNotes.
  void miss(const std::string& name, Error missing);

  /// What the config has at the field, or a record at the name that it had then. Null when it does not say it.
  const Tree* find(const Field& field);

  /// What it means that a record has no value for a field.
  enum class Missing { refused, absent, of_its_parts };
  /// Finds the field's value and remembers that the field exists. Null when the config does not say it; a record always
  /// says it, if not by itself then by the neutral value: see resolve().
  const Tree* claim(const Field& field, Missing missing = Missing::refused);
  /// Of a list, which may have no items.
  const Tree* claim_list(const Field& field);

  /// What chose the fields beside it: where it was not the record, these are its defaults, not what a record must have.
  void note_type(const Tree& type);

  double quantity(const Tree& tree, const Field& field) const;
  std::int64_t whole(const Tree& tree, const Field& field) const;

  // What enters the id (identity_text()):
  bool enters(const Field& field) const { return enters_id_ && field.enters_id; }
  std::string id_name(const Field& field) const;
  void identify(std::string path, std::string_view value) {
    notes_.identity.push_back(std::move(path.append("=").append(value)));
  }
  static std::string sized(const std::string& text) { return std::to_string(text.size()) + ":" + text; }
  static std::string id_text(const double* values, std::size_t count, Unit unit);
  /// A field that is absent enters the id only where that is not neutral.
  void note_absent(const Field& field);
  /// Returns whether the items are to follow.
  bool note_count(const Field& field, std::size_t count);

  /// Writes a field that has been claimed; `id_text` is its value in the id, "" of what enters it otherwise.
  void write(const Field& field, Tree value, std::string_view id_text);
  /// The same of a scalar that enters the id as it is written.
  void write(const Field& field, std::string text);

  /// For what stands at `name` of this map, which is the field or an item of it.
  Around around(const Field& field, const std::string& name) const;

  const Tree& input_;
  std::string path_;
  std::string plugin_;    ///< whose options these are; "" for none
  std::string beside_;    ///< the option of the plugin that stands beside it: Field::with_beside(); "" for none
  std::string above_;     ///< the path of what is around such a plugin
  std::string id_above_;  ///< the same for the id
  bool silent_ = false;   ///< a plugin among these is: any key may be its
  std::string adopted_;   ///< whose options stand among them; "" for none
  ResolveNotes& notes_;
  Tree output_;
  std::string id_path_;
  bool enters_id_;
  bool complete_;
  std::vector<std::string> known_;

 private:
  bool is_known(const std::string& key) const;
  /// The value that an option has in a record of a palpate that did not know it; null for its default.
  const Tree* neutral(const Field& field, bool may_be_absent);
  double checked(double value, const Tree& tree, const Field& field) const;
  /// `known`: what it may have been meant for.
  [[noreturn]] void refuse_unknown(const Tree::Entry& entry, const std::vector<std::string>& known) const;
  const Tree* claimed_ = nullptr;  ///< of the field that was claimed last
  Tree neutral_;                   ///< what it points to where a record lacks the field
  Layer type_layer_ = std::numeric_limits<Layer>::min();
};

}  // namespace palpate
