// SPDX-License-Identifier: MIT
#include "programs/command.hpp"

#include "reading/read_file.hpp"

#include <palpate/error.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <unistd.h>

#include <fmt/format.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace palpate::programs {

std::optional<std::vector<std::string>> split_command(const std::string& text) {
  std::vector<std::string> words;
  bool inside = false;  // whether the position is in a word, which may be empty: ''
  char quote = '\0';
  for (const char c : text) {
    const bool blank = c == ' ' || c == '\t' || c == '\n' || c == '\r';
    if (quote == '\0' && blank) {
      inside = false;
      continue;
    }
    if (!inside) words.emplace_back();
    inside = true;
    if (c == quote) {
      quote = '\0';
    } else if (quote == '\0' && (c == '\'' || c == '"')) {
      quote = c;
    } else {
      words.back() += c;
    }
  }
  if (quote != '\0' || words.empty() || words.front().empty()) return std::nullopt;
  return words;
}

std::optional<std::vector<std::string>> list_command(std::string& command, Fields& fields) {
  fields.text(command, Field("command",
                             "program and its arguments, separated by blanks. 'single' or \"double\" quotes keep "
                             "blanks. No shell interprets the text")
                           .needed()
                           .not_identifying());
  auto words = split_command(command);
  fields.require(words.has_value(), "command", "names no program, or has an unclosed quote");
  return words;
}

void list_checksum(std::string& checksum, Fields& fields) {
  fields.text(checksum,
              Field("checksum",
                    "checksum of the command and of the content of the program file; not given: computed from the "
                    "files. If the program is an interpreter, the checksum covers the script instead"));
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestPiece = 80;

bool executable(const std::string& file) {
  std::error_code none;
  return fs::is_regular_file(file, none) && ::access(file.c_str(), X_OK) == 0;
}

/// Returns whether a program with this name is an interpreter of another file. Any version of the interpreter counts.
bool is_interpreter(const std::string& program) {
  std::string name = fs::path(program).filename().string();
  name.erase(name.find_last_not_of("0123456789.") + 1);
  constexpr std::array<const char*, 13> kNames{"python", "pypy", "env",  "sh",   "bash", "dash", "zsh",
                                               "perl",   "ruby", "node", "java", "lua",  "julia"};
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end();
}

}  // namespace

std::string find_program(const std::string& program, const std::string& folder) {
  const bool is_path = program.find('/') != std::string::npos;
  std::string there = (fs::path(folder) / program).string();
  if (is_path && executable(there)) return there;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/bin:/bin");
  for (std::string one; !is_path && std::getline(folders, one, ':');) {
    std::string file = (one.empty() ? "." : one) + "/" + program;
    if (executable(file)) return file;
  }
  throw Error("command", "there is no program " + shown(program),
              "names are searched in PATH, relative paths start in " +
                  (folder.empty() ? std::string("the folder in which palpate runs") : "the folder " + folder));
}

ProgramFingerprint content_of(const std::vector<std::string>& words, const std::string& folder) {
  constexpr std::uintmax_t kMostBytes = 64 << 20;  // larger files count by name
  bool found = false;
  std::string all;
  ProgramFingerprint out;
  for (const std::string& word : words) {
    const bool first = &word == &words.front();
    const bool by_path = first && word.find('/') == std::string::npos;
    const bool interprets = first && is_interpreter(word);
    FileReading reading;
    if (!found && !interprets && !by_path)
      reading = read_bounded(fs::path(folder) / word, kMostBytes, FileOrigin::user);
    const bool there = first ? !interprets : reading.kind != FileReading::Kind::absent;
    found = found || there || word == "-m" || word == "-c";
    const std::string& text = reading ? reading.text : word;
    all += fmt::format("{} {}:", reading ? "file" : "word", text.size()) + text;
    if (reading) out.file = word;
    if (reading) out.program = text;
  }
  const XXH128_hash_t hash = XXH3_128bits(all.data(), all.size());
  out.checksum = fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
  return out;
}

std::string find_checked(const std::string& command, const std::vector<std::string>& words, const std::string& folder,
                         const std::string& checksum) {
  const std::string found = content_of(words, folder).checksum;
  if (checksum == found) return find_program(words.front(), folder);
  throw Error("checksum", "does not match " + shown(command) + " with its program, whose checksum is " + found,
              "restore the program that the run started with, or start another run", Error::Kind::busy);
}

std::string shown(const std::string& text) {
  std::string out = text.substr(0, kLongestPiece);
  for (char& c : out) c = c >= 0x20 && c < 0x7f ? c : '?';
  return "'" + out + (text.size() > kLongestPiece ? "..." : "") + "'";
}

}  // namespace palpate::programs
