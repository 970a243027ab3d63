// SPDX-License-Identifier: MIT
#include "cli/rerun.hpp"

#include "bundle/repeat.hpp"
#include "cli/execute_run.hpp"
#include "cli/interrupt.hpp"
#include "cli/output.hpp"
#include "config/yaml.hpp"
#include "record/files.hpp"
#include "record/recorded_run.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <vector>

namespace palpate::cli {

namespace {

namespace fs = std::filesystem;

/// Returns the folder of the run whose id begins with `id`, relative to the bundle.
std::string find_run(const UnpackedBundle& bundle, const std::string& id, const std::string& file) {
  std::vector<std::string> found;
  for (const auto& [name, hash] : bundle.hashes()) {
    const fs::path path = name;
    const std::string folder = path.parent_path().filename().string();
    if (path.filename() == kRecordFile && folder.compare(0, id.size(), id) == 0)
      found.push_back(path.parent_path().string());
  }
  const auto same = [&](const std::string& one) {
    return fs::path(one).filename() == fs::path(found.front()).filename();
  };
  // Several sweeps may contain the same run.
  if (!found.empty() && std::all_of(found.begin(), found.end(), same)) return found.front();
  throw Error(file, fmt::format("contains {} runs whose id begins with '{}'", found.size(), id),
              found.empty() ? "its README.md and manifest.jsonl list the runs" : "write more digits of the id");
}

}  // namespace

int rerun(CommandEnvironment& program, const RerunArguments& arguments) {
  listen_for_interrupts();
  const UnpackedBundle bundle(arguments.bundle, bytes_of_gib(arguments.max_size));
  for (const std::string& one : bundle.wrong_sums()) throw Error(arguments.bundle, one, "ask its author for it again");
  const fs::path source = bundle.folder() / find_run(bundle, arguments.run, arguments.bundle);
  const RunIdentity identity = read_identity(source);
  const fs::path directory = fs::path(arguments.runs) / slug(identity.name) / identity.identity.substr(0, kIdLength);
  if (is_there(directory / "config.yaml"))
    throw Error(directory.string(), "exists already", "remove it, or choose another folder with --runs");
  Tree config = read_run_config(source);
  set_origins(config, recorded_origins(source));
  // The run keeps the files that its config names, because the bundle is unpacked only for a moment.
  for_all(config, [&](Tree& one) {
    if (!boost::starts_with(one.text, "files/") || bundle.hashes().count(one.text) == 0) return;
    const fs::path copy = directory / one.text;
    fs::create_directories(copy.parent_path());
    write_file(copy, bundle.read(one.text));
    one.text = fs::absolute(copy).string();
  });
  const Tree* backend = config.find_path("backend.type");
  bool has_program = false;
  for_all(config,
          [&](const Tree& one) { has_program = has_program || (one.is_map() && one.find("command") != nullptr); });
  if (backend != nullptr && backend->text == "simulator" && !has_program) {
    const ResolvedConfig own = resolve_experiment(config, program.host);
    return execute_run(program, own, {true, false, {}, false}, [&](const std::vector<Observer*>& observers) {
      return start_run(program, own, directory, {}, observers);
    });
  }
  fs::create_directories(directory);
  write_file(directory / "config.yaml", to_yaml_with_places(config) + "\n");
  write_file(directory / kRecordFile, bundle.read((source / kRecordFile).lexically_relative(bundle.folder()).string()));
  print_out("the taps of this run come from an arm or a program, so its record was copied\nrecord: {}\n",
            directory.string());
  return kDone;
}

}  // namespace palpate::cli
