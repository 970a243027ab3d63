// SPDX-License-Identifier: MIT
// The plugin is there in every build, so that its options can be listed and configs be read; what it needs of ROS may
// not be.
#pragma once

#include <palpate/options.hpp>

namespace palpate::baxter {

/// In a build without ROS: a law that no config keeps, which says what to install. Else nothing.
void require_available(Fields& fields);

}  // namespace palpate::baxter
