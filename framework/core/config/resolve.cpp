// SPDX-License-Identifier: MIT
#include "config/resolve.hpp"

#include "config/quantity.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

/// Reads one map and writes its resolved twin. Nested groups get a resolver of their own.
class Resolver final : public Fields {
 public:
  /// `input` may be null: then every field has its default, and errors name the place of `parent`. `path` is "" at
  /// the top, else it ends in a dot.
  Resolver(const Tree* input, std::string path, const PluginSource& plugins, ResolveNotes& notes, const Place& parent)
      : input_(input), path_(std::move(path)), plugins_(plugins), notes_(notes), output_(Tree::map()) {
    output_.place = input_ != nullptr ? input_->place : parent;
    if (input_ != nullptr && input_->kind != Tree::Kind::map && input_->kind != Tree::Kind::null) {
      throw Error(input_->place.text(), fmt::format("{} is not a group of options", owner()),
                  fmt::format("write {{key: value, ...}}{}", path_.empty() ? "" : " or " + path_ + "KEY=VALUE"));
    }
  }

  /// The options of `plugin`: `type` was read by the caller, and options older than it may be dropped.
  void set_type(const Tree& type, std::string plugin) {
    known_.emplace_back("type");
    plugin_ = std::move(plugin);
    type_layer_ = std::max(type_layer_, type.layer);
    // What the type needs is missing where it was chosen, not in the group file that it was laid over.
    if (type.place.file) output_.place = type.place;
  }

  /// Refuses keys that no field has claimed. `elsewhere`: see resolve().
  Tree finish(const std::vector<std::string>& elsewhere = {}) {
    if (input_ != nullptr && !silent_) {
      for (const Tree::Entry& entry : input_->entries) {
        if (std::find(known_.begin(), known_.end(), entry.key) != known_.end()) continue;
        if (entry.value.highest_layer() < type_layer_) {
          notes_.dropped.push_back({path_ + entry.key, place_text(entry.value)});
          continue;
        }
        known_.insert(known_.end(), elsewhere.begin(), elsewhere.end());
        refuse_unknown(entry, known_);
      }
    }
    return std::move(output_);
  }

  void real(double& value, const Field& field) override {
    if (const Tree* tree = claim(field)) value = checked(read_quantity(*tree, name(field), field.unit), *tree, field);
    write(field, Tree::scalar(write_quantity(value, field.unit)));
  }

  void real(std::optional<double>& value, const Field& field) override {
    if (const Tree* tree = claim(field); tree != nullptr && !is_none(*tree)) {
      value = checked(read_quantity(*tree, name(field), field.unit), *tree, field);
    }
    if (value) write(field, Tree::scalar(write_quantity(*value, field.unit)));
  }

  void reals(double* values, std::size_t count, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      if (tree->kind != Tree::Kind::list || tree->items.size() != count) {
        throw Error(tree->place.text(), fmt::format("{}: expects a list of {} values", name(field), count),
                    "write them in brackets, with commas between them");
      }
      for (std::size_t i = 0; i < count; ++i) {
        const Tree& item = tree->items[i];
        values[i] = checked(read_quantity(item, name(field), field.unit), item, field);
      }
    }
    Tree list = Tree::list();
    for (std::size_t i = 0; i < count; ++i) list.items.push_back(Tree::scalar(write_quantity(values[i], field.unit)));
    write(field, std::move(list));
  }

  void table(std::vector<double>& values, std::size_t columns, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      const auto refuse = [&](const Tree& at) {
        throw Error(at.place.text(), fmt::format("{}: expects a list of rows of {} values", name(field), columns),
                    "write [[1 cm, 2 cm], [3 cm, 4 cm]] with the values and units that it needs");
      };
      if (tree->kind != Tree::Kind::list) refuse(*tree);
      values.clear();
      for (const Tree& row : tree->items) {
        if (row.kind != Tree::Kind::list || row.items.size() != columns) refuse(row);
        for (const Tree& item : row.items) {
          values.push_back(checked(read_quantity(item, name(field), field.unit), item, field));
        }
      }
    }
    Tree list = Tree::list();
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i % columns == 0) list.items.push_back(Tree::list());
      list.items.back().items.push_back(Tree::scalar(write_quantity(values[i], field.unit)));
    }
    write(field, std::move(list));
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
      const bool yes = tree->is_scalar() && tree->text == "true";
      if (!yes && !(tree->is_scalar() && tree->text == "false")) {
        throw Error(tree->place.text(), fmt::format("{}: {} is not a truth value", name(field), shown(*tree)),
                    "write true or false");
      }
      value = yes;
    }
    write(field, Tree::scalar(value ? "true" : "false"));
  }

  void text(std::string& value, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      if (!tree->is_scalar())
        throw Error(tree->place.text(), fmt::format("{}: expects a text, not {}", name(field), shown(*tree)),
                    "write a word or two");
      value = tree->text;
    }
    write(field, Tree::scalar(value, true));
  }

  void choice(std::size_t& index, const Field& field, const std::vector<Case>& cases) override {
    if (const Tree* tree = claim(field)) {
      const auto found = std::find_if(cases.begin(), cases.end(),
                                      [&](const Case& one) { return tree->is_scalar() && tree->text == one.name; });
      if (found == cases.end()) {
        std::vector<std::string> names;
        for (const Case& one : cases) names.emplace_back(one.name);
        if (tree->is_scalar()) {
          throw Error(tree->place.text(), fmt::format("{}: unknown value '{}'", name(field), tree->text),
                      suggestion(tree->text, names));
        }
        throw Error(tree->place.text(), fmt::format("{}: {} is not a name", name(field), shown(*tree)),
                    suggestion("", names));
      }
      index = static_cast<std::size_t>(found - cases.begin());
      const bool is_type = std::any_of(cases.begin(), cases.end(), [](const Case& one) { return bool(one.list); });
      if (is_type) type_layer_ = std::max(type_layer_, tree->layer);
    }
    write(field, Tree::scalar(cases[index].name));
    if (cases[index].list) cases[index].list(*this);
  }

  void section(Options& options, const Field& field) override {
    const Tree* tree = claim(field);
    Resolver inner(tree, path_ + field.name + ".", plugins_, notes_, output_.place);
    options.list(inner);
    output_.at(field.name) = inner.finish();
  }

  void section(bool& present, Options& options, const Field& field) override {
    const Tree* tree = claim(field);
    if (tree != nullptr && tree->kind == Tree::Kind::null) {
      throw Error(tree->place.text(), fmt::format("{} has no value", name(field)),
                  "write {} for its defaults, or none");
    }
    if (tree != nullptr) present = !is_none(*tree);
    if (!present) return;
    Resolver inner(tree, path_ + field.name + ".", plugins_, notes_, output_.place);
    options.list(inner);
    output_.at(field.name) = inner.finish();
  }

  void sections(const ListAccess& access, const Field& field) override {
    Tree list = Tree::list();
    if (const Tree* tree = claim(field)) {
      if (tree->kind != Tree::Kind::list) {
        throw Error(tree->place.text(), fmt::format("{}: expects a list", name(field)), "write [{...}, {...}]");
      }
      access.resize(tree->items.size());
      for (std::size_t i = 0; i < tree->items.size(); ++i) {
        Resolver inner(&tree->items[i], fmt::format("{}{}.{}.", path_, field.name, i), plugins_, notes_, output_.place);
        access.item(i).list(inner);
        list.items.push_back(inner.finish());
      }
    }
    output_.at(field.name) = std::move(list);
  }

  void plugin(PluginChoice& choice, const Field& field) override {
    const Tree* tree = claim(field);
    if (tree == nullptr && !choice.type.empty()) {
      output_.at(field.name) = read_default(choice, path_ + field.name);
      return;
    }
    if (tree == nullptr || tree->kind == Tree::Kind::null) {
      refuse_misspelt(field.name);
      throw Error(tree != nullptr ? tree->place.text() : where(), fmt::format("no {} is chosen", choice.kind),
                  fmt::format("write {}: {{type: ...}} or name a group under 'defaults'", field.name));
    }
    output_.at(field.name) = read_typed(choice, *tree, path_ + field.name);
  }

  void plugin(std::optional<PluginChoice>& choice, const char* kind, const Field& field) override {
    if (input_ == nullptr || input_->find(field.name) == nullptr) {
      known_.emplace_back(field.name);
      return;
    }
    choice = PluginChoice{kind, {}, nullptr};
    plugin(*choice, field);
  }

  void plugins(std::vector<PluginChoice>& choices, const char* kind, const Field& field) override {
    const Tree* tree = claim(field);
    if (tree != nullptr) {
      if (tree->kind != Tree::Kind::list) {
        throw Error(tree->place.text(), fmt::format("{}: expects a list", name(field)),
                    "write [{type: ...}, {type: ...}]");
      }
      choices.assign(tree->items.size(), PluginChoice{kind, {}, nullptr});
    }
    Tree list = Tree::list();
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const std::string path = fmt::format("{}{}.{}", path_, field.name, i);
      list.items.push_back(tree != nullptr ? read_typed(choices[i], tree->items[i], path)
                                           : read_default(choices[i], path));
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
    const Place place = input_ != nullptr ? input_->place_of(field) : Place{};
    throw Error(place.file ? place.text() : where(), fmt::format("{}{}: {}", path_, field, reason));
  }

 private:
  /// The name by which messages call a field: its whole path.
  std::string name(const Field& field) const { return path_ + field.name; }
  std::string owner() const { return path_.empty() ? "the config" : path_.substr(0, path_.size() - 1); }
  std::string where() const { return output_.place.text(); }

  static std::string place_text(const Tree& tree) { return tree.place.text(); }
  static bool is_none(const Tree& tree) { return tree.is_scalar() && !tree.quoted && tree.text == "none"; }
  static std::string shown(const Tree& tree) {
    switch (tree.kind) {
      case Tree::Kind::scalar:
        return "'" + tree.text + "'";
      case Tree::Kind::list:
        return "a list";
      case Tree::Kind::map:
        return "a map";
      case Tree::Kind::null:
        return "nothing";
    }
    return {};
  }

  /// Finds the field's value and remembers that the field exists. Null when the config does not say it.
  const Tree* claim(const Field& field) {
    if (!adopted_.empty() && std::find(known_.begin(), known_.end(), field.name) != known_.end()) {
      throw Error(where(), fmt::format("{} has an option '{}', and so has {}", adopted_, field.name, owner()),
                  "the plugin needs another name for it");
    }
    known_.emplace_back(field.name);
    const Tree* tree = input_ != nullptr ? input_->find(field.name) : nullptr;
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
    std::string out;
    std::string braces;
    for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 1) {
      end = entry.key.find('.', begin);
      out += entry.key.substr(begin, end == std::string::npos ? end : end - begin) + ": ";
      if (end == std::string::npos) continue;
      out += "{";
      braces += "}";
    }
    constexpr std::size_t kShort = 40;
    const std::string& text = entry.value.text;
    const bool short_value = entry.value.is_scalar() && text.size() < kShort && text.find('\n') == std::string::npos;
    return out + (short_value ? entry.value.text : "...") + braces;
  }

  /// Before complaining that `missing` is missing: perhaps it is there under a name that is nearly right.
  void refuse_misspelt(const std::string& missing) const {
    if (input_ == nullptr) return;
    for (const Tree::Entry& entry : input_->entries) {
      const bool known = std::find(known_.begin(), known_.end(), entry.key) != known_.end();
      if (known || (nearest(entry.key, {missing}).empty() && !is_below_one_of(entry.key, {missing}))) continue;
      refuse_unknown(entry, {missing});
    }
  }

  void write(const Field& field, Tree value) {
    const Tree* tree = input_ != nullptr ? input_->find(field.name) : nullptr;
    notes_.origins.push_back({path_ + field.name, tree != nullptr ? place_text(*tree) : "default"});
    if (tree != nullptr) value.place = tree->place;
    output_.at(field.name) = std::move(value);
  }

  double checked(double value, const Tree& tree, const Field& field) const {
    const bool low = field.open_below ? !(value > field.least) : value < field.least;
    if (low || value > field.most) {
      const std::string bound =
          low ? fmt::format("{} {}", field.open_below ? "above" : "at least", write_quantity(field.least, field.unit))
              : fmt::format("at most {}", write_quantity(field.most, field.unit));
      throw Error(tree.place.text(), fmt::format("{}: {} is out of range", name(field), tree.text),
                  fmt::format("it must be {}", bound));
    }
    return value;
  }

  std::int64_t whole(const Tree& tree, const Field& field) const {
    const std::int64_t value = read_integer(tree, name(field));
    checked(static_cast<double>(value), tree, field);
    return value;
  }

  /// A plugin that the config does not say.
  Tree read_default(PluginChoice& choice, const std::string& path) {
    static const Tree nothing = Tree::map();
    return read_plugin(choice, nothing, nullptr, path);
  }

  /// A plugin at `path` whose group must name its type.
  Tree read_typed(PluginChoice& choice, const Tree& tree, const std::string& path) {
    if (!tree.is_map()) {
      throw Error(tree.place.text(), fmt::format("{} is not a group of options", path), "write {type: ...}");
    }
    const Tree* type = tree.find("type");
    if (type == nullptr) {
      throw Error(tree.place.text(), fmt::format("{} has no type", path),
                  fmt::format("'palpate plugins {}' lists the types", choice.kind));
    }
    return read_plugin(choice, tree, type, path);
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
    } catch (const Error& trouble) {
      if (!trouble.where().empty()) throw;
      throw Error(place, trouble.reason(), trouble.hint(), trouble.kind());
    }
  }

  /// Fills `choice`; returns what goes into the resolved config.
  Tree read_plugin(PluginChoice& choice, const Tree& tree, const Tree* type, const std::string& path) {
    const std::string at = type != nullptr ? type->place.text() : where();
    if (type != nullptr) choice.type = name_of_plugin(*type, choice.kind, path + ".type");
    Resolver inner(&tree, path + ".", plugins_, notes_, output_.place);
    inner.set_type(type != nullptr ? *type : tree, choice.kind + "/" + choice.type);
    notes_.origins.push_back({inner.path_ + "type", type != nullptr ? at : "default"});
    list_plugin(choice, at, inner);
    Tree options = inner.finish();
    if (type != nullptr) options.place = type->place;  // where the plugin's own complaints will point
    choice.options = std::make_shared<const Tree>(std::move(options));
    Tree written = Tree::map();
    written.at("type") = Tree::scalar(choice.type);
    for (const Tree::Entry& entry : choice.options->entries) written.entries.push_back(entry);
    return written;
  }

  const Tree* input_;
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

Tree resolve(Options& options, const Tree& input, const PluginSource& plugins, ResolveNotes& notes) {
  return resolve(options, input, plugins, notes, {});
}

Tree resolve(Options& options, const Tree& input, const PluginSource& plugins, ResolveNotes& notes,
             const std::vector<std::string>& elsewhere) {
  Resolver resolver(&input, "", plugins, notes, input.place);
  options.list(resolver);
  return resolver.finish(elsewhere);
}

void fill(const Tree& resolved, const PluginSource& plugins, const std::string& path,
          const std::function<void(Fields&)>& describe) {
  ResolveNotes notes;
  Resolver resolver(&resolved, path.empty() ? path : path + ".", plugins, notes, resolved.place);
  describe(resolver);
}

}  // namespace palpate
