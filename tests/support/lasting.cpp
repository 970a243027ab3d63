// SPDX-License-Identifier: MIT
#include "support/lasting.hpp"

#include "record/fields.hpp"
#include "record/json.hpp"
#include "support/parts.hpp"
#include "support/sanitizers.hpp"
#include "support/support.hpp"

#include <csignal>
#include <cstdlib>

#include <unistd.h>

namespace palpate::test {

namespace fs = std::filesystem;

namespace {

std::string without_clocks(const Row& row) {
  std::string out;
  for (const auto& [field, value] : row.fields) {
    if (!depends_on_machine(field)) out += to_json(Row{{{field, value}}});
  }
  return out;
}

std::string without_clocks(const std::vector<Cells>& rows) {
  std::string out;
  for (const Cells& row : rows) {
    for (const auto& [name, cell] : row) {
      if (!depends_on_machine(name)) out += name + "=" + cell + "\n";
    }
  }
  return out;
}

/// A manifest without when and by which words the run was begun.
std::string identity(const std::string& manifest) {
  const std::size_t at = manifest.find("\"at\"");
  const std::size_t version = manifest.find("\"version\"");
  return manifest.substr(0, at) + manifest.substr(version, manifest.find("\"command_line\"") - version);
}

}  // namespace

std::string lasting(const fs::path& file) {
  const std::string text = text_of(file);
  const std::string name = file.filename().string();
  const fs::path run = file.parent_path();
  if (name == "record.jsonl") return identity(part_of(run, "manifest")) + lasting_part_of(run);
  if (name == "summary.json") return without_clocks(parse_json_row(text).value());
  if (name == "results.csv") return without_clocks(csv_rows(text));
  return text;
}

void run_and_kill(const std::vector<std::string>& words, const fs::path& folder, int microseconds) {
  std::vector<std::string> all{program_file().string()};
  all.insert(all.end(), words.begin(), words.end());
  Child child(all, folder);
  // The very subject of the test is a kill at a moment that nothing announces.
  ::usleep(static_cast<useconds_t>(microseconds));
  child.signal(SIGKILL);
  child.wait();
}

int wanted_kills(int usual, int few) {
  const char* wanted = std::getenv("PALPATE_KILLS");
  return wanted != nullptr ? std::atoi(wanted) : brief() ? few : usual;
}

fs::path run_in(const fs::path& runs) {
  std::error_code none;
  for (const auto& name : fs::directory_iterator(runs, none)) {
    if (name.path().filename().string().front() == '.') continue;  // what was begun and never published
    for (const auto& id : fs::directory_iterator(name.path(), none)) return id.path();
  }
  return {};
}

std::map<std::string, std::string> lasting_files(const fs::path& directory) {
  std::map<std::string, std::string> out;
  for (const auto& entry : fs::recursive_directory_iterator(directory)) {
    if (entry.is_regular_file()) out[entry.path().lexically_relative(directory).string()] = lasting(entry.path());
  }
  return out;
}

}  // namespace palpate::test
