// SPDX-License-Identifier: MIT
// What the tests of the commands share: shipped configs by name, and lines counted.
#pragma once

#include "support/support.hpp"

#include <algorithm>
#include <string>

namespace palpate::test {

inline std::string config(const std::string& name) { return (source_folder() / "configs" / name).string(); }

inline std::string paper() { return config("paper/object_i.yaml"); }

inline int lines(const std::string& text) { return static_cast<int>(std::count(text.begin(), text.end(), '\n')); }

}  // namespace palpate::test
