// SPDX-License-Identifier: MIT
#include "config/resolve.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/replace.hpp>

#include <algorithm>
#include <array>
#include <limits>

namespace palpate {
namespace {

/// What stands for what a config does not say.
const Tree kNothing;

/// Reads one map and writes its resolved twin. Nested groups get a resolver of their own.
class Resolver final : public Fields {
 public:
  /// Where `input` is null every field has its default, and where it has no place errors name that of `parent`. `path`
  /// is "" at the top, else it ends in a dot.
  Resolver(const Tree& input, std::string path, const PluginSource& plugins, ResolveNotes& notes, const Place& parent)
      : input_(input), path_(std::move(path)), plugins_(plugins), notes_(notes), output_(Tree::map()) {
    output_.place = input.place.file ? input.place : parent;
    if (!input.is_map() && input.kind != Tree::Kind::null) {
      throw Error(input.place.text(), fmt::format("{} is not a group of options", owner()),
                  fmt::format("write {{key: value, ...}}{}", path_.empty() ? "" : " or " + path_ + "KEY=VALUE"));
    }
  }

  /// Refuses keys that no field has claimed. `elsewhere`: see resolve().
  Tree finish(const std::vector<std::string>& elsewhere = {}) {
    for (const Tree::Entry& entry : input_.entries) {
      if (silent_ || is_known(entry.key)) continue;
      Layer highest = entry.value.layer;  // of the last who had a say in it
      for_all(entry.value, [&](const Tree& one) { highest = std::max(highest, one.layer); });
      if (highest < type_layer_) {
        notes_.dropped.push_back({path_ + entry.key, entry.value.place.text()});
        continue;
      }
      known_.insert(known_.end(), elsewhere.begin(), elsewhere.end());
      refuse_unknown(entry, known_);
    }
    return std::move(output_);
  }

  void gone(const char* key, const char* instead) override {
    if (silent_) return;
    for (const Tree::Entry& entry : input_.entries) {
      if (entry.key == key && entry.value.layer >= type_layer_)
        throw Error(entry.place.text(), fmt::format("option '{}' is no more", key), instead);
    }
  }

  void real(double& value, const Field& field) override {
    if (const Tree* tree = claim(field)) value = quantity(*tree, field);
    write(field, Tree::scalar(write_quantity(value, field.unit)));
  }

  void real(std::optional<double>& value, const Field& field) override {
    if (const Tree* tree = claim(field); tree != nullptr && !is_none(*tree)) value = quantity(*tree, field);
    if (value) write(field, Tree::scalar(write_quantity(*value, field.unit)));
  }

  void reals(double* values, std::size_t count, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      if (!is_row(*tree, count)) {
        refuse(*tree, field, fmt::format("expects a list of {} values", count),
               "write them in brackets, with commas between them");
      }
      for (std::size_t i = 0; i < count; ++i) values[i] = quantity(tree->items[i], field);
    }
    write(field, write_quantities(values, count, field.unit));
  }

  void table(std::vector<double>& values, std::size_t columns, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      const auto check = [&](const Tree& at, bool is_sound) {
        if (is_sound) return;
        refuse(at, field, fmt::format("expects a list of rows of {} values", columns),
               "write [[1 cm, 2 cm], [3 cm, 4 cm]] with the values and units that it needs");
      };
      check(*tree, tree->kind == Tree::Kind::list);
      values.clear();
      for (const Tree& row : tree->items) {
        check(row, is_row(row, columns));
        for (const Tree& item : row.items) values.push_back(quantity(item, field));
      }
    }
    write(field, write_table(values, columns, field.unit));
  }

  void integer(std::int64_t& value, const Field& field) override {
    if (const Tree* tree = claim(field)) value = whole(*tree, field);
    write(field, Tree::scalar(std::to_string(value)));
  }

  void integer(std::optional<std::int64_t>& value, const Field& field) override {
    if (const Tree* tree = claim(field); tree != nullptr && !is_none(*tree)) value = whole(*tree, field);
    if (value) write(field, Tree::scalar(std::to_string(*value)));
  }

  void flag(bool& value, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      value = tree->is_scalar() && tree->text == "true";
      if (!value && !(tree->is_scalar() && tree->text == "false"))
        refuse(*tree, field, shown(*tree) + " is not a truth value", "write true or false");
    }
    write(field, Tree::scalar(value ? "true" : "false"));
  }

  void text(std::string& value, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      if (!tree->is_scalar()) refuse(*tree, field, "expects a text, not " + shown(*tree), "write a word or two");
      value = tree->text;
    }
    write(field, Tree::scalar(value, true));
  }

  void choice(std::size_t& index, const Field& field, const std::vector<Case>& cases) override {
    if (const Tree* tree = claim(field)) {
      std::vector<std::string> names;
      for (const Case& one : cases) names.emplace_back(one.name);
      if (!tree->is_scalar()) refuse(*tree, field, shown(*tree) + " is not a name", suggestion("", names));
      const auto found = std::find(names.begin(), names.end(), tree->text);
      if (found == names.end())
        refuse(*tree, field, fmt::format("unknown value '{}'", tree->text), suggestion(tree->text, names));
      index = static_cast<std::size_t>(found - names.begin());
      const bool is_type = std::any_of(cases.begin(), cases.end(), [](const Case& one) { return bool(one.list); });
      if (is_type) type_layer_ = std::max(type_layer_, tree->layer);
    }
    if (index > 0 || !field.is_left_out) write(field, Tree::scalar(cases[index].name));
    if (cases[index].list) cases[index].list(*this);
  }

  void section(Options& options, const Field& field) override {
    output_.at(field.name) = read_group(options, claim(field), name(field));
  }

  void section(bool& present, Options& options, const Field& field) override {
    const Tree* tree = claim(field);
    if (tree != nullptr && tree->kind == Tree::Kind::null) {
      throw Error(tree->place.text(), fmt::format("{} has no value", name(field)),
                  "write {} for its defaults, or none");
    }
    if (tree != nullptr) present = !is_none(*tree);
    if (present) output_.at(field.name) = read_group(options, tree, name(field));
  }

  void sections(const ListAccess& access, const Field& field) override {
    Tree list = Tree::list();
    if (const Tree* tree = claim(field)) {
      check_list(*tree, field, "write [{...}, {...}]");
      list.place = tree->place;
      access.resize(tree->items.size());
      for (std::size_t i = 0; i < tree->items.size(); ++i)
        list.items.push_back(read_group(access.item(i), &tree->items[i], fmt::format("{}.{}", name(field), i)));
    }
    output_.at(field.name) = std::move(list);
  }

  void plugin(PluginChoice& choice, const Field& field) override {
    const Tree* tree = claim(field);
    if (tree != nullptr ? tree->kind == Tree::Kind::null : choice.type.empty()) {
      refuse_misspelt(field.name);
      throw Error(tree != nullptr ? tree->place.text() : where(), fmt::format("no {} is chosen", choice.kind),
                  fmt::format("write {}: {{type: ...}} or name a group under 'defaults'", field.name));
    }
    output_.at(field.name) = read_plugin(choice, tree, name(field));
  }

  void plugin(std::optional<PluginChoice>& choice, const char* kind, const Field& field) override {
    if (input_.find(field.name) == nullptr) {
      known_.emplace_back(field.name);
      return;
    }
    choice = PluginChoice{kind, {}, nullptr};
    plugin(*choice, field);
  }

  void plugins(std::vector<PluginChoice>& choices, const char* kind, const Field& field) override {
    const Tree* tree = claim(field);
    if (tree != nullptr) {
      check_list(*tree, field, "write [{type: ...}, {type: ...}]");
      choices.assign(tree->items.size(), PluginChoice{kind, {}, nullptr});
    }
    Tree list = Tree::list();
    if (tree != nullptr) list.place = tree->place;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const Tree* item = tree != nullptr ? &tree->items[i] : nullptr;
      list.items.push_back(read_plugin(choices[i], item, fmt::format("{}.{}", name(field), i)));
    }
    output_.at(field.name) = std::move(list);
  }

  void adopt(PluginChoice& choice, const Field& field) override {
    const Tree& type = *claim(field);
    choice.type = name_of_plugin(type, choice.kind, name(field));
    type_layer_ = std::max(type_layer_, type.layer);
    write(field, Tree::scalar(choice.type));
    adopted_ = choice.kind + "/" + choice.type;
    Tree options = Tree::map();
    options.place = type.place;  // where the plugin's own complaints will point, and what it lacks is missing
    std::swap(output_.place, options.place);
    const std::size_t before = output_.entries.size();
    list_plugin(choice, type.place.text(), *this);
    options.entries.assign(output_.entries.begin() + static_cast<std::ptrdiff_t>(before), output_.entries.end());
    std::swap(output_.place, options.place);
    choice.options = std::make_shared<const Tree>(std::move(options));
  }

  void require(bool holds, const char* field, const std::string& reason) override {
    if (holds) return;
    const Place place = input_.place_of(field);
    throw Error(place.file ? place.text() : where(), fmt::format("{}{}: {}", path_, field, reason));
  }

 private:
  /// The name by which messages call a field: its whole path.
  std::string name(const Field& field) const { return path_ + field.name; }
  std::string owner() const { return path_.empty() ? "the config" : path_.substr(0, path_.size() - 1); }
  std::string where() const { return output_.place.text(); }
  bool is_known(const std::string& key) const { return std::find(known_.begin(), known_.end(), key) != known_.end(); }

  static bool is_none(const Tree& tree) { return tree.is_scalar() && !tree.quoted && tree.text == "none"; }
  static bool is_row(const Tree& tree, std::size_t values) {
    return tree.kind == Tree::Kind::list && tree.items.size() == values;
  }
  static std::string shown(const Tree& tree) {
    constexpr std::array kKinds{"nothing", "a value", "a list", "a map"};
    return tree.is_scalar() ? "'" + tree.text + "'" : kKinds[static_cast<std::size_t>(tree.kind)];
  }

  [[noreturn]] void refuse(const Tree& at, const Field& field, const std::string& reason,
                           const std::string& hint) const {
    throw Error(at.place.text(), fmt::format("{}: {}", name(field), reason), hint);
  }

  void check_list(const Tree& tree, const Field& field, const char* hint) const {
    if (tree.kind != Tree::Kind::list) refuse(tree, field, "expects a list", hint);
  }

  /// Finds the field's value and remembers that the field exists. Null when the config does not say it.
  const Tree* claim(const Field& field) {
    if (!adopted_.empty() && is_known(field.name)) {
      throw Error(where(), fmt::format("{} has an option '{}', and so has {}", adopted_, field.name, owner()),
                  "the plugin needs another name for it");
    }
    known_.emplace_back(field.name);
    const Tree* tree = input_.find(field.name);
    if (tree == nullptr && field.required) {
      refuse_misspelt(field.name);
      throw Error(where(), fmt::format("'{}' is missing", name(field)), field.meaning);
    }
    return tree;
  }

  /// `known`: what it may have been meant for.
  [[noreturn]] void refuse_unknown(const Tree::Entry& entry, const std::vector<std::string>& known) const {
    const std::string reason = fmt::format("unknown option '{}'", entry.key);
    if (is_below_one_of(entry.key, known)) throw Error(entry.place.text(), reason, "write " + nested(entry));
    const std::string hint = suggestion(entry.key, known);
    // A list of all that is known says little without the name of what knows it.
    const bool listed = hint.rfind("known: ", 0) == 0;
    const std::string of = !plugin_.empty() ? plugin_ : owner();
    throw Error(entry.place.text(), reason + (listed && !(path_.empty() && plugin_.empty()) ? " of " + of : ""), hint);
  }

  /// Whether a key is a dotted path, as the command line takes them, that begins with a known option.
  static bool is_below_one_of(const std::string& key, const std::vector<std::string>& known) {
    const auto dot = key.find('.');
    return dot != std::string::npos && std::find(known.begin(), known.end(), key.substr(0, dot)) != known.end();
  }

  /// What a dotted key stands for, as a file has it: `weight: {clip: yes}`.
  static std::string nested(const Tree::Entry& entry) {
    const auto groups = std::count(entry.key.begin(), entry.key.end(), '.');
    constexpr std::size_t kShort = 40;
    const std::string& text = entry.value.text;
    const bool short_value = entry.value.is_scalar() && text.size() < kShort && text.find('\n') == std::string::npos;
    return boost::replace_all_copy(entry.key, ".", ": {") + ": " + (short_value ? text : "...") +
           std::string(static_cast<std::size_t>(groups), '}');
  }

  /// Before complaining that `missing` is missing: perhaps it is there under a name that is nearly right.
  void refuse_misspelt(const std::string& missing) const {
    for (const Tree::Entry& entry : input_.entries) {
      if (is_known(entry.key) || (nearest(entry.key, {missing}).empty() && !is_below_one_of(entry.key, {missing})))
        continue;
      refuse_unknown(entry, {missing});
    }
  }

  void write(const Field& field, Tree value) {
    const Tree* tree = input_.find(field.name);
    notes_.origins.push_back({path_ + field.name, tree != nullptr ? tree->place.text() : "default"});
    if (tree != nullptr) value.place = tree->place;
    output_.at(field.name) = std::move(value);
  }

  double quantity(const Tree& tree, const Field& field) const {
    return checked(read_quantity(tree, name(field), field.unit), tree, field);
  }

  double checked(double value, const Tree& tree, const Field& field) const {
    const bool low = field.open_below ? !(value > field.least) : value < field.least;
    if (!low && !(value > field.most)) return value;
    const char* const bound = !low ? "at most" : field.open_below ? "above" : "at least";
    refuse(tree, field, tree.text + " is out of range",
           fmt::format("it must be {} {}", bound, write_quantity(low ? field.least : field.most, field.unit)));
  }

  std::int64_t whole(const Tree& tree, const Field& field) const {
    const std::int64_t value = read_integer(tree, name(field));
    checked(static_cast<double>(value), tree, field);
    return value;
  }

  /// Nested options; `tree` is null where the config does not say them.
  Tree read_group(Options& options, const Tree* tree, const std::string& path) {
    Resolver inner(tree != nullptr ? *tree : kNothing, path + ".", plugins_, notes_, output_.place);
    options.list(inner);
    return inner.finish();
  }

  /// What stands at `path` to name a plugin.
  static const std::string& name_of_plugin(const Tree& tree, const std::string& kind, const std::string& path) {
    if (tree.is_scalar()) return tree.text;
    throw Error(tree.place.text(), fmt::format("{} is not a name", path),
                fmt::format("'palpate plugins {}' lists the types", kind));
  }

  /// Lists the plugin's options to `fields`; trouble with its library is told at `place`.
  void list_plugin(const PluginChoice& choice, const std::string& place, Resolver& fields) {
    notes_.plugins.emplace(choice.kind, choice.type);
    fields.silent_ = plugins_.is_silent(choice.kind, choice.type);
    if (fields.silent_) return;
    try {
      plugins_.describe(choice.kind, choice.type, fields);
    } catch (const Error& trouble) {  // thrown on: a source of plugins knows no places
      if (!trouble.where().empty()) throw;
      throw Error(place, trouble.reason(), trouble.hint(), trouble.kind());
    }
  }

  /// What names the type of the plugin at `path`.
  static const Tree& type_of(const Tree& tree, const std::string& kind, const std::string& path) {
    if (!tree.is_map())
      throw Error(tree.place.text(), fmt::format("{} is not a group of options", path), "write {type: ...}");
    if (const Tree* type = tree.find("type")) return *type;
    throw Error(tree.place.text(), fmt::format("{} has no type", path),
                fmt::format("'palpate plugins {}' lists the types", kind));
  }

  /// Fills `choice`; returns what goes into the resolved config. `tree` is null where the config does not say the
  /// plugin and `choice` names the default.
  Tree read_plugin(PluginChoice& choice, const Tree* tree, const std::string& path) {
    const Tree* const type = tree != nullptr ? &type_of(*tree, choice.kind, path) : nullptr;
    const std::string at = type != nullptr ? type->place.text() : where();
    if (type != nullptr) choice.type = name_of_plugin(*type, choice.kind, path + ".type");
    Resolver inner(tree != nullptr ? *tree : kNothing, path + ".", plugins_, notes_, output_.place);
    inner.plugin_ = choice.kind + "/" + choice.type;
    inner.known_.emplace_back("type");
    inner.type_layer_ = (type != nullptr ? *type : kNothing).layer;  // options older than it may be dropped
    // What the type needs is missing where it was chosen, not in the group file that it was laid over.
    if (type != nullptr && type->place.file) inner.output_.place = type->place;
    notes_.origins.push_back({inner.path_ + "type", type != nullptr ? at : "default"});
    list_plugin(choice, at, inner);
    Tree options = inner.finish();
    if (type != nullptr) options.place = type->place;  // where the plugin's own complaints will point
    choice.options = std::make_shared<const Tree>(std::move(options));
    Tree written = Tree::map();
    written.at("type") = Tree::scalar(choice.type);
    if (type != nullptr) written.at("type").place = type->place;
    for (const Tree::Entry& entry : choice.options->entries) written.entries.push_back(entry);
    return written;
  }

  const Tree& input_;
  std::string path_;
  std::string plugin_;   ///< whose options these are; "" for none
  bool silent_ = false;  ///< a plugin among these is: any key may be its
  std::string adopted_;  ///< whose options stand among them; "" for none
  const PluginSource& plugins_;
  ResolveNotes& notes_;
  Tree output_;
  std::vector<std::string> known_;
  Layer type_layer_ = std::numeric_limits<Layer>::min();
};

}  // namespace

Tree resolve(Options& options, const Tree& input, const PluginSource& plugins, ResolveNotes& notes,
             const std::vector<std::string>& elsewhere) {
  Resolver resolver(input, "", plugins, notes, input.place);
  options.list(resolver);
  return resolver.finish(elsewhere);
}

void fill(const Tree& resolved, const PluginSource& plugins, const std::string& path,
          const std::function<void(Fields&)>& describe) {
  ResolveNotes notes;
  Resolver resolver(resolved, path.empty() ? path : path + ".", plugins, notes, resolved.place);
  describe(resolver);
}

}  // namespace palpate
