// SPDX-License-Identifier: MIT
#include "config/map_reader.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/replace.hpp>

#include <algorithm>
#include <array>

namespace palpate {
namespace {

/// Returns whether a key in a file is a dotted path, as used on the command line, whose first part is a known option.
bool is_below_one_of(const std::string& key, const std::vector<std::string>& known) {
  const auto dot = key.find('.');
  return dot != std::string::npos && std::find(known.begin(), known.end(), key.substr(0, dot)) != known.end();
}

/// Returns how a dotted key must be written in a file, for example `label: {clip: yes}`.
std::string nested(const Tree::Entry& entry) {
  const auto groups = std::count(entry.key.begin(), entry.key.end(), '.');
  constexpr std::size_t kShort = 40;
  const std::string& text = entry.value.text;
  const bool short_value = entry.value.is_scalar() && text.size() < kShort && text.find('\n') == std::string::npos;
  return boost::replace_all_copy(entry.key, ".", ": {") + ": " + (short_value ? text : "...") +
         std::string(static_cast<std::size_t>(groups), '}');
}

bool is_value(const FixedValue& constant) {
  return constant.kind != FixedValue::Kind::none && constant.kind != FixedValue::Kind::absent;
}

}  // namespace

MapReader::MapReader(const Tree& input, std::string path, ResolveNotes& notes, ParentContext around)
    : input_(input),
      path_(std::move(path)),
      notes_(notes),
      output_(Tree::map()),
      id_path_(std::move(around.id_path)),
      enters_id_(around.enters_id),
      complete_(input.kind == Tree::Kind::null ? around.complete : input.complete) {
  output_.place = input.place.file ? input.place : around.place;
  if (!input.is_map() && input.kind != Tree::Kind::null)
    throw Error(input.place.text(), fmt::format("{} is not a group of options", owner()),
                fmt::format("write {{key: value, ...}}{}", path_.empty() ? "" : " or " + path_ + "KEY=VALUE"));
}

Tree MapReader::finish(const std::vector<std::string>& elsewhere) {
  for (const Tree::Entry& entry : input_.entries) {
    if (silent_ || is_known(entry.key)) continue;
    Layer highest = std::numeric_limits<Layer>::min();  // highest layer of any part of the value
    for_all(entry.value, [&](const Tree& one) {
      // The layer of a non-empty map is ignored, because composition may have created the map. Only its values count.
      if (!one.is_map() || one.entries.empty()) highest = std::max(highest, one.layer);
    });
    if (highest < type_layer_) {
      notes_.dropped.push_back({path_of(entry.key), entry.value.place.text()});
      continue;
    }
    known_.insert(known_.end(), elsewhere.begin(), elsewhere.end());
    refuse_unknown(entry, known_);
  }
  return std::move(output_);
}

void MapReader::retired(const Field& field, const FixedValue& last) {
  if (silent_) return;
  const std::string text = constant_text(last, field.unit);
  const bool is_neutral = is_value(field.neutral_value) && constant_text(field.neutral_value, field.unit) == text;
  if (last.kind == FixedValue::Kind::absent) {
    note_absent(field);
  } else if (enters(field) && !is_neutral) {
    identify(id_name(field), last.kind == FixedValue::Kind::text ? sized(text) : text);
  }
  const Tree* tree = input_.find(field.name);
  if (tree == nullptr) return;
  known_.emplace_back(field.name);
  if (tree->layer < type_layer_) return;
  const bool is_last = complete_ && tree->is_scalar() &&
                       (last.kind == FixedValue::Kind::real ? quantity(*tree, field) == last.real : tree->text == text);
  if (is_last) return;
  throw Error(tree->place.text(), fmt::format("option '{}' no longer exists", field.name),
              complete_ ? fmt::format("only records with the value {} can be read", text) : field.meaning);
}

void MapReader::require(bool holds, const char* field, const std::string& reason) {
  if (holds) return;
  if (notes_.missing) throw Error(*notes_.missing);  // the missing option is probably the cause
  const SourceLocation place = input_.place_of(field);
  const std::string_view path = field;
  const std::string key(path.substr(0, path.find('.')));
  throw Error(place.file ? place.text() : where(),
              fmt::format("{}{}: {}", path_of(key), path.substr(key.size()), reason));
}

std::string MapReader::shown(const Tree& tree) {
  constexpr std::array kKinds{"nothing", "a value", "a list", "a map"};
  return tree.is_scalar() ? "'" + tree.text + "'" : kKinds[static_cast<std::size_t>(tree.kind)];
}

void MapReader::refuse(const Tree& at, const Field& field, const std::string& reason, const std::string& hint) const {
  throw Error(at.place.text(), fmt::format("{}: {}", name(field), reason), hint);
}

void MapReader::check_list(const Tree& tree, const Field& field, const char* hint) const {
  if (tree.kind != Tree::Kind::list) refuse(tree, field, "expects a list", hint);
}

const Tree* MapReader::find(const Field& field) {
  const Tree* tree = input_.find(field.name);
  if (tree != nullptr || !complete_ || *field.former_name == '\0') return tree;
  known_.emplace_back(field.former_name);
  return input_.find(field.former_name);
}

const Tree* MapReader::claim(const Field& field, MissingFieldMeaning missing) {
  if (!adopted_.empty() && is_known(field.name))
    throw Error(where(),
                fmt::format("{} has an option '{}', and {} has one of the same name", adopted_, field.name, owner()),
                "rename the plugin's option");
  known_.emplace_back(field.name);
  claimed_ = find(field);
  if (claimed_ == nullptr && field.required) {
    miss(field.name, {where(), fmt::format("'{}' is missing", name(field)), std::string("set it: ") + field.meaning});
    return nullptr;
  }
  if (claimed_ == nullptr && complete_ && missing != MissingFieldMeaning::of_its_parts)
    claimed_ = neutral(field, missing == MissingFieldMeaning::absent);
  return claimed_;
}

const Tree* MapReader::claim_list(const Field& field) {
  if (claim(field) == &neutral_) neutral_.kind = Tree::Kind::list;
  return claimed_;
}

const Tree* MapReader::neutral(const Field& field, bool may_be_absent) {
  const FixedValue& value = field.neutral_value;
  const bool is_absent = value.kind == FixedValue::Kind::none;
  // the default applies, because the field is not part of the id
  if (is_absent && !may_be_absent && !enters(field)) return nullptr;
  if (is_absent && !may_be_absent) {
    miss(field.name, {where(), fmt::format("'{}' is missing", name(field)),
                      "a config with 'complete' needs every option: restore it, or remove 'complete'"});
    return nullptr;
  }
  neutral_ = Tree::scalar(is_absent ? "none" : constant_text(value, field.unit), value.kind == FixedValue::Kind::text);
  neutral_.place.file = std::make_shared<const std::string>("neutral value");
  return &neutral_;
}

void MapReader::note_type(const Tree& type) {
  type_layer_ = std::max(type_layer_, type.layer);
  complete_ = complete_ && type.layer <= kFileLayer;
}

double MapReader::quantity(const Tree& tree, const Field& field) const {
  return checked(read_quantity(tree, name(field), field.unit), tree, field);
}

double MapReader::checked(double value, const Tree& tree, const Field& field) const {
  const bool low = field.open_below ? !(value > field.least) : value < field.least;
  if (!low && !(value > field.most)) return value;
  const char* const bound = !low ? "at most" : field.open_below ? "above" : "at least";
  refuse(tree, field, tree.text + " is out of range",
         fmt::format("it must be {} {}", bound, write_quantity(low ? field.least : field.most, field.unit)));
}

std::int64_t MapReader::whole(const Tree& tree, const Field& field) const {
  const std::int64_t value = read_integer(tree, name(field));
  checked(static_cast<double>(value), tree, field);
  return value;
}

std::string MapReader::id_name(const Field& field) const {
  return (is_beside(field.name) ? id_above_ : id_path_) + (*field.former_name != '\0' ? field.former_name : field.name);
}

std::string MapReader::id_text(const double* values, std::size_t count, Unit unit) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i)
    out.append(i == 0 ? "" : ", ") += write_quantity(values[i] == 0.0 ? 0.0 : values[i], unit);
  return out;
}

void MapReader::note_absent(const Field& field) {
  if (enters(field) && is_value(field.neutral_value)) identify(id_name(field), "none");
}

bool MapReader::note_count(const Field& field, std::size_t count) {
  const bool is_neutral = count == 0 && field.neutral_value.kind == FixedValue::Kind::absent;
  if (!enters(field) || is_neutral) return false;
  identify(id_name(field) + ".#", std::to_string(count));
  return true;
}

void MapReader::write(const Field& field, std::string text) {
  const bool is_negative_zero =
      text.size() > 1 && text[0] == '-' && text[1] == '0' && (text.size() == 2 || text[2] == ' ');
  const std::string id_text = is_negative_zero ? text.substr(1) : text;
  write(field, Tree::scalar(std::move(text)), id_text);
}

void MapReader::write(const Field& field, Tree value, std::string_view id_text) {
  notes_.origins.push_back({name(field), claimed_ != nullptr ? claimed_->place.text() : "default"});
  if (claimed_ != nullptr) value.place = claimed_->place;
  const auto is_neutral = [&] {
    if (!is_value(field.neutral_value)) return false;
    const std::string text = constant_text(field.neutral_value, field.unit);
    return id_text == text || (value.is_scalar() && value.text == text);
  };
  if (!id_text.empty() && enters(field) && !is_neutral()) identify(id_name(field), id_text);
  output_.at(field.name) = std::move(value);
}

ParentContext MapReader::around(const Field& field, const std::string& name) const {
  const std::string item = name.substr(std::string_view(field.name).size());
  return {output_.place, id_name(field) + item + ".", enters(field), complete_};
}

bool MapReader::is_known(const std::string& key) const {
  return std::find(known_.begin(), known_.end(), key) != known_.end();
}

void MapReader::refuse_unknown(const Tree::Entry& entry, const std::vector<std::string>& known) const {
  if (is_beside(entry.key)) {
    const Tree* last = &entry.value;  // part of the value on the highest layer
    for_all(entry.value, [&](const Tree& one) { last = one.layer > last->layer ? &one : last; });
    throw Error((last->layer > entry.value.layer ? last->place : entry.place).text(),
                fmt::format("{} has no {}", plugin_, entry.key), fmt::format("remove '{}'", path_of(entry.key)));
  }
  const std::string reason = fmt::format("unknown option '{}'", entry.key);
  if (is_below_one_of(entry.key, known)) throw Error(entry.place.text(), reason, "write " + nested(entry));
  const std::string hint = suggestion(entry.key, known);
  // If the hint lists all known keys, the message must name the map to which these keys belong.
  const bool listed = hint.rfind("known: ", 0) == 0;
  if (const std::string deeper = listed && path_.empty() ? path_to(entry.key) : ""; !deeper.empty())
    throw Error(entry.place.text(), reason, "write " + deeper);
  const std::string of = !plugin_.empty() ? plugin_ : owner();
  throw Error(entry.place.text(), reason + (listed && !(path_.empty() && plugin_.empty()) ? " of " + of : ""), hint);
}

std::string MapReader::path_to(const std::string& key) const {
  for (const ResolveNotes::Origin& one : notes_.origins) {
    const auto at = one.path.find("." + key);
    const auto end = at + 1 + key.size();
    if (at != std::string::npos && (end == one.path.size() || one.path[end] == '.')) return one.path.substr(0, end);
  }
  return "";
}

void MapReader::miss(const std::string& name, Error missing) {
  for (const Tree::Entry& entry : input_.entries) {
    if (is_known(entry.key) || (nearest(entry.key, {name}).empty() && !is_below_one_of(entry.key, {name}))) continue;
    refuse_unknown(entry, {name});
  }
  if (!notes_.missing) notes_.missing = std::move(missing);
}

}  // namespace palpate
