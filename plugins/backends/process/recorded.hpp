// SPDX-License-Identifier: MIT
// Files of the record that this plugin keeps beside the program's own.
#pragma once

#include "children/child_process.hpp"

#include <string>

namespace palpate::process {

/// Opens a file of the record, which is made if need be. Throws Error, where it is a link, too: a record from somebody
/// else may hold one, to a file of this user.
Descriptor open_recorded(const std::string& file, int flags);

}  // namespace palpate::process
