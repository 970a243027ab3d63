// SPDX-License-Identifier: MIT
// A bundle: one archive with the records, files, sources and results behind a claim, so that others can repeat it.
//
// | file | content |
// |---|---|
// | README.md | one page for the reader |
// | SHA256SUMS | hashes of all other files, for `sha256sum -c` |
// | records/NAME/ID/ | config.yaml and record.jsonl of a run |
// | sweeps/NAME/ID/ | config.yaml and manifest.jsonl of a sweep; in jobs/ID/ the files of its runs |
// | files/HASH.EXT | a file that configs name, such as a mesh |
// | sources/NAME/ | sources of plugins and programs that palpate does not contain |
// | results/N/ | `command`: words of a command of palpate, without its records; and its output |
//
// Host names, command lines, folders of plugins and origins, and the paths of named files stay out. Values that change
// no result of a run are left out: `log`, `expect`, the pace of the simulator and the number of threads. All tables
// that follow from the records are left out, too.
#pragma once

#include "bundle/archive.hpp"
#include "record/files.hpp"
#include "record/resolved_config.hpp"
#include "record/run.hpp"
#include "sweep/sweep.hpp"

#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

inline constexpr const char* kSumsFile = "SHA256SUMS";
inline constexpr const char* kCommandFile = "command";  ///< in results/N

/// Words of a command after `palpate`, without the records.
using CommandWords = std::vector<std::string>;
/// Splits a text at blanks. Words with blanks are in "double quotes".
CommandWords words_of(const std::string& text);
/// Returns the words as one text, with quotes around words that contain blanks.
std::string words_text(const CommandWords& words);

/// The records and results of a bundle.
struct BundleIndex {
  std::vector<std::string> records;    ///< folders of runs and sweeps, sorted
  std::vector<CommandWords> commands;  ///< of results/1, results/2, ...
  std::set<std::string> versions;      ///< version and commit of each palpate that made a run
};

/// Finds the records and results among the files of a bundle. `read`: returns the content of a file.
BundleIndex index_of(const std::map<std::string, std::string>& files,
                     const std::function<std::string(const std::string& name)>& read);

/// Returns the text of README.md.
std::string readme_text(const BundleIndex& index);

/// Returns the text of SHA256SUMS from the hashes of all other files.
std::string sums_text(const std::map<std::string, std::string>& hashes);

/// Removes paths, names and numbers of the machine and its processes from a line `manifest` or `attempt` of a record.
void make_portable(Tree& line);
/// Returns a record.jsonl without paths, names and numbers of the machine and its processes.
std::string portable_record(const std::string& text, const std::filesystem::path& file);

/// Sets the source locations of values from recorded_origins(). Of the files, only the name remains, for a group with
/// its folder.
void set_origins(Tree& config, const std::map<std::string, std::string>& origins);
/// Returns the config of a run as text, without values that change no result. `replaced`: texts of values by their
/// dotted paths. `origins`: as for set_origins().
std::string portable_config(Tree config, const std::map<std::string, std::string>& origins,
                            const std::map<std::string, std::string>& replaced = {});
/// Returns config.yaml of a sweep likewise.
std::string portable_sweep_config(Tree config);

/// Collects the files of a bundle.
class BundleCollector {
 public:
  /// `sources`: folders with the sources of plugins and programs. Throws Error for a folder that cannot be read, and
  /// for two folders with the same name. Hidden files, build folders and links are left out.
  BundleCollector(const RunEnvironment& environment, const std::vector<std::filesystem::path>& sources);

  /// Adds a run or a sweep. Throws Error for a run that has not ended, for a missing or changed file, and
  /// for a plugin or program whose sources are not given. Returns the folder of the record in the bundle.
  std::string add(const std::filesystem::path& directory);
  void add_file(const std::string& name, std::string content) { files_[name] = std::move(content); }

  /// Returns all files of the bundle.
  ArchivedFiles finish();
  const ArchivedFiles& files() const { return files_; }

 private:
  struct NamedFile {
    std::string name;      ///< in the bundle
    std::string checksum;  ///< as configs have it
  };
  void add_run(const std::filesystem::path& directory, const std::string& prefix);
  std::string add_sweep(Sweep sweep);
  void add_source(const std::filesystem::path& folder, const std::string& prefix);
  /// Adds a file that a config names, and returns its name in the bundle.
  std::string add_named_file(const std::string& file, const Tree& config, const std::string& path);
  /// Returns the name of a file or folder in the sources of the bundle; "" if it is not there.
  std::string name_in_sources(const std::filesystem::path& path) const;
  /// Changes the options `command` and `folder` of a program so that they lead to the sources. The folder becomes a
  /// path from the folder of the bundle, such as /sources/NAME. Throws Error if the sources lack the program.
  void move_program(Tree& command, Tree& folder) const;

  const RunEnvironment& environment_;
  std::map<std::filesystem::path, std::string> sources_;  ///< names of the folders in the bundle
  std::map<std::string, NamedFile> named_files_;          ///< by paths on this machine
  ArchivedFiles files_;
};

/// A bundle that was unpacked into a temporary folder.
class UnpackedBundle {
 public:
  /// Throws Error for an archive that read_archive() rejects.
  UnpackedBundle(const std::filesystem::path& file, std::uintmax_t most_bytes);

  const std::filesystem::path& folder() const { return folder_.path(); }
  /// Names and hashes of all files except SHA256SUMS.
  const std::map<std::string, std::string>& hashes() const { return hashes_; }
  /// Hash of SHA256SUMS, which a paper can print: 64 hex digits.
  const std::string& digest() const { return digest_; }

  /// Throws Error for a damaged record.
  BundleIndex read_index() const;
  /// Returns the content of a file. Throws Error.
  std::string read(const std::string& name) const { return read_file(folder() / name); }

  /// Returns one line for each difference between the files and SHA256SUMS.
  std::vector<std::string> wrong_sums() const;

 private:
  ScratchFolder folder_;
  std::map<std::string, std::string> hashes_;
  std::string sums_;
  std::string digest_;
};

}  // namespace palpate
