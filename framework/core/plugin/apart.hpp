// SPDX-License-Identifier: MIT
// A look at what may crash or hang whoever looks, as a damaged library does.
#pragma once

#include <functional>
#include <string>

namespace palpate {

/// What `look` returns, called in a process of its own, which prints nothing. Throws Error, without place, when that
/// crashes, ends or comes to no end: "crashed, signal 11 (Segmentation fault)".
std::string look_apart(const std::function<std::string()>& look);

}  // namespace palpate
