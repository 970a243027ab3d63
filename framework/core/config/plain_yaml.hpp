// SPDX-License-Identifier: MIT
// The YAML that most configs are written in, read at a tenth of what a reader of all YAML takes.
#pragma once

#include "config/tree.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// The tree of a text of maps and lists in blocks or, within a line, in brackets, of plain or quoted words in ASCII and
/// of comments, with the places and to the letter as the reader of all YAML has it. None for a text that has anything
/// else in it, or is wrong, or empty: the other reader finds out which.
std::optional<Tree> read_plain_yaml(std::string_view text, const std::shared_ptr<const std::string>& file);

/// Whether text can stand in a config without quotes, in a list in brackets, too: most words, names and numbers. Of
/// other texts some can, too.
bool is_plain_word(std::string_view text);

}  // namespace palpate
