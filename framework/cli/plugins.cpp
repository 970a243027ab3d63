// SPDX-License-Identifier: MIT
#include "cli/command_line.hpp"
#include "cli/display.hpp"
#include "cli/output.hpp"
#include "config/describe.hpp"
#include "experiment/experiment_options.hpp"
#include "record/json.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace palpate::cli {
namespace {

std::vector<FieldDescription> options_of(const PluginHost& host, const PluginListing& row) {
  std::vector<FieldDescription> out =
      describe_fields([&](Fields& fields) { host.describe(row.kind, row.name, fields); });
  const std::string beside = config_keys().beside(row.kind);
  for (FieldDescription& one : out) {
    if (!beside.empty() && one.name == beside)
      one.meaning += fmt::format("; written beside {}, not inside it", row.kind);
  }
  return out;
}

Tree row_tree(const PluginHost& host, const PluginListing& row) {
  const bool sound = row.trouble.empty();
  return Tree::map({{"kind", Tree::quote(row.kind)},
                    {"name", Tree::quote(row.name)},
                    {"summary", Tree::quote(row.summary)},
                    {"file", Tree::quote(row.file.string())},
                    {"trouble", sound ? Tree{} : Tree::quote(row.trouble)},
                    {"options", sound ? describe_tree(options_of(host, row)) : Tree::list()}});
}

void print_one(const PluginHost& host, const PluginListing& row) {
  print_out("{}/{}: {}\n{}\n", row.kind, row.name, row.summary, row.file.string());
  const std::vector<FieldDescription> options = options_of(host, row);
  print_text(options.empty() ? "  no options\n" : describe_text(options));
}

struct PluginsArguments {
  std::string plugin;  ///< KIND or KIND/NAME; "": all
  bool json = false;
};

int plugins(CommandEnvironment& program, const PluginsArguments& arguments) {
  const std::string& what = arguments.plugin;
  const auto slash = what.find('/');
  const std::string kind = what.substr(0, slash);
  const std::string name = slash == std::string::npos ? std::string() : what.substr(slash + 1);
  const std::vector<std::string> kinds = PluginHost::kinds();
  if (!kind.empty() && std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    throw Error("", fmt::format("there is no plugin kind '{}'", kind), suggestion(kind, kinds));
  const std::vector<PluginListing> rows = program.host.list(kind, name);
  // For a plugin that does not exist, describe() throws an error that suggests similar names.
  if (!name.empty() && rows.empty())
    describe_fields([&](Fields& fields) { program.host.describe(kind, name, fields); });

  const bool broken =
      std::any_of(rows.begin(), rows.end(), [](const PluginListing& row) { return !row.trouble.empty(); });
  if (arguments.json) {
    Tree list = Tree::list();
    for (const PluginListing& row : rows) list.items.push_back(row_tree(program.host, row));
    print_data(to_json(list));
  } else if (!name.empty() && !broken) {
    print_one(program.host, rows.front());
  } else {
    for (const PluginListing& row : rows) {
      if (row.trouble.empty()) print_out("{:<12} {:<19} {}\n", row.kind, row.name, row.summary);
    }
  }
  for (const PluginListing& row : rows) {
    if (!row.trouble.empty()) print_message(row.trouble + "\n");
  }
  return broken ? kFailed : kDone;
}

}  // namespace

void add_plugins(CommandLine& line) {
  auto [command, arguments] = line.add<PluginsArguments>(
      "plugins", "List all plugins, or show the options of one plugin", plugins,
      [](NeededParts& needs, const PluginsArguments& given) { needs.listing(given.plugin); });
  command.argument("PLUGIN", arguments.plugin, "KIND[/NAME]",
                   "plugin kind, for example kernel, or plugin, for example kernel/rbf");
  command.flag("--json", arguments.json, "print the list as JSON");
  command.examples({"palpate plugins", "palpate plugins kernel/rbf"});
}

}  // namespace palpate::cli
