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
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/predicate.hpp>

#include <algorithm>
#include <iomanip>
#include <locale>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

namespace palpate {

namespace fs = std::filesystem;

namespace {

constexpr const char* kReadme = "README.md";
constexpr std::uintmax_t kMostSourceBytes = std::uintmax_t{64} << 20;
constexpr const char* kManifest = "manifest.jsonl";
constexpr std::size_t kMostResults = 100;
constexpr std::size_t kMostSumsBytes = 300;  ///< of a line of SHA256SUMS

std::string name_only(const std::string& path) { return fs::path(path).filename().string(); }

/// Returns the text at a key of a manifest; "" if there is none.
std::string text_at(const Tree& tree, const char* key) {
  const Tree* found = tree.find(key);
  return found != nullptr ? found->text : "";
}

/// Returns version and commit in the first line of a record.
std::string version_of(const std::string& record, const std::string& file) {
  const Tree manifest = parse_json(record.substr(0, record.find('\n')), file);
  const bool dirty = text_at(manifest, "dirty") == "true";
  return fmt::format("palpate {}, commit {}{}", text_at(manifest, "version"), text_at(manifest, "commit"),
                     dirty ? " with changes that are in no commit" : "");
}

/// Throws Error for a key that occurs twice in a map, because readers differ in the value that they take.
void check_keys(const Tree& line, const fs::path& file) {
  for_all(line, [&](const Tree& map) {
    std::set<std::string_view> keys;
    for (const Tree::Entry& one : map.entries) {
      if (!keys.insert(one.key).second)
        throw Error(file.string(), fmt::format("has the key '{}' twice in a line", one.key));
    }
  });
}

/// Removes the values that change no result of a run.
void erase_unimportant(Tree& config) {
  config.erase("log");
  config.erase("expect");
  config.erase_path(kThreads);
  config.erase_path("backend.pace");
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
  std::ostringstream out;
  for (const std::string& word : words) {
    if (&word != &words.front()) out << ' ';
    if (word.empty() || word.find_first_of(" \t\"\\") != std::string::npos) {
      out << std::quoted(word);
    } else {
      out << word;
    }
  }
  return out.str();
}

CommandWords words_of(const std::string& text) {
  CommandWords out;
  std::istringstream in(text);
  for (std::string word; in >> std::quoted(word);) out.push_back(word);
  return out;
}

BundleIndex index_of(const std::map<std::string, std::string>& files,
                     const std::function<std::string(const std::string& name)>& read) {
  BundleIndex out;
  for (const auto& [name, hash] : files) {
    const bool is_sweep = boost::starts_with(name, "sweeps/") && name_only(name) == kManifest;
    const bool is_run = boost::starts_with(name, "records/") && name_only(name) == kRecordFile;
    if (is_sweep || is_run) out.records.push_back(fs::path(name).parent_path().string());
    if (!is_sweep && name_only(name) == kRecordFile) out.versions.insert(version_of(read(name), name));
  }
  std::sort(out.records.begin(), out.records.end());
  const auto command = [&] { return fmt::format("results/{}/{}", out.commands.size() + 1, kCommandFile); };
  while (out.commands.size() < kMostResults && files.count(command()) > 0)
    out.commands.push_back(words_of(read(command())));
  return out;
}

std::string readme_text(const BundleIndex& index) {
  std::string out =
      "# Experiments in active touch\n\n"
      "This archive holds runs of palpate, and results that were computed from them. With palpate installed, this "
      "command\n"
      "makes every run, table and figure again and compares the numbers:\n\n"
      "    palpate verify FILE.palpate.tar.gz\n\n"
      "`palpate rerun FILE.palpate.tar.gz ID` makes one run again, to look at. Without palpate, `sha256sum -c "
      "SHA256SUMS`\n"
      "checks the files. The digest of the bundle, which a paper can print, is the output of `sha256sum "
      "SHA256SUMS`.\n\n"
      "| folder | content |\n|---|---|\n";
  for (const std::string& one : index.records) {
    const bool is_run = boost::starts_with(one, "records/");
    out += fmt::format("| {} | {} |\n", one, is_run ? "a run" : "a sweep: one run per folder of `jobs`");
  }
  for (std::size_t i = 0; i < index.commands.size(); ++i)
    out += fmt::format("| results/{} | output of `palpate {}` |\n", i + 1, words_text(index.commands[i]));
  out += "\nThe runs were made with:\n\n";
  for (const std::string& one : index.versions) out += "- " + one + "\n";
  return out +
         "\nEach run has `config.yaml`, every option with its value and unit, and `record.jsonl`, one JSON object per "
         "line.\n"
         "The first line of a record names version and commit of palpate. `files` holds what configs name, such as "
         "meshes;\n"
         "`sources` holds code that palpate does not contain.\n\n"
         "Please cite palpate and the paper of its method: Z. Sun and C. Min, Active tapping via Gaussian process for\n"
         "efficient unknown object surface reconstruction, 2021, arXiv:2110.09593.\n";
}

std::string sums_text(const std::map<std::string, std::string>& hashes) {
  std::string out;
  for (const auto& [name, hash] : hashes) out += fmt::format("{}  {}\n", hash, name);
  return out;
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
    Tree tree = parse_json(line, file);
    check_keys(tree, file);
    if (kind == LineKind::manifest || kind == LineKind::attempt) make_portable(tree);
    out += to_json_line(tree) + "\n";
  }
  return out;
}

void set_origins(Tree& config, const std::map<std::string, std::string>& origins) {
  for_all(config, [](Tree& tree) { tree.place = {}; });
  for (const auto& [path, origin] : origins) {
    if (origin == "default" || config.find_path(path) == nullptr) continue;
    config.at_path(path, {}).place.file = std::make_shared<const std::string>(portable_origin(origin, config));
  }
}

std::string portable_config(Tree config, const std::map<std::string, std::string>& origins,
                            const std::map<std::string, std::string>& replaced) {
  erase_unimportant(config);
  set_origins(config, origins);
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
    const std::string bundled = fmt::format("{}/{}", prefix, name);
    if (fs::is_directory(status)) add_source(path, bundled);
    if (!fs::is_regular_file(status)) continue;
    check_archived_name(bundled, path.string());
    files_[bundled] = read_file(path, kMostSourceBytes);
  }
}

std::string BundleCollector::add(const fs::path& directory) {
  if (is_sweep(directory)) return add_sweep(read_sweep(directory));
  const RunIdentity run = read_identity(directory);
  std::string name = fmt::format("records/{}/{}", slug(run.name), run.identity.substr(0, kIdLength));
  add_run(directory, name);
  return name;
}

std::string BundleCollector::add_named_file(const std::string& file, const Tree& config, const std::string& path) {
  NamedFile& known = named_files_[file];
  if (known.name.empty()) {
    fs::path place = file;
    // Shipped configs name shipped files as configs/...
    if (!is_there(place)) place = environment_.installation.configs.parent_path() / file;
    const std::optional<std::string> content = read_if_there(place, kMostMeshBytes, FileOrigin::user);
    if (!content)
      throw Error(file, "is missing, but a run to bundle has used it", "put it back, or leave this run out");
    std::string ending = boost::to_lower_copy(fs::path(file).extension().string(), std::locale::classic());
    if (ending.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789.") != std::string::npos) ending.clear();
    known = {fmt::format("files/{}{}", sha256_of(*content), ending), hash_of(*content)};
    files_[known.name] = *content;
  }
  const Tree* checksum = config.find_path(path.substr(0, path.rfind('.')) + ".checksum");
  if (checksum != nullptr && checksum->text != known.checksum)
    throw Error(file, "was changed since a run to bundle has used it", "put it back, or leave this run out");
  return known.name;
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
  // The program is the first word that is a file in the sources. Its name does not enter the id, unlike those of
  // others.
  std::string::size_type begin = 0;
  std::string word;
  std::string program;
  fs::path hint = folder.text;
  for (std::istringstream words(command.text); words >> word; begin += word.size()) {
    begin = command.text.find(word, begin);
    const fs::path file = fs::path(folder.text) / word;
    program = fs::is_regular_file(file) ? name_in_sources(file) : "";
    if (!program.empty()) break;
    if (begin > 0 && fs::is_regular_file(file)) hint = file.parent_path();
  }
  if (program.empty())
    throw Error(folder.text, "has a program that the bundle lacks: '" + command.text + "'",
                "add --sources " + hint.string());
  if (!whole.empty() && !fs::path(word).is_absolute()) {
    folder.text = "/" + whole;
    return;
  }
  folder.text = "/sources";
  command.text.replace(begin, word.size(), program.substr(std::string("sources/").size()));
}

void BundleCollector::add_run(const fs::path& directory, const std::string& prefix) {
  const RunStatus::State state = read_status(directory).state;
  if (state != RunStatus::State::done && state != RunStatus::State::failed)
    throw Error(directory.string(), "has not ended", "end it with 'palpate resume', or leave it out");
  const ResolvedConfig config = load_run(environment_.host, directory);
  const std::optional<Tree> manifest = read_manifest(directory);
  const Tree* plugins = manifest ? manifest->find("plugins") : nullptr;
  for (const Tree& one : plugins != nullptr ? plugins->items : std::vector<Tree>()) {
    const std::string name = text_at(one, "kind") + "/" + text_at(one, "name");
    const auto builds = [&](const auto& file) {
      return name_only(file.first) == "CMakeLists.txt" && file.second.find(text_at(one, "name")) != std::string::npos;
    };
    if (!is_there(environment_.installation.plugins / (name + ".so")) &&
        std::none_of(files_.begin(), files_.end(), builds))
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
  std::string text = portable_record(read_file(record), record);
  const auto [known, is_new] = files_.emplace(prefix + "/" + kRecordFile, text);
  if (!is_new && known->second != text)
    throw Error(directory.string(), "is in the bundle already, with another record", "leave one of them out");
}

std::string BundleCollector::add_sweep(Sweep sweep) {
  Tree config = read_run_config(sweep.directory);
  for (const Job& job : sweep.jobs) add_run(job_directory(sweep, job), "jobs/" + job.id);
  const auto replace = [&](std::string& text) {
    const auto named = fs::path(text).is_absolute() ? named_files_.find(text) : named_files_.end();
    if (named != named_files_.end()) text = named->second.name;
  };
  for_all(config, [&](Tree& one) { replace(one.text); });
  for (Job& job : sweep.jobs) std::for_each(job.values.begin(), job.values.end(), replace);
  const std::string id = sweep_id(config, sweep);
  std::string name = fmt::format("sweeps/{}/{}", slug(sweep_name(sweep)), id);
  // The name depends on the files that the jobs have added.
  for (auto at = files_.lower_bound("jobs/"); at != files_.end() && boost::starts_with(at->first, "jobs/");) {
    auto job = files_.extract(at++);
    job.key() = fmt::format("{}/{}", name, job.key());
    files_.insert(std::move(job));
  }
  files_[name + "/config.yaml"] = portable_sweep_config(std::move(config));
  files_[name + "/" + kManifest] = manifest_text(sweep, id);
  return name;
}

ArchivedFiles BundleCollector::finish() {
  const auto read = [&](const std::string& name) { return files_.at(name); };
  files_[kReadme] = readme_text(index_of(files_, read));
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

BundleIndex UnpackedBundle::read_index() const {
  return index_of(hashes_, [&](const std::string& name) { return read(name); });
}

std::vector<std::string> UnpackedBundle::wrong_sums() const {
  const auto lines_of = [](const std::string& text) {
    std::set<std::string> out;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) out.insert(line);
    return out;
  };
  const std::string expected = sums_text(hashes_);
  if (sums_ == expected) return {};
  if (sums_.size() > kMostSumsBytes * (1 + hashes_.size())) return {"SHA256SUMS is too large for its files"};
  constexpr std::size_t kShownBytes = 200;
  std::vector<std::string> out;
  const std::set<std::string> listed = lines_of(sums_);
  const std::set<std::string> found = lines_of(expected);
  for (const std::string& one : listed) {
    if (found.count(one) == 0) out.push_back("SHA256SUMS lists, but no file has: " + one_line(one, kShownBytes));
  }
  for (const std::string& one : found) {
    if (listed.count(one) == 0) out.push_back("SHA256SUMS does not list: " + one_line(one, kShownBytes));
  }
  if (out.empty()) out.emplace_back("SHA256SUMS is not as 'palpate bundle' writes it");
  return out;
}

}  // namespace palpate
