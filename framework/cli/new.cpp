// SPDX-License-Identifier: MIT
// `palpate new` copies the starter plugin of a kind from plugins/starters, under a new name.
#include "cli/command_line.hpp"
#include "cli/output.hpp"
#include "reading/read_file.hpp"

#include <palpate/acquisition.hpp>
#include <palpate/error.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/algorithm/string/replace.hpp>

#include <algorithm>
#include <cctype>
#include <fstream>

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

/// Returns the commands that build and run the plugin. If the program is in a build folder, the commands first install
/// it.
std::string next_steps(const Installation& installation, const std::string& name) {
  const bool installed = installation.whole == installation.program;
  const fs::path folder = installation.program.parent_path();
  const std::string prefix = installed ? folder.parent_path().string() : "$HOME/opt/palpate";
  std::string out = fmt::format("Build and run it:\n  cd {}\n", name);
  if (!installed) out += fmt::format("  cmake --install {} --prefix {}\n", folder.string(), prefix);
  return out + fmt::format(
                   "  cmake -B build -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH={0}\n"
                   "  cmake --build build\n"
                   "  export PALPATE_PLUGIN_PATH=$PWD/build/lib/palpate\n"
                   "  {0}/bin/palpate run {1}.yaml\n",
                   prefix, name);
}

struct NewArguments {
  std::string kind;
  std::string name;
  bool python = false;
};

/// Throws Error unless the plugin can be created.
void check_new(const CommandEnvironment& program, const NewArguments& arguments) {
  const auto& [kind, name, python] = arguments;
  const std::vector<std::string> kinds = PluginHost::kinds();
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    throw Error("", fmt::format("there is no plugin kind '{}'", kind), suggestion(kind, kinds));
  if (!is_name(name)) throw Error("", fmt::format("'{}' is not a valid name of a plugin", name), kNameHint);
  const std::vector<std::string> taken = program.host.names(kind);
  if (std::find(taken.begin(), taken.end(), name) != taken.end())
    throw Error("", fmt::format("there is a plugin {}/{} already", kind, name), "choose another name");
  if (python && kind != Acquisition::kKind)
    throw Error("command line", fmt::format("--python: a plugin of the kind {} cannot be a function of Python", kind),
                "leave --python out; only an acquisition can be one");
  if (python && (name.find('-') != std::string::npos || std::isdigit(static_cast<unsigned char>(name.front())) != 0))
    throw Error("", fmt::format("'{}' is not a valid name of a Python module", name),
                "use letters, digits and _, starting with a letter");
}

/// Copies the starter file `from` to the file `to` in the folder of the plugin, and fills in the names of plugin and
/// kind.
void copy_starter(const NewArguments& arguments, const fs::path& from, const std::string& to) {
  std::string text = read_bounded(from, kMostConfigBytes, FileOrigin::user).text;
  if (text.empty()) throw Error(from.string(), "cannot be read", "install palpate again");
  boost::replace_all(text, "KIND", arguments.kind);
  boost::replace_all(text, "starter", arguments.name);
  std::ofstream out(fs::path(arguments.name) / to);
  if (!(out << text).flush()) throw Error(arguments.name + "/" + to, "cannot be written", "check the free disk space");
}

void create_python(const Installation& installation, const NewArguments& arguments, const fs::path& starters) {
  for (const char* const file : {"starter.py", "test_starter.py", "starter.yaml"})
    copy_starter(arguments, starters / "python" / file,
                 boost::replace_all_copy(std::string(file), "starter", arguments.name));
  // The test needs its own copy of this module, because `palpate` does not start the test and cannot provide the
  // module.
  const std::string module = "palpate_acquisition.py";
  copy_starter(arguments, installation.plugins / "python" / module, module);
  const fs::path script = installation.configs.parent_path() / "palpate";
  std::error_code none;
  const std::string called = fs::equivalent("palpate", script, none) ? "./palpate"
                             : fs::is_regular_file(script, none)     ? script.string()
                                                                     : "palpate";
  print_out(
      "{0}/{0}.py is the acquisition, {0}/test_{0}.py its test, and {0}/{0}.yaml an experiment with it. Test and run "
      "it from this folder:\n  python3 {0}/test_{0}.py\n  {1} run {0}/{0}.yaml\n",
      arguments.name, called);
}

int new_plugin(CommandEnvironment& program, const NewArguments& arguments) {
  check_new(program, arguments);
  const auto& [kind, name, python] = arguments;
  const fs::path starters = program.installation.configs.parent_path() / "plugins" / "starters";
  std::error_code trouble;
  if (!fs::create_directory(name, trouble))
    throw Error(name, trouble ? "cannot be made: " + trouble.message() : "exists already", "choose another name");
  if (python) return create_python(program.installation, arguments, starters), kDone;
  copy_starter(arguments, starters / "CMakeLists.txt", "CMakeLists.txt");
  copy_starter(arguments, starters / kind / "starter.cpp", name + ".cpp");
  copy_starter(arguments, starters / kind / "starter.yaml", name + ".yaml");
  print_out("{0}/{0}.cpp is the plugin {1}/{0}, and {0}/{0}.yaml an experiment with it. {2}", name, kind,
            next_steps(program.installation, name));
  return kDone;
}

}  // namespace

void add_new(CommandLine& line) {
  auto [command, arguments] = line.add<NewArguments>("new", "Create a starter plugin and an experiment that uses it",
                                                     new_plugin, [](NeededParts&, const NewArguments&) {});
  command.argument("KIND", arguments.kind, "KIND",
                   fmt::format("kind of the plugin: {}", fmt::join(PluginHost::kinds(), ", ")), {required()});
  command.argument("NAME", arguments.name, "NAME", "name of the plugin; the new folder has the same name",
                   {required()});
  command.flag("--python", arguments.python,
               "create the acquisition as a Python function with a test; no compilation is needed");
  command.examples(
      {"palpate new kernel my_kernel", "palpate new acquisition curious", "palpate new acquisition --python curious"});
}

}  // namespace palpate::cli
