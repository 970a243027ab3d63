// SPDX-License-Identifier: MIT
#include "bundle/bundle.hpp"

#include "config/hash.hpp"
#include "config/yaml.hpp"
#include "record/files.hpp"
#include "record/json.hpp"
#include "record/recorded_run.hpp"
#include "record/run_directory.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kIndex = "bundle.json";
constexpr const char* kReadme = "README.md";
constexpr std::uintmax_t kMostSourceBytes = std::uintmax_t{64} << 20;
constexpr const char* kManifest = "manifest.jsonl";

std::string name_only(const std::string& path) { return fs::path(path).filename().string(); }

Tree list_of_texts(const std::vector<std::string>& texts) {
  Tree out = Tree::list();
  for (const std::string& one : texts) out.items.push_back(Tree::quote(one));
  return out;
}

std::vector<std::string> texts_in(const Tree& list) {
  std::vector<std::string> out;
  for (const Tree& one : list.items) out.push_back(one.text);
  return out;
}

/// Returns the text at a key of a manifest; "" if there is none.
std::string text_at(const Tree& tree, const char* key) {
  const Tree* found = tree.find(key);
  return found != nullptr ? found->text : "";
}

bool is_record(const std::string& name) {
  return (name.rfind("records/", 0) == 0 || name.rfind("sweeps/", 0) == 0) && name_only(name) == kRecordFile;
}

/// Removes the values that change no result of a run.
void erase_unimportant(Tree& config) {
  config.erase("log");
  config.erase("expect");
  config.erase_path(kThreads);
}

/// Returns a source location such as /home/ann/kernel/rbf.yaml:3:17 without the folders of the machine. The folder of a
/// group remains, because pages show the name of the group.
std::string portable_origin(const std::string& origin, const Tree& config) {
  const fs::path path = origin;
  const std::string kind = path.parent_path().filename().string();
  return config.find(kind) != nullptr ? kind + "/" + name_only(origin) : name_only(origin);
}

}  // namespace

std::string words_text(const CommandWords& words) {
  std::string out;
  for (const std::string& word : words) {
    const bool is_plain = word.find_first_of(" \t'\"") == std::string::npos && !word.empty();
    out += (out.empty() ? "" : " ") + (is_plain ? word : fmt::format("\"{}\"", word));
  }
  return out;
}

std::string index_text(const BundleIndex& index) {
  Tree results = Tree::list();
  for (const CommandWords& one : index.results) results.items.push_back(list_of_texts(one));
  return to_json(Tree::map({{"bundle", Tree::scalar("1")},
                            {"name", Tree::quote(index.name)},
                            {"version", Tree::quote(index.version)},
                            {"commit", Tree::quote(index.commit)},
                            {"records", list_of_texts(index.records)},
                            {"results", results}})) +
         "\n";
}

BundleIndex read_index(const fs::path& folder) {
  const fs::path file = folder / kIndex;
  const Tree tree = read_json(file);
  for (const char* const key : {"name", "records", "results"}) {
    if (tree.find(key) == nullptr)
      throw Error(file.string(), fmt::format("has no '{}'", key), "the bundle is damaged, or no bundle of palpate");
  }
  if (text_at(tree, "bundle") != "1")
    throw Error(file.string(), "has a format that this palpate does not know", "use the palpate that made the bundle");
  BundleIndex out{
      text_at(tree, "name"), texts_in(*tree.find("records")), {}, text_at(tree, "version"), text_at(tree, "commit")};
  for (const Tree& one : tree.find("results")->items) out.results.push_back(texts_in(one));
  return out;
}

std::string readme_text(const BundleIndex& index) {
  std::string out = fmt::format(
      "# {0}\n\n"
      "This archive holds experiments in active touch, made with palpate {1} (commit {2}), and the results that were\n"
      "computed from them. With palpate installed, this command makes every run, table and figure again and "
      "compares:\n\n"
      "    palpate verify {0}.palpate.tar.gz\n\n"
      "`palpate rerun {0}.palpate.tar.gz ID` opens one run. Without palpate, `sha256sum -c SHA256SUMS` checks the "
      "files.\n"
      "The digest of the bundle is the SHA-256 of SHA256SUMS.\n\n"
      "| folder | content |\n|---|---|\n",
      index.name, index.version, index.commit.empty() ? "unknown" : index.commit);
  for (const std::string& one : index.records)
    out += fmt::format("| {} | {} |\n", one,
                       one.rfind("sweeps/", 0) == 0 ? "a sweep: one run per folder of jobs/" : "a run");
  for (std::size_t i = 0; i < index.results.size(); ++i)
    out += fmt::format("| results/{} | `palpate {}` |\n", i + 1, words_text(index.results[i]));
  return out +
         "\nEach run has config.yaml, every option with its value, unit and origin, and record.jsonl, one JSON object "
         "per\n"
         "tap. `files` holds what configs name, such as meshes; `sources` holds code that palpate does not contain.\n\n"
         "Please cite palpate and the paper of its method: Z. Sun and C. Min, Active tapping via Gaussian process for\n"
         "efficient unknown object surface reconstruction, 2021, arXiv:2110.09593.\n";
}

std::string sums_text(const std::map<std::string, std::string>& hashes) {
  std::string out;
  for (const auto& [name, hash] : hashes) out += fmt::format("{}  {}\n", hash, name);
  return out;
}

void set_version(BundleIndex& index, const std::string& record, const fs::path& file) {
  const Tree manifest = parse_json(record.substr(0, record.find('\n')), file);
  index.version = text_at(manifest, "version");
  index.commit = text_at(manifest, "commit");
}

void make_portable(Tree& line) {
  if (Tree* host = line.find("host")) host->text.clear();
  if (Tree* pid = line.find("pid")) pid->text = "0";
  if (Tree* words = line.find("command_line")) words->items.clear();
  if (Tree* dropped = line.find("dropped")) dropped->entries.clear();  // how the config was composed
  if (Tree* plugins = line.find("plugins")) {
    for (Tree& one : plugins->items) one.erase("file");
  }
}

std::string portable_record(const std::string& text, const fs::path& file) {
  std::string out;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line) && !lines.eof();) {
    const LineKind kind = kind_of_line(line);
    if (kind == LineKind::manifest || kind == LineKind::attempt) {
      Tree tree = parse_json(line, file);
      make_portable(tree);
      line = to_json_line(tree);
    }
    out += line + "\n";
  }
  return out;
}

std::string portable_config(Tree config, const std::map<std::string, std::string>& origins,
                            const std::map<std::string, std::string>& replaced) {
  erase_unimportant(config);
  for_all(config, [](Tree& tree) { tree.place = {}; });
  for (const auto& [path, origin] : origins) {
    if (origin == "default" || config.find_path(path) == nullptr) continue;
    config.at_path(path, {}).place.file = std::make_shared<const std::string>(portable_origin(origin, config));
  }
  for (const auto& [path, text] : replaced) config.at_path(path, {}).text = text;
  return to_yaml_with_places(config) + "\n";
}

std::string portable_sweep_config(Tree config) {
  erase_unimportant(config);
  return to_yaml(config) + "\n";
}

BundleCollector::BundleCollector(const RunEnvironment& environment, const std::vector<fs::path>& sources)
    : environment_(environment) {
  for (const fs::path& one : sources) {
    const fs::path folder = fs::weakly_canonical(one);
    if (!fs::is_directory(folder)) throw Error(one.string(), "is not a folder", "name a folder for --sources");
    const std::string name = "sources/" + slug(folder.filename().string());
    for (const auto& [path, known] : sources_) {
      if (known == name) throw Error(one.string(), "has the same name as " + path.string(), "rename one of them");
    }
    sources_[folder] = name;
    add_source(folder, name);
  }
}

void BundleCollector::add_source(const fs::path& folder, const std::string& prefix) {
  if (is_there(folder / "CMakeCache.txt") || folder.filename() == "__pycache__") return;
  for (const fs::path& path : list_folder(folder)) {
    const std::string name = path.filename().string();
    const fs::file_status status = fs::symlink_status(path);
    if (name.front() == '.') continue;
    if (fs::is_directory(status)) add_source(path, prefix + "/" + name);
    if (!fs::is_regular_file(status)) continue;
    check_archived_name(prefix + "/" + name, path.string());
    files_[prefix + "/" + name] = read_file(path, kMostSourceBytes);
  }
}

std::string BundleCollector::add(const fs::path& directory) {
  if (is_sweep(directory)) return add_sweep(read_sweep(directory));
  const RunIdentity run = read_identity(directory);
  const std::string name = fmt::format("records/{}/{}", slug(run.name), run.identity.substr(0, kIdLength));
  add_run(directory, name);
  records_.push_back(name);
  return name;
}

std::string BundleCollector::add_named_file(const std::string& file, const Tree& config, const std::string& path) {
  std::string& name = named_files_[file];
  if (!name.empty()) return name;
  fs::path place = file;
  // Shipped configs name shipped files as configs/...
  if (!is_there(place)) place = environment_.installation.configs.parent_path() / file;
  const std::optional<std::string> content = read_if_there(place, kMostMeshBytes, FileOrigin::user);
  if (!content) throw Error(file, "is missing, but a run to bundle has used it", "put it back, or leave this run out");
  const Tree* checksum = config.find_path(path.substr(0, path.rfind('.')) + ".checksum");
  if (checksum != nullptr && checksum->text != hash_of(*content))
    throw Error(file, "was changed since a run to bundle has used it", "put it back, or leave this run out");
  name = fmt::format("files/{}{}", sha256_of(*content), fs::path(file).extension().string());
  files_[name] = *content;
  return name;
}

std::string BundleCollector::name_in_sources(const fs::path& path) const {
  for (const auto& [source, name] : sources_) {
    const fs::path below = fs::weakly_canonical(path).lexically_relative(source);
    if (below == ".") return name;
    if (!below.empty() && *below.begin() != "..") return name + "/" + below.string();
  }
  return {};
}

void BundleCollector::move_program(Tree& command, Tree& folder) const {
  const std::string whole = name_in_sources(folder.text);
  // The program is the first word that is a file. Its name does not enter the id, unlike those of other words.
  std::string::size_type begin = 0;
  std::string word;
  for (std::istringstream words(command.text); words >> word;) {
    begin = command.text.find(word, begin);
    if (fs::is_regular_file(fs::path(folder.text) / word)) break;
    begin += word.size();
    word.clear();
  }
  const std::string program = word.empty() ? "" : name_in_sources(fs::path(folder.text) / word);
  if (program.empty()) {
    const fs::path file = fs::path(folder.text) / word;
    throw Error(folder.text, "has a program that the bundle lacks: '" + command.text + "'",
                "add --sources " + (word.empty() ? folder.text : file.parent_path().string()));
  }
  if (!whole.empty() && !fs::path(word).is_absolute()) {
    folder.text = "/" + whole;
    return;
  }
  folder.text = "/sources";
  command.text.replace(begin, word.size(), program.substr(std::string("sources/").size()));
}

void BundleCollector::add_run(const fs::path& directory, const std::string& prefix) {
  const RunStatus::State state = read_status(directory).state;
  if (state == RunStatus::State::running || state == RunStatus::State::absent)
    throw Error(directory.string(), state == RunStatus::State::running ? "is still running" : "has not run yet",
                "bundle it when it has ended");
  const ResolvedConfig config = load_run(environment_.host, directory);
  const std::optional<Tree> manifest = read_manifest(directory);
  const Tree* plugins = manifest ? manifest->find("plugins") : nullptr;
  for (const Tree& one : plugins != nullptr ? plugins->items : std::vector<Tree>()) {
    const std::string name = text_at(one, "kind") + "/" + text_at(one, "name");
    if (sources_.empty() && !is_there(environment_.installation.plugins / (name + ".so")))
      throw Error(directory.string(), "uses the plugin " + name + ", which palpate does not contain",
                  "add --sources with the folder of its sources");
  }
  Tree tree = read_run_config(directory);
  std::map<std::string, std::string> replaced;
  for (const std::string& path : config.notes.files) {
    const Tree* file = config.tree.find_path(path);
    if (file != nullptr && !file->text.empty()) replaced[path] = add_named_file(file->text, config.tree, path);
  }
  for_all(tree, [&](Tree& one) {
    Tree* folder = one.is_map() && one.find("command") != nullptr ? one.find("folder") : nullptr;
    if (folder != nullptr) move_program(*one.find("command"), *folder);
  });
  files_[prefix + "/config.yaml"] = portable_config(std::move(tree), recorded_origins(directory), replaced);
  const fs::path record = directory / kRecordFile;
  files_[prefix + "/" + kRecordFile] = portable_record(read_file(record), record);
}

std::string BundleCollector::add_sweep(const Sweep& sweep) {
  Tree config = read_run_config(sweep.directory);
  ArchivedFiles jobs;
  std::swap(jobs, files_);
  for (const Job& job : sweep.jobs) add_run(job_directory(sweep, job), "jobs/" + job.id);
  std::swap(jobs, files_);
  for_all(config, [&](Tree& one) {
    const auto named =
        one.is_scalar() && fs::path(one.text).is_absolute() ? named_files_.find(one.text) : named_files_.end();
    if (named != named_files_.end()) one.text = named->second;
  });
  const std::string id = sweep_id(config, sweep);
  const std::string name = fmt::format("sweeps/{}/{}", slug(sweep_name(sweep)), id);
  for (auto& [file, content] : jobs)
    files_[file.rfind("jobs/", 0) == 0 ? name + "/" + file : file] = std::move(content);
  files_[name + "/config.yaml"] = portable_sweep_config(std::move(config));
  files_[name + "/" + kManifest] = manifest_text(sweep, id);
  records_.push_back(name);
  return name;
}

ArchivedFiles BundleCollector::finish(BundleIndex index) {
  std::sort(records_.begin(), records_.end());
  index.records = std::move(records_);
  const auto first = std::find_if(files_.begin(), files_.end(), [](const auto& one) { return is_record(one.first); });
  if (first != files_.end()) set_version(index, first->second, first->first);
  files_[kIndex] = index_text(index);
  files_[kReadme] = readme_text(index);
  std::map<std::string, std::string> hashes;
  for (const auto& [name, content] : files_) hashes[name] = sha256_of(content);
  files_[kSumsFile] = sums_text(hashes);
  return std::move(files_);
}

UnpackedBundle::UnpackedBundle(const fs::path& file, std::uintmax_t most_bytes) {
  read_archive(file, most_bytes, [&](const std::string& name, const std::string& content) {
    fs::create_directories((folder() / name).parent_path());
    write_file(folder() / name, content);
    if (name == kSumsFile) {
      sums_ = content;
    } else {
      hashes_[name] = sha256_of(content);
    }
  });
  digest_ = sha256_of(sums_);
}

std::vector<std::string> UnpackedBundle::wrong_sums() const {
  std::vector<std::string> out;
  if (sums_ == sums_text(hashes_)) return out;
  std::map<std::string, std::string> listed;
  std::istringstream lines(sums_);
  constexpr std::size_t kHash = 64;
  for (std::string line; std::getline(lines, line);) {
    if (line.size() > kHash + 2) listed[line.substr(kHash + 2)] = line.substr(0, kHash);
  }
  for (const auto& [name, hash] : hashes_) {
    const auto at = listed.find(name);
    if (at == listed.end()) out.push_back(name + " is not in SHA256SUMS");
    if (at != listed.end() && at->second != hash) out.push_back(name + " differs from its hash in SHA256SUMS");
  }
  for (const auto& [name, hash] : listed) {
    if (hashes_.count(name) == 0) out.push_back(name + " is missing");
  }
  if (out.empty()) out.emplace_back("SHA256SUMS is not as 'palpate bundle' writes it");
  return out;
}

}  // namespace palpate
