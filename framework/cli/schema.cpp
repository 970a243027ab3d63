// SPDX-License-Identifier: MIT
#include "cli/command_line.hpp"
#include "cli/output.hpp"
#include "config/describe.hpp"
#include "experiment/experiment_options.hpp"
#include "record/expectation.hpp"
#include "record/fields.hpp"
#include "record/json.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <set>
#include <tuple>

namespace palpate::cli {
namespace {

/// Returns the usable plugins of a kind with their options. Broken plugins are left out; `palpate plugins` reports
/// them.
std::vector<FieldDescription::CaseDescription> plugins_of(const PluginHost& host, const std::string& kind) {
  std::vector<FieldDescription::CaseDescription> out;
  for (const PluginListing& row : host.list(kind, "")) {
    if (!row.trouble.empty()) continue;
    out.push_back(
        {row.name, row.summary, describe_fields([&](Fields& fields) { host.describe(kind, row.name, fields); })});
  }
  return out;
}

Tree of_type(const char* type, const char* description = nullptr) {
  if (description == nullptr) return Tree::map({{"type", Tree::quote(type)}});
  return Tree::map({{"description", Tree::quote(description)}, {"type", Tree::quote(type)}});
}

Tree any_of(std::vector<Tree> schemas) { return Tree::map({{"anyOf", Tree::list(std::move(schemas))}}); }

/// Returns the schema of a plugin kind. A value is either the name of a plugin, or the options of one of the plugins.
/// The type is not required, because a group in `defaults` may set it. The options in `beside` are left out, because
/// their keys are next to the key of the plugin (Field::with_beside()).
Tree kind_schema(const PluginHost& host, const std::string& kind, const std::set<std::string>& beside) {
  std::vector<Tree> any{of_type("string")};
  any.front().at("description") = Tree::quote("name of a group file or of a plugin");
  for (const FieldDescription::CaseDescription& one : plugins_of(host, kind)) {
    Tree plugin = schema_of(one.fields);
    for (const std::string& option : beside) plugin.at("properties").erase(option);
    plugin.at("title") = Tree::quote(kind + "/" + one.name);
    plugin.at("description") = Tree::quote(one.meaning);
    plugin.at("properties").at("type").at("const") = Tree::quote(one.name);
    any.push_back(std::move(plugin));
  }
  return any_of(std::move(any));
}

/// Returns the schema of a plugin option whose key is next to the key of the plugin (Field::with_beside()). A value is
/// either the name of a group file, or the options of one of the plugins.
Tree beside_schema(const PluginHost& host, const std::string& kind, const std::string& option) {
  std::vector<Tree> any{of_type("string")};
  any.front().at("description") = Tree::quote("name of a group file");
  std::set<std::string> seen;
  for (const FieldDescription::CaseDescription& one : plugins_of(host, kind)) {
    Tree plugin = schema_of(one.fields);
    Tree& properties = plugin.at("properties");
    const Tree* const schema = properties.find(option);
    if (schema != nullptr && seen.insert(schema->canonical()).second) any.push_back(*schema);
  }
  return any_of(std::move(any));
}

/// Fills the schema of `expect:`. A key is a field of the summary or a statistic of a field, such as
/// median(object_taps). A value is one comparison or a list of comparisons.
void expect_schema(Tree& expect) {
  std::string fields = kFailedRuns;
  for (const RecordField& field : summary_fields()) fields += "|" + field.name;
  // In this pattern, the dot in the name of a field matches any character, which is precise enough for an editor.
  const std::string keys = fmt::format("^(({0})|({1})\\(({0})\\))$", fields, fmt::join(statistic_names(), "|"));
  expect.at("type") = Tree::quote("object");
  expect.at("patternProperties").at(keys) = any_of({of_type("string"), of_type("boolean"), of_type("array")});
  expect.at("additionalProperties") = Tree::scalar("false");
  expect = any_of({of_type("string"), expect});
}

/// Fills the schema of `defaults:`, a list of maps with one group and its name, such as `kernel: rbf`.
void defaults_schema(Tree& defaults) {
  defaults.at("type") = Tree::quote("array");
  Tree& item = defaults.at("items") = of_type("object");
  item.at("additionalProperties") = of_type("string");
  item.at("minProperties") = Tree::scalar("1");
  item.at("maxProperties") = Tree::scalar("1");
}

/// Fills the schema of `sweep:`. Its blocks accept any keys.
void sweep_schema(Tree& sweep) {
  sweep.at("type") = Tree::quote("object");
  sweep.at("additionalProperties") = Tree::scalar("false");
  Tree& blocks = sweep.at("properties");
  blocks.at("grid") =
      of_type("object", "keys whose values are combined each with each: lists, range(0,10), logspace(1cm,5cm,8)");
  blocks.at("zip") = of_type("object", "keys whose lists have equal length and are combined item by item");
  blocks.at("list") = of_type("array", "list of maps from keys to values; the values of each map form a grid");
  blocks.at("list").at("items") = of_type("object");
  Tree& sobol = blocks.at("sobol") = of_type("object", "points of a Sobol sequence in continuous ranges");
  sobol.at("additionalProperties") = Tree::scalar("false");
  sobol.at("required") = Tree::list({Tree::quote("samples"), Tree::quote("keys")});
  Tree& samples = sobol.at("properties").at("samples") = of_type("integer", "number of points");
  samples.at("minimum") = Tree::scalar("1");
  samples.at("maximum") = Tree::scalar("100000");
  Tree& keys = sobol.at("properties").at("keys") =
      of_type("object", "keys with continuous ranges: uniform(0.1 mm, 1 mm), log_uniform(1 cm, 10 cm)");
  keys.at("additionalProperties") = of_type("string");
  const char* const condition = "condition on the combinations that are run: taps >= 12 and not kernel == rbf";
  Tree several = of_type("array", "list of conditions, all of which must hold");
  several.at("items") = of_type("string");
  blocks.at("where") = any_of({of_type("string", condition), several});
}

/// Fills the schema of `tune:`.
void tune_schema(Tree& tune) {
  tune.at("type") = Tree::quote("object");
  tune.at("additionalProperties") = Tree::scalar("false");
  Tree& properties = tune.at("properties");
  properties.at("keys") =
      of_type("object", "keys whose values are searched: lists, uniform(1 cm, 5 cm), log_uniform(...)");
  properties.at("jobs") = of_type("integer", "budget: number of runs");
  properties.at("fresh") = of_type("integer", "number of seeds for the comparison with the config as it stands");
  properties.at("over") = of_type("array", "scenes that alternate from seed to seed");
  for (const auto& [name, meaning] : {std::pair("metric", "field of the summary whose mean over the seeds decides"),
                                      std::pair("cost", "second field; the race then keeps the Pareto front"),
                                      std::pair("time", "budget in wall time, for example 10 min"),
                                      std::pair("within", "difference to the best setting at which the race may end")})
    properties.at(name) = of_type("string", meaning);
  properties.at("where") = any_of({of_type("string"), of_type("array")});
}

/// Fills the schema of `compare:`.
void compare_schema(Tree& compare) {
  compare.at("type") = Tree::quote("object");
  compare.at("additionalProperties") = Tree::scalar("false");
  compare.at("required") = Tree::list({Tree::quote("metric"), Tree::quote("by"), Tree::quote("seeds")});
  Tree& properties = compare.at("properties");
  for (const auto& [name, type, other, meaning] :
       {std::tuple("metric", "string", "array", "column of results.csv, or a list, of which the first decides"),
        std::tuple("by", "string", "array", "swept key, or a list of keys, whose values define the groups"),
        std::tuple("baseline", "string", "number", "group with which the others are compared"),
        std::tuple("where", "string", "string", "condition on the jobs, as in --where of palpate compare"),
        std::tuple("seeds", "integer", "integer", "number of seeds of each group"),
        std::tuple("difference", "string", "number", "smallest difference of the first metric that matters")})
    properties.at(name) = any_of({of_type(type, meaning), of_type(other)});
  compare = any_of({of_type("string", "none: no plan"), compare});
}

struct SchemaArguments {};

int schema(CommandEnvironment& program, const SchemaArguments&) {
  ExperimentOptions options;
  const std::vector<FieldDescription> fields =
      describe_fields([&](Fields& visitor) { options.list(visitor); },
                      [&](const std::string& kind) { return plugins_of(program.host, kind); });
  Tree out = schema_of(fields);
  Tree& properties = out.at("properties");
  std::map<std::string, std::set<std::string>> beside;
  for (const FieldDescription& field : fields) {
    if (field.beside.empty()) continue;
    beside[field.kind].insert(field.beside);
    Tree& option = properties.at(field.beside) = beside_schema(program.host, field.kind, field.beside);
    option.at("description") = Tree::quote(describe_beside(field).meaning);
  }
  for (const Field& field : keys_beside_options()) properties.at(field.name) = of_type("string", field.meaning);
  defaults_schema(properties.at("defaults"));
  sweep_schema(properties.at("sweep"));
  tune_schema(properties.at("tune"));
  compare_schema(properties.at("compare"));
  expect_schema(properties.at("expect"));
  Tree& definitions = out.at("definitions") = Tree::map();
  for (const std::string& kind : PluginHost::kinds())
    definitions.at(kind) = kind_schema(program.host, kind, beside[kind]);
  out.at("$schema") = Tree::quote("http://json-schema.org/draft-07/schema#");
  out.at("title") = Tree::quote("palpate experiment");
  print_data(to_json(out));
  return kDone;
}

}  // namespace

void add_schema(CommandLine& line) {
  const Command command =
      line.add<SchemaArguments>("schema", "Print the JSON Schema of config files, for completion and checks in editors",
                                schema, [](NeededParts& needs, const SchemaArguments&) { needs.every_plugin(); })
          .first;
  command.examples({"palpate schema > palpate.schema.json", "palpate schema | grep length_scale"});
}

}  // namespace palpate::cli
