// SPDX-License-Identifier: MIT
#include "launch/mounts.hpp"

#include "reading/read_file.hpp"

#include <palpate/error.hpp>

#include <fmt/format.h>
#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace palpate {

namespace fs = std::filesystem;

namespace {

struct Mount {
  std::string point;
  std::string type;
  std::string options;  ///< mount options of the file system, separated by commas
};

/// Decodes \ooo, the kernel's form of blanks, line ends and backslashes in paths.
std::string without_escapes(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string digits = text[i] == '\\' ? text.substr(i + 1, 3) : "";
    if (digits.size() == 3 && digits.find_first_not_of("01234567") == std::string::npos) {
      out += static_cast<char>(std::stoi(digits, nullptr, 8));
      i += 3;
    } else {
      out += text[i];
    }
  }
  return out;
}

/// Reads a line "ID PARENT MAJOR:MINOR ROOT POINT OPTIONS [TAG]... - TYPE SOURCE OPTIONS".
std::optional<Mount> read_mount(const std::string& line) {
  std::vector<std::string> words;
  boost::split(words, line, boost::is_any_of(" "));
  const auto dash = std::find(words.begin(), words.end(), "-");
  if (dash - words.begin() < 6 || words.end() - dash < 4) return std::nullopt;
  return Mount{without_escapes(words[4]), dash[1], dash[3]};
}

bool lies_in(const fs::path& folder, const fs::path& point) {
  return std::mismatch(point.begin(), point.end(), folder.begin(), folder.end()).first == point.end();
}

}  // namespace

void check_shared_locks(const fs::path& folder, std::string_view mountinfo) {
  Mount holds;  // innermost mount that contains the folder; the last of several at one mount point
  std::istringstream lines{std::string(mountinfo)};
  for (std::string line; std::getline(lines, line);) {
    const std::optional<Mount> mount = read_mount(line);
    if (mount && lies_in(folder, mount->point) && mount->point.size() >= holds.point.size()) holds = *mount;
  }
  if (holds.type != "nfs" && holds.type != "nfs4") return;
  std::vector<std::string> options;
  boost::split(options, holds.options, boost::is_any_of(","));
  for (const char* local : {"nolock", "local_lock=posix", "local_lock=all"}) {
    if (std::find(options.begin(), options.end(), local) == options.end()) continue;
    throw Error(
        folder.string(),
        fmt::format(
            "NFS at {} is mounted with '{}': nodes do not see each other's locks, and two could run the same job",
            holds.point, local),
        "mount it without this option, or put --runs on another file system");
  }
}

void check_shared_locks(const fs::path& folder) {
  const FileReading mounts = read_bounded("/proc/self/mountinfo", kMostSystemBytes, FileOrigin::user);
  if (mounts) check_shared_locks(fs::canonical(folder), mounts.text);
}

}  // namespace palpate
