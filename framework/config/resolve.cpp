// SPDX-License-Identifier: MIT
#include "config/resolve.hpp"

#include "config/map_reader.hpp"
#include "config/quantity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace palpate {
namespace {

/// The value of a key that the config lacks.
const Tree kNothing;

/// Returns the path of a file that is named at the source location `place`: see Field::names_file().
std::string found_from(const SourceLocation& place, const std::string& file) {
  namespace fs = std::filesystem;
  constexpr int kMostLevels =
      6;  // number of levels from the config of a job up to the folder in which the sweep was started
  std::error_code none;
  const bool is_in_file = place.file != nullptr && place.line > 0;  // false on a command line
  if (file.empty() || !is_in_file || fs::path(file).is_absolute() || fs::exists(file, none)) return file;
  fs::path folder = (fs::current_path() / *place.file).lexically_normal();
  for (int level = 0; level < kMostLevels && folder.has_relative_path(); ++level) {
    folder = folder.parent_path();
    // Links are not followed, because a record from another user must not lead to other files.
    if (fs::is_regular_file(fs::symlink_status(folder / file, none))) return (folder / file).string();
  }
  return file;
}

bool is_row(const Tree& tree, std::size_t values) {
  return tree.kind == Tree::Kind::list && tree.items.size() == values;
}

/// Reads one map of a config and writes its resolved form. Nested maps have their own resolver.
class Resolver final : public MapReader {
 public:
  Resolver(const Tree& input, std::string path, const PluginSource& plugins, ResolveNotes& notes, ParentContext around)
      : MapReader(input, std::move(path), notes, std::move(around)), plugins_(plugins) {}

  void real(double& value, const Field& field) override {
    if (const Tree* tree = claim(field)) value = quantity(*tree, field);
    write(field, write_quantity(value, field.unit));
  }

  void real(std::optional<double>& value, const Field& field) override {
    if (const Tree* tree = claim(field, MissingFieldMeaning::absent))
      value = is_none(*tree) ? std::nullopt : std::optional(quantity(*tree, field));
    if (!value) return note_absent(field);
    write(field, write_quantity(*value, field.unit));
  }

  void reals(double* values, std::size_t count, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      if (!is_row(*tree, count))
        refuse(*tree, field, fmt::format("expects a list of {} values", count),
               "write them in brackets, with commas between them");
      for (std::size_t i = 0; i < count; ++i) values[i] = quantity(tree->items[i], field);
    }
    write(field, write_quantities(values, count, field.unit), id_text(values, count, field.unit));
  }

  void table(std::vector<double>& values, std::size_t columns, const Field& field) override {
    if (const Tree* tree = claim_list(field)) {
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
    write(field, write_table(values, columns, field.unit), "");
    if (!note_count(field, values.size() / columns)) return;
    for (std::size_t row = 0; row * columns < values.size(); ++row)
      identify(fmt::format("{}.{}", id_name(field), row), id_text(&values[row * columns], columns, field.unit));
  }

  void integer(std::int64_t& value, const Field& field) override {
    if (const Tree* tree = claim(field)) value = whole(*tree, field);
    write(field, std::to_string(value));
  }

  void integer(std::optional<std::int64_t>& value, const Field& field) override {
    if (const Tree* tree = claim(field, MissingFieldMeaning::absent))
      value = is_none(*tree) ? std::nullopt : std::optional(whole(*tree, field));
    if (!value) return note_absent(field);
    write(field, std::to_string(*value));
  }

  void flag(bool& value, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      value = tree->is_scalar() && tree->text == "true";
      if (!value && !(tree->is_scalar() && tree->text == "false"))
        refuse(*tree, field, shown(*tree) + " is not a truth value", "write true or false");
    }
    write(field, value ? "true" : "false");
  }

  void text(std::string& value, const Field& field) override {
    if (const Tree* tree = claim(field)) {
      if (!tree->is_scalar()) refuse(*tree, field, "expects a text, not " + shown(*tree), "write a word or two");
      value = field.is_file ? found_from(tree->place, tree->text) : tree->text;
    }
    if (field.is_file) notes_.files.push_back(name(field));
    write(field, Tree::scalar(value, true), sized(value));
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
      if (is_type) note_type(*tree);
    }
    write(field, cases[index].name);
    if (cases[index].list) cases[index].list(*this);
  }

  void section(Options& options, const Field& field) override {
    output_.at(field.name) = read_group(options, claim(field, MissingFieldMeaning::of_its_parts), field, field.name);
  }

  void section(bool& present, Options& options, const Field& field) override {
    const Tree* tree = claim(field, MissingFieldMeaning::absent);
    if (tree != nullptr && tree->kind == Tree::Kind::null)
      throw Error(tree->place.text(), fmt::format("{} has no value", name(field)),
                  "write {} for its defaults, or none");
    if (tree != nullptr) present = !is_none(*tree);
    if (!present) return note_absent(field);
    if (enters(field)) identify(id_name(field), "{}");
    output_.at(field.name) = read_group(options, tree, field, field.name);
  }

  void sections(const ListAccess& access, const Field& field) override {
    Tree list = Tree::list();
    if (const Tree* tree = claim_list(field)) {
      check_list(*tree, field, "write [{...}, {...}]");
      list.place = tree->place;
      access.resize(tree->items.size());
      for (std::size_t i = 0; i < tree->items.size(); ++i)
        list.items.push_back(read_group(access.item(i), &tree->items[i], field, item_of(field, i)));
    }
    note_count(field, list.items.size());
    output_.at(field.name) = std::move(list);
  }

  void plugin(PluginChoice& choice, const Field& field) override {
    const Tree* tree = claim(field);
    if (*field.beside != '\0') known_.emplace_back(field.beside);
    if (tree != nullptr ? tree->kind == Tree::Kind::null : choice.type.empty())
      return miss(field.name,
                  {tree != nullptr ? tree->place.text() : where(), fmt::format("no {} is chosen", choice.kind),
                   fmt::format("write {}: {{type: ...}} or name a group under 'defaults'", field.name)});
    if (*field.beside == '\0') {
      output_.at(field.name) = read_plugin(choice, tree, field, field.name);
      return;
    }
    const Tree input = with_beside(tree, field);
    Tree written = read_plugin(choice, &input, field, field.name);
    const Tree* const found = written.find(field.beside);
    const Tree beside = found != nullptr ? *found : Tree();
    written.erase(field.beside);
    output_.at(field.name) = std::move(written);
    if (found != nullptr) output_.at(field.beside) = beside;
  }

  void plugin(std::optional<PluginChoice>& choice, const char* kind, const Field& field) override {
    if (find(field) == nullptr) {
      known_.emplace_back(field.name);
      if (complete_) choice.reset();
      return;
    }
    choice = PluginChoice{kind, {}, nullptr};
    plugin(*choice, field);
  }

  void plugins(std::vector<PluginChoice>& choices, const char* kind, const Field& field) override {
    const Tree* tree = claim_list(field);
    if (tree != nullptr) {
      check_list(*tree, field, "write [{type: ...}, {type: ...}]");
      choices.assign(tree->items.size(), PluginChoice{kind, {}, nullptr});
    }
    Tree list = Tree::list();
    if (tree != nullptr) list.place = tree->place;
    for (std::size_t i = 0; i < choices.size(); ++i) {
      const Tree* item = tree != nullptr ? &tree->items[i] : nullptr;
      list.items.push_back(read_plugin(choices[i], item, field, item_of(field, i)));
    }
    note_count(field, list.items.size());
    output_.at(field.name) = std::move(list);
  }

  void adopt(PluginChoice& choice, const Field& field) override {
    const Tree* const claimed = claim(field);
    if (claimed == nullptr) throw Error(*notes_.missing);  // if the type is missing, the other keys cannot be checked
    const Tree& type = *claimed;
    choice.type = name_of_plugin(type, choice.kind, name(field));
    note_type(type);
    write(field, choice.type);
    adopted_ = choice.kind + "/" + choice.type;
    Tree options = Tree::map();
    options.place = type.place;  // location for the plugin's own errors
    std::swap(output_.place, options.place);
    const std::size_t before = output_.entries.size();
    list_plugin(choice, type.place.text(), *this);
    options.entries.assign(output_.entries.begin() + static_cast<std::ptrdiff_t>(before), output_.entries.end());
    std::swap(output_.place, options.place);
    choice.options = std::make_shared<const Tree>(std::move(options));
  }

 private:
  /// Returns the options of the plugin at `field`, together with the value of its sibling key: see
  /// Field::with_beside().
  Tree with_beside(const Tree* tree, const Field& field) const {
    Tree out = tree != nullptr ? *tree : Tree::map();
    check_beside(out, field.name, field.beside);
    for (const Tree::Entry& entry : input_.entries) {
      if (entry.key == field.beside) out.entries.push_back(entry);
    }
    return out;
  }

  /// Reads nested options at `name` (see around()). `tree` is null if the config does not set them.
  Tree read_group(Options& options, const Tree* tree, const Field& field, const std::string& name) {
    Resolver inner(tree != nullptr ? *tree : kNothing, path_of(name) + ".", plugins_, notes_, around(field, name));
    options.list(inner);
    return inner.finish();
  }

  /// Returns the plugin name at `path`.
  static const std::string& name_of_plugin(const Tree& tree, const std::string& kind, const std::string& path) {
    if (tree.is_scalar()) return tree.text;
    throw Error(tree.place.text(), fmt::format("{} is not a name", path),
                fmt::format("'palpate plugins {}' lists the types", kind));
  }

  /// Passes the options of a plugin to `fields`. Errors about the plugin's library get the source location `place`.
  void list_plugin(const PluginChoice& choice, const std::string& place, Resolver& fields) {
    notes_.plugins.emplace(choice.kind, choice.type);
    fields.silent_ = plugins_.is_silent(choice.kind, choice.type);
    if (fields.silent_) return;
    try {
      plugins_.describe(choice.kind, choice.type, fields);
    } catch (const Error& trouble) {  // errors of the plugin source have no source location
      if (!trouble.where().empty()) throw;
      throw Error(place, trouble.reason(), trouble.hint(), trouble.kind());
    }
  }

  /// Returns the type of the plugin at `path`; null if the config leaves it at its default.
  static const Tree* type_of(const Tree& tree, const PluginChoice& choice, const std::string& path) {
    if (!tree.is_map())
      throw Error(tree.place.text(), fmt::format("{} is not a group of options", path), "write {type: ...}");
    const Tree* const type = tree.find("type");
    if (type != nullptr || !choice.type.empty()) return type;
    throw Error(tree.place.text(), fmt::format("{} has no type", path),
                fmt::format("'palpate plugins {}' lists the types", choice.kind));
  }

  /// Reads the plugin at `name` into `choice`. Returns its type and resolved options. A null `tree` means the default.
  Tree read_plugin(PluginChoice& choice, const Tree* tree, const Field& field, const std::string& name) {
    const std::string path = path_ + name;
    const Tree* const type = tree != nullptr ? type_of(*tree, choice, path) : nullptr;
    const std::string at = type != nullptr ? type->place.text() : where();
    if (type != nullptr) choice.type = name_of_plugin(*type, choice.kind, path + ".type");
    Resolver inner(tree != nullptr ? *tree : kNothing, path + ".", plugins_, notes_, around(field, name));
    inner.plugin_ = choice.kind + "/" + choice.type;
    inner.beside_ = field.beside;
    inner.above_ = path_;
    inner.id_above_ = id_path_;
    inner.known_.emplace_back("type");
    inner.note_type(type != nullptr ? *type : kNothing);  // options on lower layers that this type lacks are dropped
    if (inner.enters_id_) inner.identify(inner.id_path_ + "type", choice.type);
    // A missing option is reported at the location where the type is chosen, not in the group file.
    if (type != nullptr && type->place.file) inner.output_.place = type->place;
    notes_.origins.push_back({inner.path_ + "type", type != nullptr ? at : "default"});
    list_plugin(choice, at, inner);
    Tree options = inner.finish();
    if (type != nullptr) options.place = type->place;  // place of the plugin's own errors
    choice.options = std::make_shared<const Tree>(std::move(options));
    Tree written = Tree::map();
    written.at("type") = Tree::scalar(choice.type);
    if (type != nullptr) written.at("type").place = type->place;
    for (const Tree::Entry& entry : choice.options->entries) written.entries.push_back(entry);
    return written;
  }

  const PluginSource& plugins_;
};

}  // namespace

void check_beside(const Tree& group, const std::string& plugin, const std::string& option) {
  for (const Tree::Entry& entry : group.entries) {
    if (option.empty() || entry.key != option) continue;
    throw Error(entry.place.text(), fmt::format("unknown option '{}' of {}", option, plugin),
                fmt::format("write {}: {{...}} beside {}, not inside it", option, plugin));
  }
}

Tree resolve(Options& options, const Tree& input, const PluginSource& plugins, ResolveNotes& notes,
             const std::vector<std::string>& elsewhere) {
  Resolver resolver(input, "", plugins, notes, {input.place, {}, true, false});
  options.list(resolver);
  Tree out = resolver.finish(elsewhere);
  if (notes.missing) throw Error(*notes.missing);
  return out;
}

void fill(const Tree& resolved, const PluginSource& plugins, const std::string& path,
          const std::function<void(Fields&)>& describe) {
  ResolveNotes notes;
  Resolver resolver(resolved, path.empty() ? path : path + ".", plugins, notes, {resolved.place, {}, true, false});
  describe(resolver);
  if (notes.missing) throw Error(*notes.missing);
}

}  // namespace palpate
