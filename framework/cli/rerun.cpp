// SPDX-License-Identifier: MIT
#include "cli/rerun.hpp"

#include "bundle/repeat.hpp"
#include "cli/execute_run.hpp"
#include "cli/output.hpp"
#include "config/yaml.hpp"
#include "record/files.hpp"
#include "record/recorded_run.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

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
  if (found.size() == 1) return found.front();
  throw Error(file, fmt::format("contains {} runs whose id begins with '{}'", found.size(), id),
              found.empty() ? "its README.md and manifest.jsonl list the runs" : "write more digits of the id");
}

}  // namespace

int rerun(CommandEnvironment& program, const RerunArguments& arguments) {
  const UnpackedBundle bundle(arguments.bundle, bytes_of_gib(arguments.max_size));
  for (const std::string& one : bundle.wrong_sums()) throw Error(arguments.bundle, one, "ask its author for it again");
  const fs::path source = bundle.folder() / find_run(bundle, arguments.run, arguments.bundle);
  const ResolvedConfig config = load_run(program.host, source);
  const fs::path directory = directory_of(config, arguments.runs);
  // The run keeps the files that its config names, because the bundle is unpacked only for a moment.
  Tree tree = config.tree;
  for (const std::string& path : config.notes.files) {
    Tree& file = tree.at_path(path, {});
    const fs::path copy = make_folder(fs::path(arguments.runs) / "files") / fs::path(file.text).filename();
    write_file(copy, read_file(file.text, kMostMeshBytes));
    file.text = fs::absolute(copy).string();
  }
  if (config.options.backend.type == "simulator") {
    const ResolvedConfig own = resolve_experiment(tree, program.host);
    return execute_run(program, own, {true, false, {}, false}, [&](const std::vector<Observer*>& observers) {
      return start_run(program, own, directory, {}, observers);
    });
  }
  if (is_there(directory / kRecordFile))
    throw Error(directory.string(), "exists already", "remove it, or choose --runs");
  make_folder(directory);
  write_file(directory / "config.yaml", to_yaml_with_places(tree) + "\n");
  write_file(directory / kRecordFile, read_file(source / kRecordFile));
  print_out("the taps of this run cannot be made again, so its record was copied\nrecord: {}\n", directory.string());
  return kDone;
}

}  // namespace palpate::cli
