// SPDX-License-Identifier: MIT
#include "config/group_files.hpp"

#include "config/keys.hpp"
#include "reading/read_file.hpp"

#include <fmt/format.h>

namespace palpate {

namespace fs = std::filesystem;

namespace {

/// Returns the folders of a group's files, in the order of the search. A whole config is a strategy, too:
/// configs/default.yaml is the strategy `default`. The folder of whole configs is the last, so that a user's config
/// weighted.yaml may build on strategy/weighted.yaml.
std::vector<fs::path> folders_of(const std::string& group) {
  return group == kStrategy ? std::vector<fs::path>{group, ""} : std::vector<fs::path>{group};
}

/// Returns the first file of a group, or "" if there is none. Throws Error if the permissions of a folder forbid the
/// search. In this case, later folders are not searched, because they might have another file of the same name.
fs::path find_in(const std::vector<fs::path>& roots, const std::string& group, const std::string& name) {
  for (const fs::path& folder : folders_of(group)) {
    for (const fs::path& root : roots) {
      std::error_code trouble;
      fs::path file = root / folder / (name + ".yaml");
      if (fs::exists(file, trouble)) return file;
      if (trouble == std::errc::permission_denied)
        throw Error(file.string(), "cannot be accessed", "check the permissions of its folder");
    }
  }
  return {};
}

/// Returns a path below the working directory as a relative path, and any other path unchanged.
fs::path shown(const fs::path& path) {
  const fs::path near = path.lexically_proximate(fs::current_path());
  return near.empty() || *near.begin() == ".." ? path : near;
}

bool gives(const fs::path& folder, fs::perms rights) {
  std::error_code none;
  const fs::file_status status = fs::status(folder, none);
  return fs::exists(status) && (status.permissions() & rights) == rights;
}

bool others_may_write(const fs::path& folder) { return gives(folder, fs::perms::others_write); }

/// Returns whether all users may put files into a folder, but may not change the files of others (sticky bit), as in
/// /tmp. Folders that all users may write without the sticky bit are accepted. There, others could replace the config
/// itself, so reading group files adds no risk. Some mounted disks have only such folders.
bool is_common(const fs::path& folder) { return gives(folder, fs::perms::others_write | fs::perms::sticky_bit); }

}  // namespace

fs::path GroupFiles::root_of(const fs::path& file, const std::string& group) {
  const fs::path folder = file.parent_path();
  return folder.filename() == group ? folder.parent_path() : folder;
}

GroupFiles::Roots GroupFiles::roots(const fs::path& beside) const {
  Roots out;
  const auto add = [&](const fs::path& folder, bool is_open) { (is_open ? out.open : out.safe).push_back(folder); };
  const fs::path own = (fs::current_path() / beside).lexically_normal();
  add(own, is_common(own));
  for (fs::path folder = own.parent_path(); folder != folder.parent_path(); folder = folder.parent_path()) {
    if (folder.filename() != "configs") continue;
    add(folder, is_common(folder));
    break;
  }
  // The user did not choose ./configs explicitly, so it is rejected if others may write there.
  const fs::path working = fs::current_path();
  add(working / "configs", others_may_write(working) || others_may_write(working / "configs"));
  add(shipped_, false);
  return out;
}

fs::path GroupFiles::find(const std::string& group, const std::string& name, const SourceLocation& place,
                          const fs::path& beside) const {
  const std::array<std::string, 3> key{group, name, beside.string()};
  if (const auto known = found_.find(key); known != found_.end()) return known->second;
  const Roots places = roots(beside);
  fs::path file = find_in(places.safe, group, name);
  if (file.empty()) {
    if (const fs::path doubtful = find_in(places.open, group, name); !doubtful.empty())
      throw Error(place.text(), fmt::format("{} is in a folder where other users can write", doubtful.string()),
                  "move the config and its groups to a folder of your own");
  } else {
    file = shown(file);
  }
  return found_.emplace(key, std::move(file)).first->second;
}

std::map<std::string, fs::path> GroupFiles::list(const std::string& group, const fs::path& beside) const {
  std::map<std::string, fs::path> out;
  for (const fs::path& folder : folders_of(group)) {
    for (const fs::path& root : roots(beside).safe) {
      for (const fs::path& file : list_folder(root / folder)) {
        if (file.extension() == ".yaml") out.emplace(file.stem().string(), file);
      }
    }
  }
  return out;
}

Error GroupFiles::missing(const std::string& group, const std::string& name, const SourceLocation& place,
                          const fs::path& beside) const {
  std::vector<std::string> names;
  for (const auto& [known, file] : list(group, beside)) names.push_back(known);
  return {place.text(), fmt::format("no file {}/{}.yaml", group, name),
          !names.empty() ? suggestion(name, names)
                         : "put it beside the config, or into 'configs' above it, ./configs or the program's configs"};
}

fs::path GroupFiles::config(const fs::path& file) const {
  std::error_code none;
  if (file.empty() || *file.begin() != "configs" || fs::status(file, none).type() != fs::file_type::not_found)
    return file;
  const fs::path own = shipped_ / file.lexically_relative("configs");
  return fs::is_regular_file(own, none) ? own.lexically_normal() : file;
}

}  // namespace palpate
