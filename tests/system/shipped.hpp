// SPDX-License-Identifier: MIT
// What the tests of the commands share: shipped configs by name, lines counted, sweeps compared.
#pragma once

#include "support/support.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::test {

inline std::string config(const std::string& name) { return (source_folder() / "configs" / name).string(); }

inline std::string paper() { return config("paper/object_i.yaml"); }

inline int lines(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

/// `palpate compare` of a sweep, with these words behind it.
inline Ended compare(const TemporaryFolder& folder, const std::filesystem::path& directory,
                     const std::vector<std::string>& more) {
  std::vector<std::string> words{"compare", directory.string()};
  words.insert(words.end(), more.begin(), more.end());
  return palpate(words, folder.path());
}

}  // namespace palpate::test
